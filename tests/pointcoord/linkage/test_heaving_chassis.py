"""A chassis that moves up and down carries the whole motion with it."""

from collections.abc import Callable

import numpy as np
import pytest
from sample_cars import SampleCar, by_car

from pointcoord import Scene, simulate
from pointcoord.method import Method

EPS = np.finfo(float).eps
AMPLITUDE, FREQUENCY = 12.0, 3.0


def test_heave_that_is_not_given_is_no_heave(make_scene: Callable[..., Scene]) -> None:
    without, zero = simulate(make_scene(), "newton"), simulate(make_scene(heave=(0.0,)), "newton")
    for quantity in ("position", "velocity", "acceleration"):
        for name in without.position:
            assert np.array_equal(getattr(without, quantity)[name], getattr(zero, quantity)[name])


@by_car
@pytest.mark.parametrize("method", ["series", "newton"])
@pytest.mark.parametrize("height", [1e3, 1e9, 1e299])
def test_height_of_the_chassis_costs_a_rate_no_digit(
    make_scene: Callable[..., Scene], method: Method, height: float, car: SampleCar
) -> None:
    # Constraints are made of differences, so a chassis that has gone up changes no bit of a rate, and of a
    # coordinate only what its storage rounds: one unit in the last place of the height.
    still, moved = (
        simulate(make_scene(car=car), method),
        simulate(make_scene(car=car, heave=(height,)), method),
    )
    for quantity in ("velocity", "acceleration", "angular_velocity", "angular_acceleration", "wheel"):
        for name, one in getattr(still, quantity).items():
            assert np.array_equal(one, getattr(moved, quantity)[name])
    proof = moved.proof()
    assert np.array_equal(proof.pose_bound, still.proof().pose_bound)
    assert (proof.bound <= proof.pose_bound + 3 * EPS * (height + 1000.0)).all()


def test_a_heave_of_any_speed_leaves_the_series_as_they_are(make_scene: Callable[..., Scene]) -> None:
    # 1e6 turns in a second would take as many series if the chassis' motion were part of what is solved.
    sine = {"sine": {"amplitude": 1.0, "angular_frequency": 1e7}}
    still, moved = simulate(make_scene()), simulate(make_scene(heave=sine))
    assert moved.work.segments == still.work.segments
    top = moved.velocity["strut_top"][:, 2]
    assert np.abs(top - 1e7 * np.cos(1e7 * moved.times)).max() <= 4 * EPS * 1e7
