"""Gradients and rates of numbers held to differences of proven poses.

What the numbers are is in tests/mechanisms, for all mechanics.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from many_digits import number
from mpmath import mpf
from plain_mechanisms import plain_mechanism
from reference_cars import CARS

from validate.reference import Design, Instant, instants_of
from validate.reference.effects.registry import EFFECTS, OF_POSITIONS

EVERY = tuple(EFFECTS)


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


def test_gradients_are_the_differences_of_proven_poses() -> None:
    name = "double wishbone"
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


def test_numbers_by_time_are_the_differences_of_proven_poses_a_moment_apart() -> None:
    name = "strut as drawn"
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
