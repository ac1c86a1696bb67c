"""A number that does not exist: both models say so, and neither alone may."""

import numpy as np
import pytest
from changed_scenes import content_of, scene_with

from pointcoord import Scene, simulate
from validate.comparison.compare import compare, compare_solutions
from validate.formulations.registry import formulation

CENTRES = (
    "front_view_swing_arm",
    "front_view_centre_height",
    "side_view_swing_arm",
    "side_view_centre_height",
)


def level(upper: float, samples: int = 11, effect: str = "instant_centres") -> Scene:
    """A wishbone whose arms are level; where the upper ones are hinged at y, mm: at 250 they are parallel."""
    points = {
        "lower_arm_front": [-100.0, 250.0, 100.0],
        "lower_arm_rear": [100.0, 250.0, 100.0],
        "upper_arm_front": [-100.0, upper, 300.0],
        "upper_arm_rear": [100.0, upper, 300.0],
        "lower_ball_joint": [0.0, 650.0, 100.0],
        "upper_ball_joint": [0.0, 650.0, 300.0],
        "tie_rod_inner": [-100.0, 250.0, 200.0],
        "tie_rod_outer": [-100.0, 650.0, 200.0],
        "wheel_centre": [0.0, 700.0, 200.0],
        "wheel_axis_inner": [0.0, 650.0, 200.0],
        "rack_centre": [-100.0, 250.0, 200.0],
    }
    laws = {"wheel_travel": {"sweep": [-49.0, 50.0]}, "rack": {"constant": 0.0}}
    part = {"wheel_radius": 200.0, "points": points}
    return scene_with("wheel-travel", part, effects=[effect], inputs=laws, samples=samples)


@pytest.mark.parametrize(("upper", "samples"), [(250.0, 11), (300.0, 101)])
def test_a_centre_at_infinity_is_there_for_every_model_or_for_none(upper: float, samples: int) -> None:
    """Of parallel arms all are there throughout; of others one goes through infinity."""
    scene = level(upper, samples)
    motion = simulate(scene)
    centres = motion.numbers["dimension"]
    side = np.abs(centres["side_view_swing_arm"])
    # Farther than 1e9 wheel radii is at infinity; this one is seven tenths of that away.
    assert np.isnan(side).all() if upper == 250.0 else np.nanmax(side) > 1e11
    for name in CENTRES:
        gone = int(np.isnan(centres[name]).sum())
        assert gone == samples if upper == 250.0 else (gone > 0) == name.startswith("side_view"), name
        told = f"dimension of {name} is not a number at {gone} of {samples} instants"
        assert any(note.startswith(told) and "at infinity" in note for note in motion.notes) == (gone > 0)
    for second in ("absolute", "reference"):
        outcome = compare(scene, "pointcoord", second)
        assert outcome.agreed
        assert {*CENTRES} <= {row.name for row in outcome.rows}


def test_a_screw_pitch_that_is_0_everywhere_is_tested() -> None:
    outcome = compare(level(250.0, effect="screw_axis"), "pointcoord", "absolute")
    assert [row.verdict for row in outcome.rows if row.name == "screw_pitch"] == ["agrees"]


def straight_ahead() -> Scene:
    """A steering wheel that goes through straight ahead at a sample, where no wheel is steered to a side."""
    content = content_of("axle-steer", {"rack_per_turn": 50.0}, samples=9)
    content["inputs"]["steering_wheel"] = {"sweep": [-6.0, 6.0]}
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
