"""The curves of a scene as engineers draw them: the angles of the wheel, its travel upward."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pointcoord import Motion, Scene
from pointcoord.effects.registry import ALWAYS
from validate.curves.numbers import TRAVEL, Number, numbers_of, usual, wheel_centre
from validate.html.plot import OTHER, OURS, Panel, Plots, axis, fewer, numbers, plain
from validate.html.run import Told
from validate.html.sides import Side, sides

Array = NDArray[np.float64]

# Marks of the other model on a curve: more would hide the line that they are to be seen beside.
MARKS = 25
PLACE = ALWAYS[0].quantities[0].name


def wheel_angles(one: Told, points: int) -> tuple[Plots | None, str]:
    """The curves of a scene, and what there is to say of them, such as why there are none."""
    both = sides(one)
    if one.scene is None or one.motion is None or not both:
        return None, "no curves: pointcoord solves no instant of it"
    first, rest = both[0], both[1:]
    curves = usual(one.scene, numbers_of(one.scene), one.motion)
    centre = wheel_centre(one.scene)
    panels = tuple(
        panel
        for across, up in curves.pairs
        if (panel := _panel((across, up), both, one.motion, one.scene, centre, points)) is not None
    )
    dots = "".join(f"; dots: {side.name}" for side in rest)
    if panels:
        return Plots(f"line: {first.name}{dots}", panels), ""
    names = dict.fromkeys(n.words for pair in curves.pairs for n in pair if len(n.path) > 1)
    return None, f"no curves: {first.name} gives no {' and no '.join(names)}"


def _panel(
    pair: tuple[Number, Number], both: Sequence[Side], motion: Motion, scene: Scene, centre: str, points: int
) -> Panel | None:
    """The line of the first side and the dots of the second; None where the first does not give the curve."""
    traces: list[Mapping[str, Any]] = []
    for i, side in enumerate(both):
        values = [_of_side(number, side, motion, scene, centre) for number in pair]
        if any(array is None for array in values):
            if i == 0:
                return None
            continue
        x, y = (np.asarray(array) for array in values)
        if i == 0:
            # Of a stretch of a curve the place farthest out is kept.
            at = fewer(np.abs(np.nan_to_num(x - np.nanmean(x))), points) if np.isfinite(x).any() else range(0)
            traces.append(_trace(x[at], y[at], "lines", OURS, side.name))
        else:
            some = slice(None, None, max(len(x) // MARKS, 1))
            traces.append(_trace(x[some], y[some], "markers", OTHER, side.name))
    across, up = pair
    lacking = [
        side.name for side in both if TRAVEL in (across.path[0], up.path[0]) and not _has(side, centre)
    ]
    whose = f" (wheel travel of {', '.join(lacking)} as pointcoord has it)" if lacking else ""
    layout = {"xaxis": axis(_title(across)), "yaxis": axis(_title(up)), "showlegend": True}
    return Panel(f"{up.words} over {across.words}{whose}", tuple(traces), layout)


def _trace(x: Array, y: Array, mode: str, colour: str, name: str) -> Mapping[str, Any]:
    return {
        "x": numbers(x, 6),
        "y": numbers(y, 6),
        "name": plain(name),
        "mode": mode,
        "line": {"color": colour},
        "marker": {"size": 5, "symbol": "circle-open", "color": colour},
    }


def _has(side: Side, point: str) -> bool:
    return point in side.numbers.get(PLACE, {})


def _of_side(number: Number, side: Side, motion: Motion, scene: Scene, centre: str) -> Array | None:
    """A side's own numbers at its instants; None where it has none.

    What is no number of a model, such as time or an input, is the scene's. The travel is that of the side's
    own wheel centre; of a side that gives none it is pointcoord's, and the panel says so.
    """
    if len(number.path) == 1:
        if side.at.size and side.at[-1] >= len(motion.times):
            return None
        values = number.read(motion, motion)[side.at]
        if number.path[0] == TRAVEL and _has(side, centre):
            apart = side.numbers[PLACE][centre] - motion.numbers[PLACE][centre][side.at]
            values = values + apart @ np.array(scene.mechanism.up)
    else:
        given = side.numbers.get(number.path[0], {}).get(number.path[1])
        if given is None or not len(given):
            return None
        values = given if number.of_the_car else given[:, "xyz".index(number.path[2])]
    return np.degrees(values) if number.unit == "rad" else np.asarray(values)


def _title(number: Number) -> str:
    unit = "deg" if number.unit == "rad" else number.unit
    return f"{number.words} [{unit}]" + (f", + {number.sign}" if number.sign else "")
