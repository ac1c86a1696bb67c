"""What an effect asks for and does not have is said, with what to do."""

from typing import Any

import numpy as np
import pytest

from pointcoord import Scene, SceneError, simulate

AXLE, LOADS = ("axle", "ackermann"), {"loads": {"force": [0.0, 0.0, 3000.0]}, "wheel_radius": 300.0}


@pytest.mark.parametrize(
    ("name", "mechanism", "effects", "words"),
    [
        ("axle-steer", {"wheel_radius": None}, AXLE, "no wheel_radius"),
        ("axle-steer", {"wheel_radius": 270.0, "car": None}, AXLE, "wheelbase"),
        ("double-wishbone", {}, AXLE, "needs two parts on opposite sides"),
        ("five-link", {}, ("toe_by_rack",), "needs exactly one driven input that is the travel of a slide"),
        ("pushrod", {**LOADS, "loads": {}}, ("loads",), "under \\[mechanism.loads\\]"),
        ("pushrod", {**LOADS, "wheel_radius": None}, ("loads",), "no wheel_radius"),
        ("pushrod", {"loads": {"left": LOADS["loads"]}}, ("loads",), "loads.left"),
    ],
)
def test_what_is_lacking_is_said(
    name: str, mechanism: dict[str, Any], effects: tuple[str, ...], words: str
) -> None:
    content = Scene.load(name).model_dump(exclude_none=True) | {"effects": effects}
    content["mechanism"] |= mechanism
    with pytest.raises(SceneError, match=words):
        Scene.from_mapping(content)


def test_where_there_is_no_number_a_note_says_why() -> None:
    """A trailing arm that stands straight up moves its wheel level."""
    points = {"a": [0, 400, 0], "b": [0, 600, 0], "inner": [0, 650, -300], "centre": [0, 700, -300]}
    mechanism = {
        "bodies": {"chassis": ["a", "b"], "arm": ["a", "b", "inner", "centre"]},
        "inputs": {"turn": {"angle": "arm", "from": "drawing"}},
        "roles": {"knuckle": "arm", "wheel_axis": ["inner", "centre"]},
        "side": "right",
        "points": points,
    }
    inputs, time = {"turn": {"polynomial": [0.0, 0.1]}}, {"start": 0.0, "stop": 1.0, "samples": 3}
    content = {"effects": ["toe_by_travel"], "mechanism": mechanism, "inputs": inputs, "time": time}
    motion = simulate(Scene.from_mapping(content))
    assert np.isfinite(motion.angle_gradient["toe_by_travel"]).tolist() == [False, True, True]
    assert any("does not travel" in note for note in motion.notes)
