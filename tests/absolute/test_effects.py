"""Effects: digits far from the origin, and what they need.

tests/mechanisms tests their values for all mechanics.
"""

from typing import Any

import numpy as np
import pytest
from mechanism_files import plain_scene
from one_arm import CAR, DRAWN, plain
from shipped import Motion

import absolute
from absolute.dual import arctan2, constant


def solved(described: dict[str, Any], names: Any, **values: float) -> dict[str, float]:
    """Effects at values of the inputs; missing inputs are 0."""
    inputs = {name: np.array([[values.get(name, 0.0), 0.0, 0.0]]) for name in described["inputs"]}
    found = Motion(described, inputs).solve(rates=False, effects=names).effects
    return {name: float(number[0]) for name, number in found.items()}


def test_a_short_spin_axis_keeps_its_digits() -> None:
    """The difference of the places of its ends, hundreds of mm away, would have fewer digits."""
    scene = plain_scene("double-wishbone", ["arm_angle", "rack"])
    drawn = {name: np.round(np.array(p) * 2.0**22) / 2.0**22 for name, p in scene["points"].items()}
    drawn["wheel_axis_inner"] = drawn["wheel_centre"] - np.array([2.0**-13, 2.0**-10, 2.0**-12])
    angle = absolute.close_drawing(absolute.compile(scene | {"points": drawn})).inputs["arm_angle"]
    found = solved(scene | {"points": drawn, "side": "right"}, ["camber"], arm_angle=angle)
    assert abs(found["camber"] - np.arctan2(-0.25, 1.0)) < 1e-12


def test_half_a_turn_is_pi_with_either_zero() -> None:
    assert arctan2(constant(-0.0), constant(-1.0)).value == np.pi


def test_names_are_those_of_the_parts_and_of_both_wheels_of_an_axle() -> None:
    parts = {f"{part}.{name}" for part in ("left", "right") for name in absolute.EFFECTS}
    assert set(absolute.effects_in(absolute.compile(plain_scene("axle-steer")))) == parts | set(
        absolute.AXLE_EFFECTS
    )
    assert absolute.effects_in(absolute.compile(plain())).keys() == absolute.EFFECTS.keys()


def lacking(*names: str, **changed: Any) -> dict[str, Any]:
    """The arm without some numbers of the car."""
    return plain(car={name: value for name, value in CAR.items() if name not in names} or None, **changed)


def test_a_number_needs_nothing_of_the_others() -> None:
    for names, less in (
        (["travel", "hub_trail", "damper_length_by_travel", "toe"], plain(wheel_radius=None)),
        (["anti_brake"], lacking("drive_share")),
        (["anti_drive"], lacking("brake_share")),
    ):
        assert solved(less, names) == solved(plain(), names)


def test_forces_are_given_where_they_are_asked_for_and_none_of_a_damper_at_its_dead_point() -> None:
    """Its line goes through the hinge of the arm."""
    beyond = np.add(DRAWN["pivot_end"], np.subtract(DRAWN["pivot_end"], DRAWN["pivot"]))
    described = plain({**DRAWN, "damper_top": beyond}, loads={"": {"force": [300.0, -900.0, 4000.0]}})
    motion = Motion(described, {name: np.zeros((1, 3)) for name in described["inputs"]})
    assert not motion.solve().rod_force
    found = motion.solve(loads=True)
    assert np.isnan(found.rod_force["damper"]).all()
    assert np.isfinite(found.position["centre"]).all()
    with pytest.raises(ValueError, match="read-only"):
        found.rod_force["damper"][0] = 0.0
