"""The assemblies of scenes: their knuckles at the drawing, with each input that can hold them there."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pointcoord import Scene, solve_poses
from validate.assemblies.count import Counted, count_assemblies
from validate.assemblies.legs import NotOnLegsError
from validate.output.table import Part, Table

SHIPPED = ("bounce", "off-axis-strut", "double-wishbone", "five-link")
HEAD = ("scene", "held", "paths", "candidates", "certified", "distinct", "real", "the drawing's")


@dataclass(frozen=True)
class SceneCount:
    """A count, or why there is none.

    Attributes:
        held: the inputs that are held at their drawn values.
    """

    scene: str
    held: tuple[str, ...]
    counted: Counted | None
    reason: str = ""

    @property
    def found(self) -> bool:
        """Whether two runs agree, and the drawing's is among them."""
        return self.counted is not None and self.counted.agreed and self.counted.drawn


def counts(name: str) -> Iterator[SceneCount]:
    """The assemblies of a scene, by each input beside the steering that holds its mechanism.

    Raises:
        SceneError: there is no such scene, or it does not hold its mechanism.
    """
    scene = Scene.load(name)
    for held in _ways_to_hold(scene):
        there = scene.model_copy(update={"inputs": {one: {"constant": "drawn"} for one in held}})
        drawn = {one: law.series(0.0, 0)[0] for one, law in there.functions.items()}
        places = {point: np.array(at) for point, at in solve_poses(there, drawn).position.items()}
        try:
            yield SceneCount(name, held, count_assemblies(there.mechanism.plain(held), places))
        except NotOnLegsError as error:
            yield SceneCount(name, held, None, str(error))


def _ways_to_hold(scene: Scene) -> list[tuple[str, ...]]:
    """The scene's own inputs, and then another one in place of that which is no travel of a slide."""
    known = scene.mechanism.structure.inputs
    steering = tuple(name for name in scene.inputs if known[name].named("slide"))
    own = [name for name in scene.inputs if name not in steering and not known[name].moves_the_chassis]
    if len(own) != 1:
        return [(*own, *steering)]
    others = [name for name, one in known.items() if one.kind in ("angle", "height")]
    return [(name, *steering) for name in dict.fromkeys((*own, *others))]


def parts(found: Sequence[SceneCount]) -> tuple[Part, ...]:
    """What was counted, for people."""
    rows = [_row(one, one.counted) for one in found if one.counted is not None]
    lines = [
        f"{one.scene}, {' and '.join(one.held)}: not counted: {one.reason}" for one in found if one.reason
    ]
    table: list[Part] = [Table(HEAD, tuple(rows))] if rows else []
    return (*table, *lines)


def _row(one: SceneCount, counted: Counted) -> tuple[str, ...]:
    candidates, certified = (" ".join(map(str, runs)) for runs in (counted.candidates, counted.certified))
    numbers = (str(counted.paths), candidates, certified, str(len(counted.assemblies)), str(counted.real))
    return (one.scene, " ".join(one.held), *numbers, "real" if counted.drawn else "not found")


def data(found: Sequence[SceneCount]) -> dict[str, Any]:
    """The same for programs."""
    return {"counts": [{"scene": one.scene, "held": list(one.held), **_data(one)} for one in found]}


def _data(one: SceneCount) -> Mapping[str, Any]:
    if one.counted is None:
        return {"reason": one.reason}
    return {
        "paths": one.counted.paths,
        "candidates": list(one.counted.candidates),
        "certified": list(one.counted.certified),
        "distinct": len(one.counted.assemblies),
        "real": one.counted.real,
        "drawn": one.counted.drawn,
        "agreed": one.counted.agreed,
    }
