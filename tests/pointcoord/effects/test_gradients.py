"""Derivatives by an input: by which one makes no difference, and where there are none."""

from typing import Any

import numpy as np

from pointcoord import Scene, simulate
from pointcoord.effects.registry import EFFECTS

ALONG = {name for name, effect in EFFECTS.items() if effect.way or effect.base}
TRAVEL, STEER = {"sine": {"amplitude": 30.0, "angular_frequency": 3.0}}, {"polynomial": [0.0, 8.0]}


def asking(name: str, inputs: dict[str, Any] | None = None) -> Scene:
    """A built-in car with all that is along an input, at few instants."""
    content = Scene.load(name).model_dump(exclude_none=True)
    content["effects"] = []
    content["time"]["samples"] = 7
    content["inputs"] = inputs or content["inputs"]
    content["mechanism"].setdefault("wheel_radius", 300.0)
    scene = Scene.from_mapping(content)
    return scene.model_copy(update={"effects": [e for e in scene.mechanism.effects if e in ALONG]})


def test_by_which_input_the_wheel_is_moved_makes_no_difference() -> None:
    """Per mm of travel, whether the arm's angle, the travel or the damper's length is driven."""
    by_travel = simulate(asking("pushrod", {"wheel_travel": TRAVEL, "rack": STEER}))
    times = by_travel.times
    poses = by_travel.position
    arm = poses["lower_ball_joint"] - poses["lower_arm_front"]
    angle = np.arccos(arm[:, 2] / np.linalg.norm(arm, axis=-1))
    table = {"table": {"times": times.tolist(), "values": angle.tolist()}}
    by_arm = simulate(asking("pushrod", {"arm_angle": table, "rack": STEER}))
    for quantity in ("angle_gradient", "dimension_gradient", "dimension"):
        for name, array in by_travel.numbers[quantity].items():
            # Of the rack, the other input is held.
            if not name.endswith("_by_rack") and not name.startswith("screw_"):
                # The table's angles are off by some roundings, which the wheel multiplies.
                assert np.allclose(by_arm.numbers[quantity][name], array, rtol=1e-9, atol=1e-11), name


def test_where_the_wheel_does_not_travel_there_is_no_number_and_a_note_says_why() -> None:
    """A trailing arm that stands straight up moves its wheel level."""
    tables = {
        "title": "arm",
        "bodies": {"chassis": ["a", "b"], "arm": ["a", "b", "inner", "centre"]},
        "inputs": {"turn": {"angle": "arm", "from": "drawing"}},
        "roles": {"knuckle": "arm", "wheel_axis": ["inner", "centre"], "inboard": "a"},
    }
    points = {"a": [0, 400, 0], "b": [0, 600, 0], "inner": [0, 650, -300], "centre": [0, 700, -300]}
    content = {
        "effects": ["toe_by_travel"],
        "mechanism": {**tables, "side": "right", "points": points},
        "inputs": {"turn": {"polynomial": [0.0, 0.1]}},
        "time": {"start": 0.0, "stop": 1.0, "samples": 3},
    }
    motion = simulate(Scene.from_mapping(content))
    assert np.isfinite(motion.angle_gradient["toe_by_travel"]).tolist() == [False, True, True]
    assert any("does not travel" in note for note in motion.notes)
