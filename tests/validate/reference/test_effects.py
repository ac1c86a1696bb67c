"""Angles of axes turned by hand, and their slopes."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from flint import arb

from validate.reference.dual import Dual, angle
from validate.reference.effects.car import STEERING, WHEEL, Car, DrawnCar, Line
from validate.reference.effects.registry import EFFECTS
from validate.reference.vectors import Vector

UP, FORWARD = (0, 0, 1), (-1, 0, 0)  # x rearward, y right, z up


def car_with(wheel: tuple[float, ...], steering: tuple[float, ...], out: int) -> Car:
    """A car whose axes start at the origin."""

    def balls(vector: tuple[float, ...]) -> Vector:
        return arb(vector[0]), arb(vector[1]), arb(vector[2])

    start = balls((0, 0, 0))
    lines = {
        n: Line(start, balls(along), balls(along)) for n, along in ((WHEEL, wheel), (STEERING, steering))
    }
    drawn = DrawnCar({}, lines, balls(UP), balls(FORWARD), balls((0, out, 0)), None, start, {})
    return Car(drawn, lines, lines)


@pytest.mark.parametrize("out", [-1, 1])
@pytest.mark.parametrize("lean", [-2.5, -0.2, 0.3, 1.9])
def test_angles_are_those_by_which_axes_are_turned_by_hand(lean: float, out: int) -> None:
    sine, cosine = float(np.sin(lean)), float(np.cos(lean))
    # The spin axis of a wheel that leans out points down on its way out; the steering axis leads in on its
    # way up. Neither angle sees what is along the car.
    leaning = car_with((7.0, out * cosine, -sine), (-3.0, -out * sine, cosine), out)
    # The spin axis of a wheel that toes in points forward, -x; a steering axis with caster leads rearward.
    toeing = car_with((-sine, out * cosine, 7.0), (sine, -3.0, cosine), out)
    for name, car in {"camber": leaning, "kingpin": leaning, "toe": toeing, "caster": toeing}.items():
        assert float(EFFECTS[name].evaluate(car)) == pytest.approx(lean, abs=1e-15)
    assert float(EFFECTS["steer_angle"].evaluate(toeing)) == pytest.approx(out * lean, abs=1e-15)


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


def test_two_components_that_may_both_be_none_have_no_angle() -> None:
    assert not angle(arb(0), arb(0)).is_finite()
    assert not angle(arb(0, 1), arb(0, 1)).is_finite()
    assert angle(arb(0), arb(1)) == 0
