"""What the numbers of two wheels lack is said."""

from typing import Any

import pytest

from pointcoord import Scene, SceneError


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"wheel_radius": None}, "no wheel_radius"),
        ({"car": None}, "wheelbase"),
    ],
)
def test_what_an_axle_lacks_is_said(changes: dict[str, Any], words: str) -> None:
    content = Scene.load("axle-steer").model_dump(exclude_none=True)
    part = {**content["mechanism"], "wheel_radius": 270.0, "car": {"wheelbase": 1600.0}, **changes}
    with pytest.raises(SceneError, match=words):
        Scene.from_mapping({**content, "mechanism": part, "effects": ["roll_centre", "axle", "ackermann"]})


def test_one_wheel_is_no_axle() -> None:
    scene = Scene.load("double-wishbone")
    with pytest.raises(SceneError, match="needs two parts on opposite sides"):
        scene.model_copy(update={"effects": ["axle"]})
