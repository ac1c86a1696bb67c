"""The suspension in space as it moves, both models over each other, beside the angles of its wheel."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects.registry import ALWAYS
from validate.closed_drawing import closed_drawing
from validate.curves.numbers import Number, angles_of, usual
from validate.formulations.protocol import Solution
from validate.html.plot import OTHER, OURS, Panel, Plots, Trace, curve, fewer, marks, panel, plain
from validate.html.run import FRAMES, POINTS, Drawn, Run
from validate.html.section import PLOTLY, Block, Section, which

Array = NDArray[np.float64]

DIGITS = 2  # behind the point of places, mm
# Marks of the other model on a curve: more would hide the line that they are to be seen beside.
MARKS = 25
ROUNDING = 1e-6  # mm; a drawing that closes comes back to less
PLACE = ALWAYS[0].quantities[0].name


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
    return [*which(run), *map(_of_scene, run.drawn)]


def _of_scene(one: Drawn) -> Block:
    models, scene, part = one.models, one.scene, one.scene.mechanism
    topology, every = part.topology, np.unique(np.concatenate([model.times for model in models]))
    at = every[np.linspace(0, len(every) - 1, min(len(every), FRAMES)).round().astype(int)]
    known = {name: np.array(part.points[name]) for name in topology.points if name in part.points}
    number = {name: i for i, name in enumerate(known)}
    lines = [ends for constraint in topology.constraints for ends in constraint.segments]
    if topology.wheel_axis:
        inner, centre = topology.wheel_axis
        lines.append((inner, centre))
    for body in topology.bodies.values():
        lines += zip(body, (*body[1:], body[0]), strict=True)
    up, right, closed = np.array(part.up), np.array(part.right), closed_drawing(scene).places
    data: dict[str, Any] = {
        "times": [float(f"{time:.6g}") for time in at],
        "points": [*known],
        "chassis": [number[name] for name in topology.chassis if name in number],
        "lines": [[number[a], number[b]] for a, b in lines if a in number and b in number],
        "axes": [right.tolist(), np.cross(right, up).tolist(), up.tolist()],
        "drawn": _rounded(np.stack([*known.values()])),
        "closed": _rounded(np.stack([closed.get(name, place) for name, place in known.items()])),
        "models": [{"name": m.formulation, "frames": _frames(one, m, known, at)} for m in models],
    }
    curves, why = _wheel_angles(one)
    return Spatial(
        one.examined.name,
        _caption(one) + (f"; {why}" if why else ""),
        json.dumps(data, allow_nan=False),
        len(at),
        curves,
        bool(one.examined.status),
    )


def _frames(one: Drawn, model: Solution, known: Mapping[str, Array], shown: Array) -> Any:
    """Of each instant that is shown a place for each point, None for one that is not given.

    Points of the chassis are given to every model: they are where the chassis is moved to.
    """
    readout = one.motion.solved.readout
    chassis, origin = readout.chassis, readout.mechanism.origin
    still = np.zeros((len(model.times), 3))
    drawn = {n: known[n] - origin + still for n in one.scene.mechanism.topology.chassis if n in known}
    laws = readout.laws(model.times)
    shift = origin + sum(chassis.shifts(laws)[:1], np.zeros(3))
    turned = chassis.turned_by(laws, [drawn])[0]
    places: dict[str, Array] = {name: place + shift for name, place in turned.items()}
    places |= model.numbers.get(PLACE, {})
    rows = np.full((len(shown), len(known), 3), np.nan)
    given = np.isin(shown, model.times)
    at = np.searchsorted(model.times, shown[given])
    for i, name in enumerate(known):
        if name in places:
            rows[given, i] = places[name][at]
    there = np.isfinite(rows).all(axis=-1)
    frames = _rounded(np.nan_to_num(rows))
    for frame, point in np.argwhere(~there):
        frames[frame][point] = None
    return frames


def _rounded(places: Array) -> Any:
    return np.round(places, DIGITS).tolist()


def _caption(one: Drawn) -> str:
    lines, moved = ("wide blue lines", "narrow orange lines"), one.examined.closing
    told = [f"{model.formulation} in {line}" for model, line in zip(one.models, lines, strict=False)]
    closing = ""
    if moved:
        closing = f"; closing it moves {moved['point']} by {moved['largest']:.3g} mm"
        if moved["largest"] <= ROUNDING:
            closing = "; it closes, no point moves by more than rounding"
    called = f"{one.examined.title}. " if one.examined.title else ""
    return f"{called}{', '.join(told)}; dashed: the drawing{closing}"


def _wheel_angles(one: Drawn) -> tuple[Plots | None, str]:
    """The curves of a scene, or why there are none."""
    pairs = usual(one.scene, one.motion, angles_of(one.scene)).pairs
    first, second = one.models
    if panels := tuple(drawn for pair in pairs if (drawn := _angle_panel(pair, one))):
        return Plots(f"line: {first.formulation}; dots: {second.formulation}", panels), ""
    names = dict.fromkeys(n.words for pair in pairs for n in pair if len(n.path) > 1)
    return None, f"no curves: {first.formulation} gives no {' and no '.join(names)}"


def _angle_panel(pair: tuple[Number, Number], one: Drawn) -> Panel | None:
    """The line of the first model and the dots of the second; None where the first does not give it.

    The travel of the wheel is pointcoord's.
    """
    traces: list[Trace] = []
    for model in one.models:
        there = np.isin(one.motion.times, model.times)
        try:
            x, y = (
                n.shown(one.motion, one.motion)[there] if len(n.path) == 1 else n.shown(one.motion, model)
                for n in pair
            )
        except KeyError:
            if not traces:
                return None
            continue
        name = plain(model.formulation)
        if not traces:
            # Of a stretch of a curve the place farthest out is kept.
            at = fewer(np.abs(np.nan_to_num(x - np.nanmean(x))), POINTS) if np.isfinite(x).any() else range(0)
            traces.append(curve(name, x[at], y[at], OURS))
        else:
            some = slice(None, None, max(len(x) // MARKS, 1))
            traces.append(marks(name, x[some], y[some], OTHER, "circle-open", 5))
    across, up = pair
    return panel(f"{up.words} over {across.words}", _title(across), _title(up), traces)


def _title(number: Number) -> str:
    return f"{number.words} [{number.unit_shown}]" + (f", + {number.sign}" if number.sign else "")


SECTION = Section("motion", "The suspension in motion", 30, _blocks)
