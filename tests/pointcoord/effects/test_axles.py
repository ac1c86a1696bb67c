"""What two wheels make: laws of mirrors, each wheel as alone, and what is lacking is said."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from pointcoord import Motion, Scene, SceneError, simulate

Array = NDArray[np.float64]
SIDES = {"left": -1.0, "right": 1.0}


AXLE = Scene.load("axle-steer").model_dump(exclude_none=True)
EVERY = ["camber", "toe", "steer_angle", "caster", "steering_axis", "roll_centre", "axle", "ackermann"]
LAWS = {
    "left.wheel_travel": {"polynomial": [-15.0, 40.0]},
    "right.wheel_travel": {"polynomial": [25.0, -10.0]},
    "rack": {"polynomial": [6.0, 15.0]},
}
"""Numbers that count to the left or to the right."""


def wishbones(laws: Mapping[str, Any], **changes: Any) -> Motion:
    """Two double wishbones on one rack."""
    mechanism = {**AXLE["mechanism"], "wheel_radius": 270.0, "car": {"wheelbase": 1600.0}, **changes}
    time = {"start": 0.0, "stop": 1.0, "samples": 7}
    content = {**AXLE, "mechanism": mechanism, "effects": EVERY, "inputs": laws, "time": time}
    return simulate(Scene.from_mapping(content))


def numbers_of(motion: Motion) -> dict[str, Array]:
    return {n: a for q, of in motion.numbers.items() if q != "position" for n, a in of.items()}


def test_both_wheels_of_an_axle_are_what_each_is_alone() -> None:
    found = numbers_of(wishbones(LAWS))
    points = {
        n.partition(".")[2]: p for n, p in AXLE["mechanism"]["points"].items() if n.startswith("right.")
    }
    for side, sign in SIDES.items():
        drawn = {name: (x, sign * y, z) for name, (x, y, z) in points.items()}
        mechanism = {"type": "double_wishbone", "side": side, "points": drawn, "wheel_radius": 270.0}
        inputs = {name.removeprefix(f"{side}."): law for name, law in LAWS.items()}
        known = {name: law for name, law in inputs.items() if "." not in name}
        own = [effect for effect in EVERY if effect not in ("axle", "ackermann")]
        content = {**AXLE, "mechanism": mechanism, "effects": own, "inputs": known}
        content["time"] = {"start": 0.0, "stop": 1.0, "samples": 7}
        for name, array in numbers_of(simulate(Scene.from_mapping(content))).items():
            assert found[f"{side}.{name}"] == pytest.approx(array, rel=1e-11, abs=1e-11), name


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"wheel_radius": None}, "no wheel_radius"),
        ({"car": None}, "wheelbase"),
    ],
)
def test_what_an_axle_lacks_is_said(changes: dict[str, Any], words: str) -> None:
    with pytest.raises(SceneError, match=words):
        wishbones(LAWS, **changes)


def test_one_wheel_is_no_axle() -> None:
    scene = Scene.load("double-wishbone")
    with pytest.raises(SceneError, match="needs two parts on opposite sides"):
        scene.model_copy(update={"effects": ["axle"]})
