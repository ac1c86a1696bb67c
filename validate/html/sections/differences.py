"""Differences over time against their tolerances."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from validate.comparison.compare import Comparison, Outcome
from validate.comparison.over_time import over_time
from validate.html.plot import Panel, Plots, fewer, gaps
from validate.html.run import Drawn, Run
from validate.html.section import Block, Section, which
from validate.output.report import about, pair_of, worst_rows

Array = NDArray[np.float64]


def _blocks(run: Run) -> Sequence[Block]:
    blocks = [block for one in run.drawn for block in _of_scene(one, run.points)]
    return [*which(run), *blocks] if blocks else []


def _of_scene(one: Drawn, points: int) -> Iterator[Block]:
    if one.scene is None:
        return
    for outcome in one.examined.outcomes:
        rows = worst_rows(outcome)
        panels = [_panel(outcome, row, one.scene.instants, points) for row in rows]
        if drawn := tuple(panel for panel in panels if panel is not None):
            apart = any(row.verdict == "disagrees" for row in rows)
            yield Plots(f"{outcome.scene}: {pair_of(outcome)}", drawn, at_once=apart)


def _panel(outcome: Outcome, row: Comparison, instants: Array, points: int) -> Panel | None:
    found = over_time(outcome, row, instants)
    if found is None:
        return None
    at = fewer(found.share, points)
    words = f"{about(row.quantity, row.name)}: {row.verdict}, at most {row.share:.2g} of its tolerance"
    return gaps(words, "time [s]", found.times[at], found.difference[at], found.tolerance[at], row.unit)


SECTION = Section("differences", "Differences over time", 55, _blocks, folded=True)
