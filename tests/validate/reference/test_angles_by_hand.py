"""The reference's angles of axes that are turned by hand, and their derivatives."""

from fractions import Fraction

import numpy as np
import pytest
from flint import arb

from validate.reference.dual import Dual
from validate.reference.effects.effect import STEERING, WHEEL, Axes, angle
from validate.reference.effects.registry import EFFECTS
from validate.reference.vectors import Vector

UP, RIGHT, FORWARD = (0, 0, 1), (0, 1, 0), (-1, 0, 0)  # x rearward, y right, z up


def axes(wheel: tuple[float, ...], steering: tuple[float, ...], out: int) -> Axes:
    def balls(vector: tuple[float, ...]) -> Vector:
        return arb(vector[0]), arb(vector[1]), arb(vector[2])

    lines = {WHEEL: balls(wheel), STEERING: balls(steering)}
    return Axes(lines, balls(UP), balls(FORWARD), balls((0, out, 0)))


@pytest.mark.parametrize("out", [-1, 1])
@pytest.mark.parametrize("lean", [-2.5, -0.2, 0.3, 1.9])
def test_a_wheel_leans_out_at_the_top_and_its_steering_axis_in(lean: float, out: int) -> None:
    sine, cosine = float(np.sin(lean)), float(np.cos(lean))
    # The spin axis of a wheel that leans out points down on its way out; the steering axis leads in on its
    # way up. Neither angle sees what is along the car.
    turned = axes((7.0, out * cosine, -sine), (-3.0, -out * sine, cosine), out)
    for name in ("camber", "kingpin"):
        assert float(EFFECTS[name].value(turned)) == pytest.approx(lean, abs=1e-15)


@pytest.mark.parametrize(
    ("y", "x", "slope"),
    [
        # d atan2(y, x) = (x dy - y dx) / (x^2 + y^2)
        (Dual(arb(3), arb(2)), Dual(arb(4), arb(-5)), Fraction(4 * 2 + 3 * 5, 25)),
        (Dual(arb(3), arb(2)), arb(4), Fraction(8, 25)),
        (arb(3), Dual(arb(4), arb(-5)), Fraction(15, 25)),
        (Dual(arb(-1), arb(7)), Dual(arb(-2), arb(1)), Fraction(-14 + 1, 5)),
    ],
)
def test_an_angle_turns_with_both_of_its_components(y: Dual | arb, x: Dual | arb, slope: Fraction) -> None:
    found = angle(y, x)
    assert isinstance(found, Dual)
    assert found.slope.overlaps(arb(slope.numerator) / slope.denominator)
    values = [float(part.value) if isinstance(part, Dual) else float(part) for part in (y, x)]
    assert float(found.value) == pytest.approx(np.arctan2(*values), abs=1e-15)


def test_an_angle_of_plain_numbers_is_a_plain_number() -> None:
    assert isinstance(angle(arb(3), arb(4)), arb)
    assert angle(np.array([3.0, -1.0]), np.array([4.0, -1.0])).tolist() == [np.arctan2(3, 4), -0.75 * np.pi]
