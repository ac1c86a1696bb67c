"""Forces in rods and joints on a chassis that rolls, and what they lack; statics are in tests/mechanisms."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

import mpmath
import pytest
from many_digits import size
from mpmath import mpf
from plain_mechanisms import plain_mechanism
from whole_numbers import WISHBONES

from validate.reference import BadInputError, Design, Instant, closed_drawing, solve_reference
from validate.reference.vectors import Vector, cross, dot, minus, plus, times

WITHIN = mpf("1e-50")
FORCE, MOMENT = (300, -700, 4000), (20000, -5000, 90000)
LOAD = {"force": FORCE, "moment": MOMENT}


def drawn(plain: Mapping[str, Any]) -> Instant:
    return closed_drawing(Design.from_plain(plain)).instant


def wishbones(driven: str = "wheel_travel", changed: Mapping[str, Any] | None = None, **others: Any) -> Any:
    points = {**WISHBONES, **(changed or {})}
    inputs = [driven, "rack"]
    plain = plain_mechanism("double_wishbone_pushrod", points, inputs, side="right", wheel_radius=260)
    return {**plain, "loads": {"": LOAD}, **others}


def test_on_a_chassis_that_rolls_with_its_load_the_forces_roll_along() -> None:
    roll = {"roll": {"turns": "chassis", "about": "rocker_front", "along": "rearward"}}
    plain = wishbones()
    angle = mpf("0.4")
    sine, cosine = mpmath.sin(angle), mpmath.cos(angle)

    def rolled(v: Vector) -> Vector:
        return v[0], cosine * v[1] - sine * v[2], sine * v[1] + cosine * v[2]

    # The disc's lowest point moves in it: the force is taken there in the turned car as a moment besides.
    inputs = {"wheel_travel": (5, 0, 0), "rack": (3, 0, 0)}
    still = solve_reference(plain, inputs)
    turning = {**plain, "inputs": {**plain["inputs"], **roll}}
    moved = solve_reference(turning, {**inputs, "roll": (angle, 0, 0)})

    def contact(found: Instant) -> Vector:
        axis = minus(*(found.position[name] for name in ("wheel_centre", "wheel_axis_inner")))
        down = minus(times(axis, axis[2]), times((0, 0, 1), dot(axis, axis)))
        return plus(found.position["wheel_centre"], times(down, 260 / size(down)))

    pivot = WISHBONES["rocker_front"]
    there = plus(pivot, rolled(minus(contact(still), pivot)))
    force = rolled(FORCE)
    moment = plus(rolled(MOMENT), cross(minus(there, contact(moved)), force))
    load = {"": {"force": force, "moment": moment}}
    found = solve_reference({**turning, "loads": load}, {**inputs, "roll": (angle, 0, 0)})
    for name, tension in still.rod_force.items():
        assert abs(found.rod_force[name] - tension) < WITHIN, name
    for name, pull in still.joint_force.items():
        assert max(abs(x) for x in minus(found.joint_force[name], rolled(pull))) < WITHIN, name


def test_what_forces_lack_is_said() -> None:
    assert "rod_force" not in drawn({**wishbones(), "loads": {}}).left_out
    radius = drawn({**wishbones(), "wheel_radius": None}).left_out
    assert radius["rod_force"] == radius["joint_force"] == "needs a wheel_radius, mm"
    twice = {**wishbones(), "rods": {**wishbones()["rods"], "again": ["tie_rod_inner", "tie_rod_outer"]}}
    assert drawn(twice).left_out["rod_force"].endswith(("as these do: again", "as these do: tie_rod"))
    # The line of the damper meets the hinge of the rocker.
    crossing = times(plus(WISHBONES["rocker_front"], WISHBONES["rocker_rear"]), Fraction(1, 2))
    dead = {"damper_top": minus(times(crossing, 2), WISHBONES["damper_rocker"])}
    assert "does not hold it" in drawn(wishbones(changed=dead)).left_out["rod_force"]
    with pytest.raises(BadInputError, match=r"loads\['left'\]"):
        Design.from_plain({**wishbones(), "loads": {"left": LOAD}})
    with pytest.raises(BadInputError, match=r"loads\[''\].force"):
        Design.from_plain({**wishbones(), "loads": {"": {"force": (1, 2)}}})
