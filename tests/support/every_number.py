"""Scenes that ask for all that their cars have; at few instants with what that exactly is."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Any

from changed_scenes import content_of
from mechanism_files import SCENES

from pointcoord import Scene
from pointcoord.effects.car_number import BY_ROLL
from pointcoord.effects.registry import EFFECTS
from validate.cars.car import any_rotation
from validate.formulations.protocol import Solution
from validate.formulations.reference_solution import reference_solution
from validate.toml_written import written

NUMBERS_OF_A_CAR = {
    "wheelbase": 2618.5,
    "centre_of_gravity_height": 511.75,
    "brake_share": 0.375,
    "drive_share": 0.9375,
    "spring_rate": 31.75,
    "spring_free_length": 823.25,
}
"""All that a scene may say of the whole car but which of its axles this is, in few bits."""

OF_A_WHEEL = tuple(
    name
    for name, effect in EFFECTS.items()
    if (effect.lines or effect.derivative)
    and not (effect.reports_states and effect.base)
    and not getattr(effect, "of_axle", False)
    and effect.way != BY_ROLL
)
"""The effects that a mechanism without parts, loads and a chassis that rolls may have, without derivatives of
points that have only a number."""
Content = dict[str, Any]
SAMPLES = 4
# Scenes beside the shipped ones: a car that rolls, pitches and heaves.
OWN = Path(__file__).parents[1] / "mechanisms"
TURNED = "roll-pitch-heave"
FAR, ASKEW = " far", " askew"
# What an axle has only where both wheels are steered to the same side.
OF_A_TURN = {"ackermann", "ackermann_error", "turning_radius"}
CAR = {"axle": "rear", **NUMBERS_OF_A_CAR}
LOAD = {"force": (-310.0, 1870.0, 3105.0), "moment": (4100.0, -73000.0, 21000.0)}


def load(name: str) -> Scene:
    """A shipped scene, or one of `tests/mechanisms`; drawn far from the origin, or turned in its axes."""
    plain = name.removesuffix(FAR).removesuffix(ASKEW)
    own = OWN / f"{plain}.toml"
    scene = Scene.load(own if own.exists() else plain)
    if name == plain:
        return scene
    part, changed = scene.mechanism, {}
    if name.endswith(FAR):
        changed["points"] = {n: (x + 1e5, y, z - 3e5) for n, (x, y, z) in part.points.items()}
    else:
        turn = any_rotation(5)
        changed["points"] = {n: tuple((turn @ place).tolist()) for n, place in part.points.items()}
        changed |= {axis: tuple((turn @ getattr(part, axis)).tolist()) for axis in ("up", "right")}
    return scene.model_copy(update={"mechanism": part.model_copy(update=changed)})


def one_of_each(inputs: bool = False) -> list[str]:
    """The last scene of each mechanism and closure, and of each set of inputs if these matter."""
    kinds: dict[object, str] = {}
    for name in SCENES:
        scene = load(name)
        driven = sorted(scene.inputs) if inputs else []
        kinds[scene.mechanism.type, scene.mechanism.closure, *driven] = name
    return [*kinds.values()]


@cache
def asked(name: str, every: bool = True) -> Scene:
    """A scene at few instants; with every effect that its car has, given what they need."""
    content: Content = load(name).model_dump(exclude_none=True, exclude={"points"})
    # At the start of a scene an axle goes straight ahead, where it has no turning radius.
    time = content["time"]
    start = time["start"] + 0.05 * (time["stop"] - time["start"])
    content["time"] = {**time, "start": start, "samples": SAMPLES}
    if not every:
        return Scene.from_mapping(content, name)
    return Scene.from_mapping(with_everything(content, name), name)


def with_everything(content: Content, name: str) -> Content:
    """The content of a scene whose car has all that numbers are made of, and which asks for all of them."""
    part, plain = content["mechanism"], content | {"effects": ()}
    roles = Scene.from_mapping(plain, name).mechanism.topology.roles
    wheels = [role.removesuffix("wheel_axis") for role in roles if role.endswith("wheel_axis")]
    given = {"car": CAR | part.get("car", {}), "loads": {wheel.removesuffix("."): LOAD for wheel in wheels}}
    plain |= {"mechanism": {"wheel_radius": 300.0, **part, **given}}
    effects = Scene.from_mapping(plain, name).mechanism.effects
    # What loads make of one axle is enough: each rod of two wheels is a way of the car of its own.
    few = name.startswith("axle-roll")
    return plain | {"effects": [effect for effect in effects if not (few and effect == "loads")]}


@cache
def exact(name: str, every: bool = True) -> Solution:
    """By the reference, with every effect that the car has or with those of the scene."""
    return reference_solution(asked(name, every))


def every_effect(name: str) -> Scene:
    """A built-in scene with every effect of its car but derivatives by an input."""
    return asking_for_all(Scene.load(name))


def asking_for_all(scene: Scene) -> Scene:
    """The same of any scene."""
    had = [name for name in scene.mechanism.effects if not EFFECTS[name].way]
    return scene.model_copy(update={"effects": had})


def loaded(name: str, samples: int, effects: list[str] | None = None, **more: Any) -> str:
    """A file of a scene with loads, springs and a car, which asks for some effects or for all."""
    content = with_everything(content_of(name, samples=samples, **more), name)
    content |= {"effects": effects or content["effects"]}
    content.pop("points", None)
    return "\n".join(written(json.loads(json.dumps(content))))
