"""Every mechanics refuses gradients along a way that no driven input goes, and gives those along others."""

from pathlib import Path
from typing import Any

import pytest
from mechanism_files import SCENES

import absolute
from absolute.effects import effects_of
from pointcoord import Scene, SceneError
from validate.formulations.reference_solution import design_of
from validate.reference.effects.at_pose import numbers_of

TURNED = Path(__file__).with_name("roll-pitch-heave.toml")
ALONG = "needs exactly one driven input"
# Of a car that can roll: it does, is only held over its ground, or stands on its chassis.
ROLLING = Scene.load("axle-roll").model_dump(exclude_none=True)
ROLLING["effects"] = []
ROLLING["mechanism"]["rack_per_turn"] = 50.0
HELD = {"constant": 0.0}
TRAVELS = {"left.wheel_travel": HELD, "right.wheel_travel": HELD}
DRIVEN: dict[str, dict[str, Any]] = {
    "not rolled": {name: law for name, law in ROLLING["inputs"].items() if name != "roll"},
    "by travel": TRAVELS | {"rack": HELD},
    "rolled, by travel": TRAVELS | {"rack": HELD, "roll": HELD},
    "by travel and a steering wheel": TRAVELS | {"steering_wheel": HELD},
    "by heights on its chassis": ROLLING["inputs"] | {"heave": HELD},
}


def refused_by_pointcoord(scene: Scene, effect: str) -> bool:
    try:
        scene.model_copy(update={"effects": (effect,)})
    except SceneError as error:
        return ALONG in str(error)
    return False


def refused_by_absolute(scene: Scene, effect: str) -> bool:
    model = absolute.compile(scene.mechanism.plain(tuple(scene.inputs)))
    try:
        effects_of([f"{part}.{effect}".removeprefix(".") for part in model.corners], model)
    except absolute.DescriptionError as error:
        return ALONG in str(error)
    return False


def left_out_by_the_reference(scene: Scene, effect: str) -> bool:
    design = design_of(scene)
    return len(numbers_of(design, [effect])) != len(design.corners)


@pytest.mark.parametrize("way", ["travel", "rack", "roll"])
def test_all_mechanics_have_or_refuse_the_same_gradients_of_the_same_scenes(way: str) -> None:
    scenes = {name: Scene.load(name) for name in SCENES} | {TURNED.stem: Scene.load(TURNED)}
    scenes |= {what: Scene.from_mapping(ROLLING | {"inputs": inputs}) for what, inputs in DRIVEN.items()}
    each, refused = (refused_by_pointcoord, refused_by_absolute, left_out_by_the_reference), []
    for name, scene in scenes.items():
        if "toe" in scene.mechanism.effects:
            found = {refuses(scene, f"toe_by_{way}") for refuses in each}
            assert len(found) == 1, name
            refused += [name] if found == {True} else []
    assert (0 < len(refused) < len(scenes)) or way == "travel"
    if way == "roll":
        wanted = ["not rolled", "by travel", "by travel and a steering wheel"]
        assert [name for name in DRIVEN if name in refused] == wanted
