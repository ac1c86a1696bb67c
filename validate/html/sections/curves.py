"""The curves of a scene as engineers draw them: the angles of the wheel, its travel upward."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pointcoord import Motion
from validate.curves.numbers import Number, numbers_of, usual
from validate.formulations.protocol import Solution
from validate.html.plot import OTHER, OURS, Panel, Plots, axis, fewer, numbers
from validate.html.run import Run, Told
from validate.html.section import Block, Section, which

Array = NDArray[np.float64]

# Marks of the other model on a curve: more would hide the line that they are to be seen beside.
MARKS = 25


def _blocks(run: Run) -> Sequence[Block]:
    blocks = [block for one in run.drawn for block in _of_scene(one, run.points)]
    return [*which(run), *blocks] if blocks else []


def _of_scene(one: Told, points: int) -> Iterator[Block]:
    if one.scene is None or one.motion is None:
        return
    other = one.examined.outcomes[0].solutions[1] if one.examined.outcomes else None
    curves = usual(one.scene, numbers_of(one.scene), one.motion)
    panels = tuple(_panel(across, up, one.motion, other, points) for across, up in curves.pairs)
    against = f"; dots: {other.formulation}" if other is not None else ""
    yield Plots(f"{one.examined.name}{against}", panels)


def _panel(across: Number, up: Number, motion: Motion, other: Solution | None, points: int) -> Panel:
    values = [_read(number, motion) for number in (across, up)]
    # Of a stretch of a curve the place farthest out is kept.
    at = fewer(np.abs(values[0] - values[0].mean()), points)
    traces: list[Mapping[str, Any]] = [_trace(values[0][at], values[1][at], "lines", OURS)]
    theirs = None if other is None else [_of_other(n, motion, other) for n in (across, up)]
    if theirs is not None and all(array is not None for array in theirs):
        some = slice(None, None, max(len(motion.times) // MARKS, 1))
        x, y = (np.asarray(array)[some] for array in theirs)
        traces.append(_trace(x, y, "markers", OTHER))
    layout = {"xaxis": axis(_title(across)), "yaxis": axis(_title(up)), "showlegend": False}
    return Panel(f"{up.words} over {across.words}", tuple(traces), layout)


def _trace(x: Array, y: Array, mode: str, colour: str) -> Mapping[str, Any]:
    marks = {"size": 5, "symbol": "circle-open", "color": colour}
    return {"x": numbers(x, 6), "y": numbers(y, 6), "mode": mode, "line": {"color": colour}, "marker": marks}


def _read(number: Number, motion: Motion) -> Array:
    values = number.read(motion, motion)
    return np.degrees(values) if number.unit == "rad" else values


def _of_other(number: Number, motion: Motion, other: Solution) -> Array | None:
    """The other model's own numbers; what is no number of a model, such as time, is the motion's."""
    if not np.array_equal(other.times, motion.times):
        return None
    if len(number.path) == 1:
        return _read(number, motion)
    values = other.numbers.get(number.path[0], {}).get(number.path[1])
    if values is None:
        return None
    if not number.of_the_car:
        values = values[:, "xyz".index(number.path[2])]
    return np.degrees(values) if number.unit == "rad" else values


def _title(number: Number) -> str:
    unit = "deg" if number.unit == "rad" else number.unit
    return f"{number.words} [{unit}]" + (f", + {number.sign}" if number.sign else "")


SECTION = Section("curves", "Wheel angles", 50, _blocks)
