"""The suspension in space as it moves, both models over each other, beside its drawing."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from pointcoord import Motion, PointcoordError, Scene
from pointcoord.effects.registry import ALWAYS
from validate.closed_drawing import closed_drawing
from validate.formulations.protocol import Solution
from validate.html.run import Run, Told
from validate.html.section import Block, Cell, Grid, Section, which

Array = NDArray[np.float64]

# Digits behind the point of places, mm.
DIGITS = 2
# mm; a drawing that closes comes back to less.
ROUNDING = 1e-6
CLOSING = (
    "How far each point of the drawing moves until it closes at its own inputs, mm: links are as long as "
    "drawn, and what does not fit moves. A large number is another car than the one drawn."
)


@dataclass(frozen=True)
class Spatial:
    """A drawing in space that moves.

    Attributes:
        scene: whose it is. caption: what its lines are. json: what is drawn, for the script of the page.
        count: of its instants.
    """

    template: ClassVar[str] = "spatial.html"
    scripts: ClassVar[tuple[str, ...]] = ("spatial.js",)
    scene: str
    caption: str
    json: str
    count: int


def _blocks(run: Run) -> Sequence[Block]:
    blocks = [block for one in run.drawn for block in _of_scene(one, run.frames)]
    return [*which(run), *blocks, *_closing(run)]


def _of_scene(one: Told, frames: int) -> Iterator[Block]:
    if one.scene is None or one.motion is None or not one.examined.outcomes:
        return
    solutions = [
        solution
        for solution in one.examined.outcomes[0].solutions
        if np.array_equal(solution.times, one.motion.times)
    ]
    if not solutions:
        return
    topology = one.scene.mechanism.topology
    count = len(one.motion.times)
    at = np.arange(0, count, -(-count // frames))
    moving = [_places(one.scene, one.motion, solution) for solution in solutions]
    points = [name for name in topology.points if all(name in places for places in moving)]
    number = {name: i for i, name in enumerate(points)}
    lines = [ends for constraint in topology.constraints for ends in constraint.segments]
    lines += [topology.wheel_axis]
    for body in topology.bodies.values():
        lines += zip(body, (*body[1:], body[0]), strict=True)
    known = topology.with_defaults({name: np.array(p) for name, p in one.scene.mechanism.points.items()})
    up, right = np.array(one.scene.mechanism.up), np.array(one.scene.mechanism.right)
    data: dict[str, Any] = {
        "times": [float(f"{time:.6g}") for time in one.motion.times[at]],
        "points": points,
        "chassis": [number[name] for name in topology.chassis if name in number],
        "lines": [[number[a], number[b]] for a, b in lines if a in number and b in number],
        "axes": [right.tolist(), np.cross(right, up).tolist(), up.tolist()],
        "drawn": _rounded(np.stack([known[name] for name in points])),
        "closed": _closed(one.scene, known, points),
        "models": [
            {
                "name": solution.formulation,
                "frames": _rounded(np.stack([places[name][at] for name in points], axis=1)),
            }
            for solution, places in zip(solutions, moving, strict=True)
        ],
    }
    yield Spatial(one.examined.name, _caption(one, solutions), json.dumps(data, allow_nan=False), len(at))


def _closed(scene: Scene, known: Mapping[str, Array], points: Sequence[str]) -> Any:
    """Where the points of the drawing are once it is closed; None of one that cannot be."""
    try:
        places = closed_drawing(scene).places
    except PointcoordError:
        return None
    return _rounded(np.stack([places.get(name, known[name]) for name in points])) if places else None


def _places(scene: Scene, motion: Motion, solution: Solution) -> dict[str, Array]:
    """Of each point its places, (N, 3): what the model gives, and for the rest the chassis as it moves."""
    topology = scene.mechanism.topology
    known = topology.with_defaults({name: np.array(p) for name, p in scene.mechanism.points.items()})
    shift = sum(motion.solved.readout.chassis.states(motion.times, 0), np.zeros(3))
    held = {name: known[name] + np.broadcast_to(shift, (len(motion.times), 3)) for name in topology.chassis}
    given = solution.numbers.get(ALWAYS[0].quantities[0].name, {})
    return held | {name: places for name, places in given.items() if np.isfinite(places).all()}


def _rounded(places: Array) -> Any:
    return np.round(places, DIGITS).tolist()


def _closing(run: Run) -> Iterator[Block]:
    """How far the points of the drawings move until they close."""
    told = [one for one in run.drawn if one.examined.closing is not None]
    movements = {one.examined.name: _movements(one) for one in told}
    points = list(dict.fromkeys(name for moved in movements.values() for name in moved))
    rows = tuple(
        (Cell(name), *(Cell(_size(moved[point]) if point in moved else "") for point in points))
        for name, moved in movements.items()
    )
    if points:
        yield Grid(CLOSING, ("scene", *points), rows)


def _movements(one: Told) -> Mapping[str, float]:
    closing = one.examined.closing or {}
    movements: Mapping[str, float] = closing.get("movements", {})
    return movements


def _size(movement: float) -> str:
    # Less is rounding, and says nothing of the drawing.
    return f"{movement:.3g}" if movement > ROUNDING else "0"


def _caption(one: Told, solutions: Sequence[Solution]) -> str:
    lines = ("wide blue lines", "narrow orange lines")
    told = ", ".join(f"{s.formulation} in {line}" for s, line in zip(solutions, lines, strict=False))
    moved = one.examined.closing
    closing = f"; closing it moves {moved['point']} by {moved['largest']:.3g} mm" if moved else ""
    return f"{told}; dashed: the drawing{closing}"


SECTION = Section("motion", "The suspension in motion", 30, _blocks)
