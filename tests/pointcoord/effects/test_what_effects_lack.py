"""What an effect asks for and does not have is said, with what to do."""

from typing import Any

import pytest

from pointcoord import Scene, SceneError

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
