"""The suspension as an animated 3D drawing, both models superimposed, with plots of the wheel angles."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from pointcoord.effects.registry import ALWAYS
from validate.arrays import Array
from validate.closed_drawing import closed_drawing
from validate.curves.numbers import Number, angles_of, usual
from validate.formulations.protocol import Solution
from validate.html.blocks import (
    OTHER,
    OURS,
    Block,
    Panel,
    Paragraph,
    Plots,
    Spatial,
    curve,
    fewer,
    marks,
    panel,
    plain,
)
from validate.html.run import FRAMES, POINTS, Drawn, Run

DIGITS = 2  # decimals of positions, mm
# Markers of the second model on a curve: more would hide the line of the first model.
MARKS = 25
PLACE = ALWAYS[0].quantities[0].name


def motions(run: Run) -> Iterator[Block]:
    """An animation of each drawn scene; those that do not agree come first."""
    yield from map(Paragraph, run.not_drawn)
    yield from map(_of_scene, run.by_verdict)


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
    )


def _frames(one: Drawn, model: Solution, known: Mapping[str, Array], shown: Array) -> Any:
    """The position of each point at each shown instant, or None where the model does not give it.

    Points of the chassis are data for every model; their positions follow from the motion of the chassis.
    """
    there, chassis = np.isin(one.motion.times, model.times), one.scene.mechanism.topology.chassis
    places = {name: one.motion.numbers[PLACE][name][there] for name in chassis}
    places |= model.numbers.get(PLACE, {})
    rows = np.full((len(shown), len(known), 3), np.nan)
    given = np.isin(shown, model.times)
    at = np.searchsorted(model.times, shown[given])
    for i, name in enumerate(known):
        if name in places:
            rows[given, i] = places[name][at]
    frames = _rounded(np.nan_to_num(rows))
    for frame, point in np.argwhere(~np.isfinite(rows).all(axis=-1)):
        frames[frame][point] = None
    return frames


def _rounded(places: Array) -> Any:
    return np.round(places, DIGITS).tolist()


def _caption(one: Drawn) -> str:
    first, second = (model.formulation for model in one.models)
    title = f"{one.examined.title}. " if one.examined.title else ""
    lines = f"{first}: wide blue lines, {second}: narrow orange lines; dashed: the drawing"
    return f"{title}{lines}; {one.motion.closing.words}"


def _wheel_angles(one: Drawn) -> tuple[Plots | None, str]:
    """The curves of a scene, or why there are none."""
    pairs = usual(one.scene, one.motion, angles_of(one.scene)).pairs
    first, second = one.models
    if panels := tuple(drawn for pair in pairs if (drawn := _angle_panel(pair, one))):
        return Plots(f"line: {first.formulation}; dots: {second.formulation}", panels), ""
    names = dict.fromkeys(n.words for pair in pairs for n in pair if len(n.path) > 1)
    return None, f"no curves, because {first.formulation} does not give {' or '.join(names)}"


def _angle_panel(pair: tuple[Number, Number], one: Drawn) -> Panel | None:
    """The line of the first model and the dots of the second; None if the first does not give the numbers."""
    first, second = (_given(pair, one, model) for model in one.models)
    if first is None:
        return None
    x, y = first
    # The extreme value of each stretch of the curve is kept.
    at = fewer(np.abs(np.nan_to_num(x - np.nanmean(x))), POINTS) if np.isfinite(x).any() else range(0)
    line, dots = (plain(model.formulation) for model in one.models)
    traces = [curve(line, x[at], y[at], OURS)]
    if second is not None:
        x, y = (values[:: max(len(values) // MARKS, 1)] for values in second)
        traces.append(marks(dots, x, y, OTHER, "circle-open", 5))
    across, up = pair
    return panel(f"{up.words} over {across.words}", _title(across), _title(up), traces)


def _given(pair: tuple[Number, Number], one: Drawn, model: Solution) -> list[Array] | None:
    """Two numbers by a model, or None if it lacks one; time, inputs and wheel travel are from pointcoord."""
    there, own = np.isin(one.motion.times, model.times), one.motion
    try:
        return [n.shown(own, own)[there] if len(n.path) == 1 else n.shown(own, model) for n in pair]
    except KeyError:
        return None


def _title(number: Number) -> str:
    return f"{number.words} [{number.unit_shown}]" + (f", {number.mark} {number.sign}" if number.sign else "")
