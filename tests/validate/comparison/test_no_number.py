"""A number that does not exist: both models say so, and neither alone may."""

from typing import Any

import numpy as np
import pytest

from pointcoord import Scene, simulate
from validate.comparison.compare import compare, compare_solutions
from validate.formulations.registry import formulation

CENTRES = (
    "front_view_swing_arm",
    "front_view_centre_height",
    "side_view_swing_arm",
    "side_view_centre_height",
)
KNUCKLE = {
    "lower_ball_joint": [0.0, 650.0, 100.0],
    "upper_ball_joint": [0.0, 650.0, 300.0],
    "tie_rod_outer": [-100.0, 650.0, 200.0],
    "wheel_centre": [0.0, 700.0, 200.0],
    "wheel_axis_inner": [0.0, 650.0, 200.0],
}


def level(
    upper: float = 250.0, travel: float = 50.0, samples: int = 11, effect: str = "instant_centres"
) -> Scene:
    """A wishbone whose arms are level and parallel; where the upper ones are hinged at y, mm."""
    points = KNUCKLE | {
        "lower_arm_front": [-100.0, 250.0, 100.0],
        "lower_arm_rear": [100.0, 250.0, 100.0],
        "upper_arm_front": [-100.0, upper, 300.0],
        "upper_arm_rear": [100.0, upper, 300.0],
        "tie_rod_inner": [-100.0, 250.0, 200.0],
    }
    content: dict[str, Any] = {
        "effects": [effect],
        "mechanism": {"type": "double_wishbone", "side": "right", "wheel_radius": 200.0, "points": points},
        "inputs": {"wheel_travel": {"sweep": [-travel, 50.0]}, "rack": {"constant": 0.0}},
        "time": {"start": 0.0, "stop": 1.0, "samples": samples},
    }
    return Scene.from_mapping(content, "level arms")


def test_parallel_arms_have_their_centres_at_infinity_and_both_models_say_so() -> None:
    scene = level()
    motion = simulate(scene)
    for name in CENTRES:
        assert np.isnan(motion.numbers["dimension"][name]).all()
        told = f"dimension of {name} is not a number at 11 of 11 instants"
        assert any(note.startswith(told) and "at infinity" in note for note in motion.notes)
    for second in ("absolute", "reference"):
        outcome = compare(scene, "pointcoord", second)
        assert outcome.agreed
        assert {*CENTRES} <= {row.name for row in outcome.rows if row.verdict == "agrees"}


def test_a_centre_that_goes_through_infinity_is_there_for_both_models_or_for_neither() -> None:
    scene = level(upper=300.0, travel=49.0, samples=101)
    centres = simulate(scene).numbers["dimension"]
    # Farther than 1e9 wheel radii is at infinity; this one is seven tenths of that away.
    assert np.nanmax(np.abs(centres["side_view_swing_arm"])) > 1e11
    assert np.isnan(centres["side_view_swing_arm"]).any()
    assert np.isfinite(centres["front_view_swing_arm"]).all()
    assert compare(scene, "pointcoord", "absolute").agreed
    assert compare(scene, "pointcoord", "reference").agreed


def test_a_screw_pitch_that_is_0_everywhere_is_tested() -> None:
    outcome = compare(level(effect="screw_axis"), "pointcoord", "absolute")
    assert [row.verdict for row in outcome.rows if row.name == "screw_pitch"] == ["agrees"]


def straight_ahead() -> Scene:
    """A steering wheel that goes through straight ahead at a sample, where no wheel is steered to a side."""
    content = Scene.load("axle-steer").model_dump(exclude_none=True)
    content["mechanism"]["rack_per_turn"] = 50.0
    content["inputs"]["steering_wheel"] = {"sweep": [-6.0, 6.0]}
    content["time"]["samples"] = 9
    del content["inputs"]["rack"]
    return Scene.from_mapping(content, "straight ahead")


@pytest.mark.parametrize("second", ["absolute", "relative", "reference"])
def test_a_model_that_claims_nothing_of_a_number_may_give_one_where_there_is_none(second: str) -> None:
    outcome = compare(straight_ahead(), "pointcoord", second)
    assert outcome.agreed
    assert [row.verdict for row in outcome.rows if row.name == "ackermann"] == ["agrees"]
    assert any("the wheels are not steered to the same side" in note for note in outcome.notes)


def test_a_model_that_has_no_number_where_there_is_one_disagrees() -> None:
    scene = straight_ahead()
    ours, theirs = (formulation(name).solve(scene) for name in ("pointcoord", "relative"))
    holed = theirs.numbers["ackermann"]["ackermann"].copy()
    holed[7] = np.nan
    faulty = theirs.with_numbers({"ackermann": {"ackermann": holed}})
    outcome = compare_solutions(scene, ours, faulty, "holed")
    assert [row.name for row in outcome.disagreements] == ["ackermann"]
