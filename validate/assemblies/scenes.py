"""Counts the assemblies of scenes, with each set of inputs that can hold a mechanism in its drawing."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from pointcoord import Scene, solve_poses
from validate.assemblies.count import count_assemblies
from validate.errors import NoAnswer
from validate.output.table import Part, Table

SHIPPED = ("bounce", "off-axis-strut", "double-wishbone", "five-link")
NUMBERS = ("paths", "candidates", "certified", "distinct", "real")
Count = dict[str, Any]
"""Scene, held inputs, and the result of `count_assemblies`, or the reason why there is no count."""


def counts(name: str) -> Iterator[Count]:
    """Count the assemblies of a scene, with each set of inputs that can hold its mechanism.

    Raises:
        SceneError: there is no such scene, or its inputs do not hold its mechanism.
    """
    scene = Scene.load(name)
    for held in _ways_to_hold(scene):
        there = scene.model_copy(update={"inputs": {one: {"constant": "drawn"} for one in held}})
        drawn = {one: law.series(0.0, 0)[0] for one, law in there.functions.items()}
        places = {point: np.array(at) for point, at in solve_poses(there, drawn).position.items()}
        try:
            found = count_assemblies(there.mechanism.plain(held), places)
        except NoAnswer as error:
            found = {"reason": str(error)}
        yield {"scene": name, "held": list(held), **found}


def complete(found: Sequence[Count]) -> bool:
    """Whether in every count two runs agree, and the drawn assembly is among those found."""
    return all(one.get("agreed") and one["drawn"] for one in found)


def _ways_to_hold(scene: Scene) -> list[tuple[str, ...]]:
    """The scene's inputs; then with each other arm or height for the input that does not steer."""
    known = scene.mechanism.structure.inputs
    steering = tuple(name for name in scene.inputs if known[name].named("slide"))
    own = [name for name in scene.inputs if name not in steering and not known[name].moves_the_chassis]
    others = [name for name, one in known.items() if one.kind in ("arm", "height")] if len(own) == 1 else []
    ways = [tuple(own), *((other,) for other in others if other not in own)]
    return [(*way, *steering) for way in ways]


def parts(found: Sequence[Count]) -> tuple[Part, ...]:
    """The counts as a table, and the reasons of those that are missing."""
    rows, missing = list[tuple[str, ...]](), list[str]()
    for one in found:
        if "reason" in one:
            missing.append(f"{one['scene']}, {' and '.join(one['held'])}: not counted: {one['reason']}")
            continue
        numbers = (str(one[name]).strip("[]").replace(",", "") for name in NUMBERS)
        drawn = "real" if one["drawn"] else "not found"
        rows.append((one["scene"], " ".join(one["held"]), *numbers, drawn))
    head = ("scene", "held", *NUMBERS, "the drawing's")
    return (*([Table(head, tuple(rows))] if rows else ()), *missing)
