"""The curves of a scene as engineers draw them: the angles of the wheel, its travel upward."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from pointcoord import Motion
from pointcoord.effects.registry import ALWAYS
from validate.curves.numbers import TRAVEL, Number, numbers_of, usual
from validate.formulations.protocol import Solution
from validate.html.plot import OTHER, OURS, Panel, Plots, Trace, curve, fewer, marks, panel, plain
from validate.html.run import Drawn

Array = NDArray[np.float64]

# Marks of the other model on a curve: more would hide the line that they are to be seen beside.
MARKS = 25
PLACE = ALWAYS[0].quantities[0].name


def wheel_angles(one: Drawn, models: Sequence[Solution], points: int) -> tuple[Plots | None, str]:
    """The curves of a scene, and what there is to say of them, such as why there are none."""
    if one.scene is None or one.motion is None or not models:
        return None, "no curves: pointcoord solves no instant of it"
    pairs = usual(one.scene, numbers_of(one.scene), one.motion).pairs
    centre = one.scene.mechanism.topology.wheel_centre
    found = [_panel(pair, models, one.motion, centre, points) for pair in pairs]
    first, *rest = models
    dots = "".join(f"; dots: {other.formulation}" for other in rest)
    if panels := tuple(one for one in found if one is not None):
        return Plots(f"line: {first.formulation}{dots}", panels), ""
    names = dict.fromkeys(n.words for pair in pairs for n in pair if len(n.path) > 1)
    return None, f"no curves: {first.formulation} gives no {' and no '.join(names)}"


def _panel(
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
