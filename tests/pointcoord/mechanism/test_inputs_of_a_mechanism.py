"""Turns that go round, and a structure that no input moves."""

import numpy as np
import pytest
from changed_scenes import scene_with

from pointcoord import Scene, SceneError, simulate
from pointcoord.results.motion import Motion


def turned_arm(polynomial: list[float]) -> Motion:
    parts = {"time": {"start": 0.0, "stop": 1.0, "samples": 9}, "effects": ["velocity", "knuckle_rates"]}
    return simulate(scene_with("semi-trailing-arm", inputs={"arm_turn": {"polynomial": polynomial}}, **parts))


def test_a_turn_is_right_handed_about_the_hinge_and_goes_round_as_often_as_it_says() -> None:
    points = Scene.load("semi-trailing-arm").mechanism.points
    inner, outer = (np.array(points[f"pivot_{end}"]) for end in ("inner", "outer"))
    hinge = (outer - inner) / np.linalg.norm(outer - inner)
    motion = turned_arm([0.0, 8.0 * np.pi])
    assert np.abs(motion.angular_velocity["arm"] - 8.0 * np.pi * hinge).max() < 1e-10
    there = motion.position["wheel_centre"]
    assert np.abs(there[-1] - there[0]).max() < 1e-9
    # An eighth of four rounds is half of one: the centre is across the hinge.
    arm = there[0] - inner
    across = 2.0 * (arm @ hinge) * hinge - arm + inner
    assert np.abs(there[1] - across).max() < 1e-9
    # A motion that starts rounds away from the drawing goes there round by round.
    assert np.abs(turned_arm([7.0 * np.pi]).position["wheel_centre"][0] - across).max() < 1e-9


def test_a_tripod_of_rods_is_refused_as_a_structure() -> None:
    content = {
        "mechanism": {
            "bodies": {"chassis": ["a", "b", "c"]},
            "rods": {"r1": ["a", "p"], "r2": ["b", "p"], "r3": ["c", "p"]},
            "points": {"a": [0, 0, 0], "b": [300, 0, 0], "c": [0, 300, 10], "p": [100, 100, 300]},
        },
        "inputs": {},
        "time": {"start": 0.0, "stop": 1.0, "samples": 3},
    }
    with pytest.raises(SceneError, match="structure that nothing moves"):
        Scene.from_mapping(content)
