"""Differences over time against their tolerances."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from validate.comparison.compare import Comparison, Outcome
from validate.comparison.over_time import over_time
from validate.html.plot import OTHER, OURS, Panel, Plots, axis, fewer, numbers
from validate.html.run import Run, Told
from validate.html.section import Block, Section, which
from validate.output.report import about, worst_rows

Array = NDArray[np.float64]


def _blocks(run: Run) -> Sequence[Block]:
    blocks = [block for one in run.drawn for block in _of_scene(one, run.points)]
    return [*which(run), *blocks] if blocks else []


def _of_scene(one: Told, points: int) -> Iterator[Block]:
    if one.scene is None:
        return
    for outcome in one.examined.outcomes:
        rows = worst_rows(outcome)
        panels = tuple(
            panel for row in rows if (panel := _panel(outcome, row, one.scene.instants, points)) is not None
        )
        first, second = (solution.formulation for solution in outcome.solutions)
        if panels:
            apart = any(row.verdict == "disagrees" for row in rows)
            yield Plots(f"{outcome.scene}: {first} and {second}", panels, at_once=apart)


def _panel(outcome: Outcome, row: Comparison, instants: Array, points: int) -> Panel | None:
    found = over_time(outcome, row, instants)
    if found is None:
        return None
    at = fewer(found.share, points)
    # A logarithm has no place for a difference of nothing.
    difference = np.where(found.difference > 0.0, found.difference, np.nan)
    times = numbers(found.times[at], 9)
    traces = (
        {"x": times, "y": numbers(found.tolerance[at], 4), "name": "tolerance", "line": {"color": OTHER}},
        {
            "x": times,
            "y": numbers(difference[at], 4),
            "name": "difference",
            "mode": "lines+markers",
            "marker": {"size": 4},
            "line": {"color": OURS, "width": 1},
        },
    )
    told = about(row.quantity, row.name)
    layout = {"xaxis": axis("time [s]"), "yaxis": axis(f"[{row.unit}]", logarithmic=True)}
    return Panel(f"{told}: {row.verdict}, at most {row.share:.2g} of its tolerance", traces, layout)


SECTION = Section("differences", "Differences over time", 55, _blocks, folded=True)
