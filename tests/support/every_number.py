"""Scenes with every number that their cars can have, at few instants, and what these exactly are."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

from every_effect import NUMBERS_OF_A_CAR
from mechanism_files import SCENES

from pointcoord import Scene
from validate.formulations.protocol import Solution
from validate.formulations.reference_solution import reference_solution

SAMPLES = 4
# Scenes beside the shipped ones: a car that rolls, pitches and heaves.
OWN = Path(__file__).parents[1] / "mechanisms"
TURNED = "roll-pitch-heave"
FAR = f"{TURNED} far"
# What an axle has only where both wheels are steered to the same side.
OF_A_TURN = {"ackermann", "ackermann_error", "turning_radius"}
CAR = {"axle": "rear", **NUMBERS_OF_A_CAR}
LOAD = {"force": (-310.0, 1870.0, 3105.0), "moment": (4100.0, -73000.0, 21000.0)}


def load(name: str) -> Scene:
    """A shipped scene, or one of `tests/mechanisms`, which may be drawn far from the origin."""
    near, _, far = name.partition(" ")
    own = OWN / f"{near}.toml"
    scene = Scene.load(own if own.exists() else near)
    if not far:
        return scene
    points = {n: (x + 1e5, y, z - 3e5) for n, (x, y, z) in scene.mechanism.points.items()}
    return scene.model_copy(update={"mechanism": scene.mechanism.model_copy(update={"points": points})})


def one_of_each() -> list[str]:
    """The last scene of each mechanism and closure."""
    parts = {name: load(name).mechanism for name in SCENES}
    return [*{(part.type, part.closure): name for name, part in parts.items()}.values()]


@cache
def asked(name: str, every: bool = True) -> Scene:
    """A scene at few instants; with every effect that its car has, given what they need."""
    content: dict[str, Any] = load(name).model_dump(exclude_none=True, exclude={"points"})
    # At the start of a scene an axle goes straight ahead, where it has no turning radius.
    time = content["time"]
    start = time["start"] + 0.05 * (time["stop"] - time["start"])
    content["time"] = {**time, "start": start, "samples": SAMPLES}
    if not every:
        return Scene.from_mapping(content, name)
    content["mechanism"].setdefault("wheel_radius", 300.0)
    content["mechanism"]["car"] = {**CAR, **content["mechanism"].get("car", {})}
    topology = load(name).mechanism.topology
    wheels = [role.removesuffix("wheel_axis") for role in topology.roles if role.endswith("wheel_axis")]
    content["mechanism"]["loads"] = {wheel.removesuffix("."): LOAD for wheel in wheels}
    plain = Scene.from_mapping(content | {"effects": ()}, name)
    # What loads make of one axle is enough: each rod of two wheels is a way of the car of its own.
    effects = [one for one in plain.mechanism.effects if (name, one) != ("axle-roll", "loads")]
    return Scene.from_mapping(content | {"effects": effects}, name)


@cache
def exact(name: str) -> Solution:
    """By the reference, with every effect, which the scene as it is may ask for fewer of."""
    return reference_solution(asked(name))
