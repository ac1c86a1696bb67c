"""Gradients and rates of numbers held to differences of proven poses, and what a car lacks.

What the numbers are is in tests/mechanisms, for all mechanics.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

import pytest
from many_digits import number
from mechanism_drawings import described
from mechanism_files import plain_scene
from mpmath import mpf
from plain_mechanisms import plain_mechanism
from reference_cars import CARS

from validate.reference import BadInputError, Design, Instant, closed_drawing, instants_of, solve_reference
from validate.reference.effects.registry import EFFECTS, OF_POSITIONS

EVERY = tuple(EFFECTS)

WHEEL = {
    "wheel_axis_inner": (964, 652, 275),
    "wheel_centre": (1000, 700, 300),
    "lower": (1015, 705, 180),
    "upper": (1045, 645, 420),
    "damper_low": (1014, 421, 558),
}
DAMPER_TOP = (1000, 400, 600)
RADIUS = 260
ROLES = {
    "knuckle": "arm",
    "wheel_axis": ["wheel_axis_inner", "wheel_centre"],
    "steering_axis": ["lower", "upper"],
    "damper": ["damper_top", "damper_low"],
}
SWING = {"swing": {"angle": "arm", "from": "drawing"}}


def on_an_arm(
    pivot: tuple[int, ...], end: tuple[int, ...], inputs: Mapping[str, Any] = SWING, **others: Any
) -> dict[str, Any]:
    """The wheel on an arm about the line from `pivot` to `end`."""
    return described(
        {**WHEEL, "damper_top": DAMPER_TOP, "pivot": pivot, "end": end},
        {"chassis": ["pivot", "end", "damper_top"], "arm": ["pivot", "end", *WHEEL]},
        inputs,
        **{"roles": ROLES, "side": "right", "wheel_radius": RADIUS, **others},
    )


def moved_car(name: str) -> dict[str, Any]:
    """A car whose chassis rolls, pitches and is displaced up and aside."""
    car = CARS[name]
    plain = plain_mechanism(
        car.suspension, car.points, closure=car.closure, side=car.side, wheel_radius=car.wheel_radius
    )
    chassis = plain["bodies"]["chassis"]
    moves = {
        "roll": {"turns": "chassis", "about": chassis[0], "along": "forward"},
        "pitch": {"turns": "chassis", "about": chassis[1], "along": "right"},
        "sideways": {"moves": "chassis", "along": "right"},
    }
    return {**plain, "inputs": {**plain["inputs"], **moves}}


def poses_of(name: str, **more: Any) -> dict[str, tuple[Any, ...]]:
    """Inputs some way from the drawing, on a chassis that is turned."""
    car = CARS[name]
    values = {n: triple[0] for n, triple in car.inputs.items()}
    values |= {"roll": Fraction(1, 20), "pitch": Fraction(-1, 30), "sideways": Fraction(9)}
    values["arm_angle"] += Fraction(1, 10)
    return {n: (value + more.get(n, 0), 0, 0) for n, value in values.items()}


def solved(name: str, inputs: Mapping[str, tuple[Any, ...]], digits: int = 60) -> Instant:
    (found,) = instants_of(Design.from_plain(moved_car(name)), [inputs], digits, effects=EVERY)
    return found


@pytest.mark.parametrize("name", CARS)
def test_gradients_are_the_differences_of_proven_poses(name: str) -> None:
    # A central difference is off by step^2 / 6 of the third derivative, by rad here below 1e6 and by mm less:
    # by 2e-39. Of a quotient by d travel, of 100 mm/rad at least, it is off by no more.
    step, off = Fraction(1, 10**22), mpf("1e-38")
    here = solved(name, poses_of(name))
    by_arm, by_rack = (
        [solved(name, poses_of(name, **{one: sign * step}), 100).effects for sign in (1, -1)]
        for one in ("arm_angle", "rack")
    )
    travelled = by_arm[0]["travel"] - by_arm[1]["travel"]
    assert abs(travelled) > 200 * number(step)
    names = set(OF_POSITIONS) - {"damper_length"}
    assert {f"{one}_{way}" for one in names for way in ("by_travel", "by_rack")} <= set(here.effects)
    for one in names:
        ahead, behind = (by_arm[k][one] for k in range(2))
        assert abs(here.effects[f"{one}_by_travel"] - (ahead - behind) / travelled) < off, one
        ahead, behind = (by_rack[k][one] for k in range(2))
        assert abs(here.effects[f"{one}_by_rack"] - (ahead - behind) / (2 * number(step))) < off, one


@pytest.mark.parametrize("name", CARS)
def test_numbers_by_time_are_the_differences_of_proven_poses_a_moment_apart(name: str) -> None:
    # As above: all inputs move by less than 50 rad/s or mm/s here.
    step, off = Fraction(1, 10**22), mpf("1e-36")
    rates = {n: Fraction(7 + 3 * k, 5) for k, n in enumerate(poses_of(name))}
    moving = solved(name, {n: (value, rates[n], 0) for n, (value, *_) in poses_of(name).items()}).effects
    ahead, behind = (
        solved(name, poses_of(name, **{n: sign * step * rate for n, rate in rates.items()}), 100).effects
        for sign in (1, -1)
    )
    names = set(OF_POSITIONS) - {"damper_length"}
    assert {f"{one}_by_time" for one in names} <= set(moving)
    for one in names:
        assert abs(moving[f"{one}_by_time"] - (ahead[one] - behind[one]) / (2 * number(step))) < off, one


def test_what_a_car_lacks_is_said_by_name() -> None:
    plain = on_an_arm(
        (600, 400, 300), (600, 500, 300), roles={"wheel_axis": ROLES["wheel_axis"]}, wheel_radius=None
    )
    found = closed_drawing(Design.from_plain(plain), effects=EVERY).instant
    of_the_axis = {"camber", "toe", "camber_by_arcsine", "toe_by_arcsine", "steer_angle", "travel"}
    along = {f"{name}_{way}" for name in of_the_axis for way in ("by_travel", "by_time")}
    assert set(found.effects) == of_the_axis | along
    assert found.left_out["caster"] == "needs the role steering_axis"
    assert found.left_out["contact_travel"] == "needs a wheel_radius, mm"
    assert found.left_out["scrub_radius"] == "needs the role steering_axis and a wheel_radius, mm"
    assert found.left_out["damper_length"] == "needs the role damper"
    assert "role knuckle" in found.left_out["roll_centre_height"]
    words = "needs exactly one driven input that is the travel of a slide or steers one"
    assert found.left_out["toe_by_rack"] == words


def test_two_inputs_that_move_the_wheel_leave_no_gradient_by_its_travel() -> None:
    car = CARS["double wishbone"]
    rods = {"gap": {"distance": ["tie_rod_outer", "upper_arm_front"]}}
    plain = plain_mechanism(car.suspension, car.points, ["arm_angle"], wheel_radius=car.wheel_radius)
    plain = {**plain, "inputs": {**plain["inputs"], **rods}}
    found = closed_drawing(Design.from_plain(plain), effects=EVERY).instant
    assert {one for one in found.effects if one.endswith(("_by_travel", "_by_rack"))} == set()
    words = "exactly one driven input that is not the travel of a slide"
    assert words in found.left_out["camber_by_travel"]
    assert words in found.left_out["roll_centre_height"]


@pytest.mark.parametrize("radius", [0, -260, float("nan")])
def test_a_wheel_without_size_is_refused(radius: float) -> None:
    plain = {**plain_scene("five-link"), "wheel_radius": radius}
    with pytest.raises(BadInputError, match="wheel_radius"):
        solve_reference(plain, {"wheel_travel": (0, 0, 0)}, effects=EVERY)
