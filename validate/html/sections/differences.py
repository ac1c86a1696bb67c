"""Differences over time against their tolerances."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from validate.comparison.compare import Comparison, Outcome
from validate.comparison.over_time import over_time
from validate.html.plot import Panel, Plots, fewer, gaps
from validate.html.run import POINTS, Run
from validate.html.section import Block, Section, which
from validate.output.report import about, pair_of, worst_rows

Array = NDArray[np.float64]


def _blocks(run: Run) -> Sequence[Block]:
    blocks: list[Block] = []
    compared = ((one.scene, outcome) for one in run.drawn for outcome in one.examined.outcomes)
    for scene, outcome in compared:
        rows = worst_rows(outcome)
        panels = [_panel(outcome, row, scene.instants, POINTS) for row in rows]
        if drawn := tuple(panel for panel in panels if panel is not None):
            apart = any(row.verdict == "disagrees" for row in rows)
            blocks.append(Plots(f"{outcome.scene}: {pair_of(outcome)}", drawn, at_once=apart))
    return [*which(run), *blocks] if blocks else []


def _panel(outcome: Outcome, row: Comparison, instants: Array, points: int) -> Panel | None:
    found = over_time(outcome, row, instants)
    if found is None:
        return None
    at = fewer(found.share, points)
    words = f"{about(row.quantity, row.name)}: {row.verdict}, at most {row.share:.2g} of its tolerance"
    return gaps(words, "time [s]", found.times[at], found.difference[at], found.tolerance[at], row.unit)


SECTION = Section("differences", "Differences over time", 55, _blocks, folded=True)
