"""The suspension in space as it moves, both models over each other, beside the angles of its wheel."""

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
from validate.curves.numbers import TRAVEL, Number, numbers_of, usual
from validate.formulations.protocol import Solution
from validate.html.plot import OTHER, OURS, Panel, Plots, Trace, curve, fewer, marks, panel, plain
from validate.html.run import Drawn, Run
from validate.html.section import PLOTLY, Block, Section, which
from validate.output.table import Table

Array = NDArray[np.float64]

# Digits behind the point of places, mm.
DIGITS = 2
# Marks of the other model on a curve: more would hide the line that they are to be seen beside.
MARKS = 25
# mm; a drawing that closes comes back to less.
ROUNDING = 1e-6
PLACE = ALWAYS[0].quantities[0].name
CLOSING = (
    "How far each point of the drawing moves until it closes at its own inputs, mm: links are as long as "
    "drawn, and what does not fit moves. A large number is another car than the one drawn; "
    f"rounding is less than {ROUNDING:g} mm."
)


@dataclass(frozen=True)
class Spatial:
    """A drawing in space that moves.

    Attributes:
        scene: whose it is. caption: what its lines are. json: what is drawn, for the script of the page.
        count: of its instants. curves: that stand beside it.
        at_once: whether it is seen before anybody opens it, as the first one is.
    """

    template: ClassVar[str] = "spatial.html"
    scripts: ClassVar[tuple[str, ...]] = (PLOTLY, "plots.js", "spatial.js")
    scene: str
    caption: str
    json: str
    count: int
    curves: Plots | None = None
    at_once: bool = False


def _blocks(run: Run) -> Sequence[Block]:
    blocks = [_of_scene(one, one.scene, run) for one in run.drawn if one.scene is not None]
    return [*which(run), *blocks, *_closing(run)]


def _of_scene(one: Drawn, scene: Scene, run: Run) -> Block:
    models, instants = one.models, scene.instants
    topology = scene.mechanism.topology
    # Instants of the scene that any of the models gives; of a scene that nobody solves the drawing stands.
    given = np.isin(instants, np.concatenate([model.times for model in models])) if models else [True]
    reached = np.flatnonzero(given)
    at = instants[reached[:: max(-(-len(reached) // run.frames), 1)]]
    known = {name: np.array(p) for name, p in scene.mechanism.points.items()}
    points = [name for name in topology.points if name in known]
    number = {name: i for i, name in enumerate(points)}
    lines = [ends for constraint in topology.constraints for ends in constraint.segments]
    if topology.wheel_axis:
        inner, centre = topology.wheel_axis
        lines.append((inner, centre))
    for body in topology.bodies.values():
        lines += zip(body, (*body[1:], body[0]), strict=True)
    up, right = np.array(scene.mechanism.up), np.array(scene.mechanism.right)
    data: dict[str, Any] = {
        "times": [float(f"{time:.6g}") for time in at],
        "points": points,
        "chassis": [number[name] for name in topology.chassis if name in number],
        "lines": [[number[a], number[b]] for a, b in lines if a in number and b in number],
        "axes": [right.tolist(), np.cross(right, up).tolist(), up.tolist()],
        "drawn": _rounded(np.stack([known[name] for name in points])),
        "closed": _closed(scene, known, points),
        "models": [
            {
                "name": m.formulation,
                "frames": _frames(_places(scene, one.motion, m, known), m.times, points, at),
            }
            for m in models
        ],
    }
    curves, why = _wheel_angles(one, models, run.points)
    return Spatial(
        one.examined.name,
        _caption(one, models) + (f"; {why}" if why else ""),
        json.dumps(data, allow_nan=False),
        max(len(at), 1),
        curves,
        bool(one.examined.status),
    )


def _closed(scene: Scene, known: Mapping[str, Array], points: Sequence[str]) -> Any:
    """Where the points of the drawing are once it is closed; None of one that cannot be."""
    try:
        places = closed_drawing(scene).places
    except PointcoordError:
        return None
    return _rounded(np.stack([places.get(name, known[name]) for name in points])) if places else None


def _places(
    scene: Scene, motion: Motion | None, model: Solution, known: Mapping[str, Array]
) -> Mapping[str, Array]:
    """Of each point that a model has its places at its instants, (N, 3).

    Points of the chassis are given to every model: they are where the chassis is moved to.
    """
    if motion is None:
        return model.numbers.get(PLACE, {})
    readout = motion.solved.readout
    origin, still = readout.mechanism.origin, np.zeros((len(model.times), 3))
    drawn = {n: known[n] - origin + still for n in scene.mechanism.topology.chassis if n in known}
    shift = origin + sum(readout.chassis.states(model.times, 0), np.zeros(3))
    held = {
        name: place + shift
        for name, place in readout.chassis.turned_by(readout.laws(model.times), [drawn])[0].items()
    }
    return {**held, **model.numbers.get(PLACE, {})}


def _frames(places: Mapping[str, Array], times: Array, points: Sequence[str], shown: Array) -> Any:
    """Of each instant that is shown a place for each point, None for one that is not given.

    Args:
        places: by point, at times, (N, 3).
    """
    rows = np.full((len(shown), len(points), 3), np.nan)
    given = np.isin(shown, times)
    at = np.searchsorted(times, shown[given])
    for i, name in enumerate(points):
        if name in places:
            rows[given, i] = places[name][at]
    there = np.isfinite(rows).all(axis=-1)
    rounded = _rounded(np.nan_to_num(rows))
    return [
        [place if found else None for place, found in zip(row, are, strict=True)]
        for row, are in zip(rounded, there, strict=True)
    ]


def _rounded(places: Array) -> Any:
    return np.round(places, DIGITS).tolist()


def _closing(run: Run) -> Iterator[Block]:
    """How far the points of the drawings move until they close."""
    closed = {
        one.examined.name: one.examined.closing for one in run.drawn if one.examined.closing is not None
    }
    moved: dict[str, Mapping[str, float]] = {name: one.get("movements", {}) for name, one in closed.items()}
    points = list(dict.fromkeys(point for movements in moved.values() for point in movements))
    rows = tuple((name, *(_size(one[p]) if p in one else "" for p in points)) for name, one in moved.items())
    if points:
        yield Table(("scene", *points), rows, caption=CLOSING, folded=True)


def _size(movement: float) -> str:
    # Less is rounding, and says nothing of the drawing.
    return f"{movement:.3g}" if movement > ROUNDING else "rounding"


def _caption(one: Drawn, models: Sequence[Solution]) -> str:
    lines = ("wide blue lines", "narrow orange lines")
    told = [f"{model.formulation} in {line}" for model, line in zip(models, lines, strict=False)]
    moved = one.examined.closing
    closing = ""
    if moved:
        closing = f"; closing it moves {moved['point']} by {moved['largest']:.3g} mm"
        if moved["largest"] <= ROUNDING:
            closing = "; it closes, no point moves by more than rounding"
    stopped = f". Stopped: {one.stopped}" if one.stopped else ""
    called = f"{one.examined.title}. " if one.examined.title else ""
    whose = f"{called}{', '.join(told)}; " if told else called
    return f"{whose}dashed: the drawing{closing}{stopped}"


def _wheel_angles(one: Drawn, models: Sequence[Solution], points: int) -> tuple[Plots | None, str]:
    """The curves of a scene, and what there is to say of them, such as why there are none."""
    if one.scene is None or one.motion is None or not models:
        return None, "no curves: pointcoord solves no instant of it"
    pairs = usual(one.scene, numbers_of(one.scene), one.motion).pairs
    centre = one.scene.mechanism.topology.wheel_centre
    found = [_angle_panel(pair, models, one.motion, centre, points) for pair in pairs]
    first, *rest = models
    dots = "".join(f"; dots: {other.formulation}" for other in rest)
    if panels := tuple(one for one in found if one is not None):
        return Plots(f"line: {first.formulation}{dots}", panels), ""
    names = dict.fromkeys(n.words for pair in pairs for n in pair if len(n.path) > 1)
    return None, f"no curves: {first.formulation} gives no {' and no '.join(names)}"


def _angle_panel(
    pair: tuple[Number, Number], models: Sequence[Solution], motion: Motion, centre: str, points: int
) -> Panel | None:
    """The line of the first model and the dots of the second; None where the first does not give it."""
    traces: list[Trace] = []
    lacking: list[str] = []
    for model in models:
        x, y = (_values(number, model, motion) for number in pair)
        if x is None or y is None:
            if model is models[0]:
                return None
            continue
        if TRAVEL in (pair[0].path[0], pair[1].path[0]) and centre not in model.numbers.get(PLACE, {}):
            lacking.append(model.formulation)
        if model is models[0]:
            # Of a stretch of a curve the place farthest out is kept.
            at = fewer(np.abs(np.nan_to_num(x - np.nanmean(x))), points) if np.isfinite(x).any() else range(0)
            traces.append(curve(plain(model.formulation), x[at], y[at], OURS))
        else:
            some = slice(None, None, max(len(x) // MARKS, 1))
            traces.append(marks(plain(model.formulation), x[some], y[some], OTHER, "circle-open", 5))
    across, up = pair
    whose = f" (wheel travel of {', '.join(lacking)} as pointcoord has it)" if lacking else ""
    return panel(f"{up.words} over {across.words}{whose}", _title(across), _title(up), traces)


def _values(number: Number, model: Solution, motion: Motion) -> Array | None:
    """A model's own numbers at its instants; None where it has none.

    The travel is that of the model's own wheel centre; of a model that gives none it is pointcoord's, and the
    panel says so.
    """
    try:
        return number.shown(motion, model)
    except KeyError:
        there = np.isin(motion.times, model.times)
        known = number.path[0] == TRAVEL and there.sum() == len(model.times)
        return number.shown(motion, motion)[there] if known else None


def _title(number: Number) -> str:
    return f"{number.words} [{number.unit_shown()}]" + (f", + {number.sign}" if number.sign else "")


SECTION = Section("motion", "The suspension in motion", 30, _blocks)
