"""A chassis that moves up and down carries the whole motion with it."""

from collections.abc import Callable

import numpy as np
import pytest
from rate_sensitivity import rate_sensitivities
from sample_cars import SampleCar, by_car

from pointcoord import InputOutOfRange, Scene, simulate
from pointcoord.method import NEWTON, SERIES, Method

EPS = np.finfo(float).eps
AMPLITUDE, FREQUENCY = 12.0, 3.0


@by_car
@pytest.mark.parametrize("method", [SERIES, NEWTON], ids=str)
@pytest.mark.parametrize("tilted", [False, True])
def test_heave_adds_itself_to_positions_and_its_rates_to_rates(
    make_scene: Callable[..., Scene], car: SampleCar, method: Method, tilted: bool
) -> None:
    # Heave is along the car's own up: a car turned about x by 30 degrees shows that.
    c, s = (np.cos(np.pi / 6), 0.5) if tilted else (1.0, 0.0)
    about = np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])
    content = {
        "car": car,
        "points": {name: about @ p for name, p in car.points.items()},
        "up": about[:, 2],
        "right": about[:, 1],
        "rack": (0.0, 20.0),
        "samples": 21,
    }
    still = simulate(make_scene(**content), method)
    sine = {"sine": {"amplitude": AMPLITUDE, "angular_frequency": FREQUENCY}}
    moved = simulate(make_scene(**content, heave=sine), method)
    one, other = still.proof(), moved.proof()
    t = still.times[:, None]
    up = about[:, 2]
    added = {
        "position": AMPLITUDE * np.sin(FREQUENCY * t) * up,
        "velocity": AMPLITUDE * FREQUENCY * np.cos(FREQUENCY * t) * up,
        "acceleration": -AMPLITUDE * FREQUENCY**2 * np.sin(FREQUENCY * t) * up,
    }
    # Poses: both proven bounds; for the series the truncation of both, 1e-9 mm each.
    pose = (
        (one.carried_bound + other.carried_bound).max() + (2e-9 if method.by_series else 0.0) + 16 * EPS * 600
    )
    # Rates: a pose's error times its proven effect, and the rounding of one solve, condition number times
    # eps of the largest rate; for the series the same share of the rate as the tolerance is of the car.
    # Carried points are multiplied by their weights, up to 30.
    condition = max(one.condition.max(), other.condition.max())
    share = 64 * EPS * condition + (1e-9 / 256 if method.by_series else 0.0)
    fast, hard = (
        max(np.abs(v).max() for v in getattr(moved, q).values()) for q in ("velocity", "acceleration")
    )
    sense, bend = (
        max(float(largest.max()) for largest in both)
        for both in zip(rate_sensitivities(still), rate_sensitivities(moved), strict=True)
    )
    speed = 30 * (sense * pose + share * fast)
    second = 30 * (bend * pose + 2 * sense * speed + share * (hard + fast * sense))
    for quantity, tolerance in (("position", pose), ("velocity", speed), ("acceleration", second)):
        for name in still.position:
            gap = getattr(moved, quantity)[name] - getattr(still, quantity)[name] - added[quantity]
            assert np.abs(gap).max() <= tolerance
        assert tolerance < 1e-3 * np.abs(added[quantity]).max()  # small enough to see a lost heave
    # The knuckle's spin and the angles do not change: shortest lever of its triangle 50 mm.
    for quantity, tolerance in (("angular_velocity", speed), ("angular_acceleration", second)):
        gap = getattr(moved, quantity)["knuckle"] - getattr(still, quantity)["knuckle"]
        assert np.abs(gap).max() <= 12 * tolerance / 50
    for angle in still.wheel:
        assert np.abs(moved.wheel[angle] - still.wheel[angle]).max() <= 8 * pose / 50


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


def test_a_heave_too_fast_for_the_arithmetic_is_named(make_scene: Callable[..., Scene]) -> None:
    sine = {"sine": {"amplitude": 1e150, "angular_frequency": 1e100}}
    with pytest.raises(
        InputOutOfRange, match=r"'heave' is .* at t = .*; allowed: accelerations below 1e\+300"
    ) as caught:
        simulate(make_scene(heave=sine))
    assert caught.value.name == "heave"
