"""What the motion of the chassis adds to every point, what it costs, and the directions of the car."""

import math
from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pytest
from many_digits import fractions

from pointcoord import InputOutOfRange, Scene, simulate
from pointcoord.linkage.chassis import ChassisMotion
from pointcoord.linkage.directions import CarAxes
from pointcoord.numerics.enclosure import Enclosed
from pointcoord.time_functions import Polynomial

UP = np.array([0.6, 0.0, 0.8])


@pytest.mark.parametrize(("order", "unit"), [(0, "mm"), (2, "mm/s^2")])
def test_a_chassis_that_goes_too_far_or_too_fast_is_refused_with_when_and_what(order: int, unit: str) -> None:
    # The first instant is at rest with all the others' derivatives below.
    terms = [0.0, 0.0, 0.0]
    terms[order] = 1e301 / math.factorial(order)
    motion = ChassisMotion({"heave": Polynomial(tuple(terms))}, {"heave": UP})
    with pytest.raises(InputOutOfRange, match=f"below 1e\\+300 {unit} in size".replace("^", r"\^")) as caught:
        motion.law("heave", np.array([0.0]), 2)
    assert (caught.value.name, caught.value.instant) == ("heave", 0.0)
    assert caught.value.value == pytest.approx(1e301)
    late = ChassisMotion({"heave": Polynomial((0.0, 1e299))}, {"heave": UP})
    with pytest.raises(InputOutOfRange, match="below") as caught:
        late.law("heave", np.array([0.0, 5.0, 20.0, 30.0]), 0)
    assert caught.value.instant == 20.0


EPS = np.finfo(float).eps


def test_a_heave_of_any_speed_leaves_the_series_as_they_are(make_scene: Callable[..., Scene]) -> None:
    # 1e6 turns in a second would take as many series if the chassis' motion were part of what is solved.
    sine = {"sine": {"amplitude": 1.0, "angular_frequency": 1e7}}
    still, moved = simulate(make_scene()), simulate(make_scene(heave=sine))
    assert moved.work.segments == still.work.segments
    top = moved.velocity["strut_top"][:, 2]
    assert np.abs(top - 1e7 * np.cos(1e7 * moved.times)).max() <= 4 * EPS * 1e7


def test_rearward_is_enclosed_as_the_exact_product_of_directions_that_are_rounded() -> None:
    up, right = np.array([0.1, -0.7, 0.9]), np.array([0.3, 0.6, -0.2])
    vector = np.array([0.7, 1.1, -1.3])
    found = CarAxes(up, right, right).component(Enclosed.of(vector), "rearward")
    exact = np.cross(fractions(right), fractions(up)) @ fractions(vector)
    error = abs(exact - Fraction(float(found.high)) - Fraction(float(found.low)))
    assert error <= found.radius[0] < 1e-29
