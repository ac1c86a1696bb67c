"""The assemblies of scenes: their knuckles at the drawing, with each input that can hold them there."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pointcoord import Scene, solve_poses
from validate.assemblies.count import Counted, count_assemblies
from validate.errors import NoAnswer
from validate.output.table import Part, Table

SHIPPED = ("bounce", "off-axis-strut", "double-wishbone", "five-link")
NUMBERS = ("paths", "candidates", "certified", "distinct", "real")


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

    @property
    def data(self) -> dict[str, Any]:
        """As plain data."""
        one, where = self.counted, {"scene": self.scene, "held": list(self.held)}
        if one is None:
            return {**where, "reason": self.reason}
        numbers = (one.paths, one.candidates, one.certified, len(one.assemblies), one.real)
        return {**where, **dict(zip(NUMBERS, numbers, strict=True)), "drawn": one.drawn, "agreed": one.agreed}


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
        except NoAnswer as error:
            yield SceneCount(name, held, None, str(error))


def _ways_to_hold(scene: Scene) -> list[tuple[str, ...]]:
    """The scene's own inputs, and then another one in place of that which is no travel of a slide."""
    known = scene.mechanism.structure.inputs
    steering = tuple(name for name in scene.inputs if known[name].named("slide"))
    own = [name for name in scene.inputs if name not in steering and not known[name].moves_the_chassis]
    if len(own) != 1:
        return [(*own, *steering)]
    others = [name for name, one in known.items() if one.kind in ("arm", "height")]
    return [(name, *steering) for name in dict.fromkeys((*own, *others))]


def parts(found: Sequence[SceneCount]) -> tuple[Part, ...]:
    """What was counted, for people."""
    rows = tuple(
        (
            *(one.scene, " ".join(one.held)),
            *(str(one.data[name]).strip("[]").replace(",", "") for name in NUMBERS),
            "real" if one.data["drawn"] else "not found",
        )
        for one in found
        if one.counted is not None
    )
    head = ("scene", "held", *NUMBERS, "the drawing's")
    why = (f"{one.scene}, {' and '.join(one.held)}: not counted: {one.reason}" for one in found if one.reason)
    return (*([Table(head, rows)] if rows else ()), *why)


def data(found: Sequence[SceneCount]) -> dict[str, Any]:
    """The same for programs."""
    return {"counts": [one.data for one in found]}
