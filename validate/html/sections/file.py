"""A file of results compared with the car: values of each column, computed values, and differences."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from validate.comparison.compare import Comparison
from validate.html.blocks import (
    OTHER,
    OURS,
    Block,
    Panel,
    Paragraph,
    Plots,
    curve,
    fewer,
    gaps,
    marks,
    panel,
    plain,
)
from validate.html.run import POINTS, Run
from validate.measured.comparing import DataOutcome
from validate.output.report import about, held_to, in_degrees, rows_over, used, when, worst_rows
from validate.output.table import Cell, Table
from validate.tables.units import degrees_of

HEAD = ("number", "verdict", "largest difference", "tolerance", "at", "possible explanation, or reason")


def files(run: Run) -> Iterator[Block]:
    """Every number that a file gives, with its verdict; then plots of the worst number of each quantity."""
    for name, file in run.record.files.items():
        outcome, source = file.outcome, file.outcome.solutions[0].formulation
        # A file may give every number of every point, so numbers that disagree come first.
        rows = sorted(outcome.rows, key=lambda row: row.verdict != "disagrees")
        yield Paragraph(
            f"{source} compared with the car of {name}: {rows_over(len(file.rows), file.over)}, "
            f"{held_to(run.record.factor)}."
        )
        caption = "Each point, body or angle that the file gives; angles in degrees."
        cells, absent = [_cells(file, row) for row in rows], Cell("not given", verdict="not given")
        cells += [(words, absent, "-", "-", "", "the scene asks for it") for words in file.absent]
        yield Table(HEAD, tuple(cells), caption=caption)
        worst = worst_rows(outcome)
        if panels := tuple(one for row in worst for one in _panels(file, row)):
            yield Plots(f"{source}: crosses: the file; line: pointcoord", panels)


def _cells(file: DataOutcome, row: Comparison) -> tuple[str | Cell, ...]:
    there = not math.isnan(row.difference)
    return (
        Cell(about(row.quantity, row.name), ", ".join(h.series.column for h in file.columns_of(row))),
        Cell(row.verdict, used(row.share) if there else "", row.verdict),
        in_degrees(row.difference, row.unit),
        in_degrees(row.tolerance, row.unit),
        when(row, 4) if there else "",
        row.why or "; ".join(file.outcome.explained(row)[:1]),
    )


def _panels(file: DataOutcome, row: Comparison) -> Iterator[Panel]:
    """The worst column of a row with computed values, and its differences; nothing if none is computed."""
    columns = [held for held in file.columns_of(row) if np.isfinite(held.gap).any()]
    if not columns:
        return
    held = max(columns, key=lambda held: float(np.nanmax(held.share)))
    # Rows of a file may be in any order. Two rows at the same value, with different inputs, are both drawn.
    order = np.argsort(file.at, kind="stable")
    share = np.nan_to_num(held.share[order], nan=-1.0)
    at = order[np.asarray(fewer(share, POINTS), dtype=np.intp)]
    turn = math.degrees(1.0) if file.over.endswith("[rad]") else 1.0
    over, x = plain(file.over.replace("[rad]", "[deg]")), turn * file.at[at]
    factor, unit = degrees_of(held.series.meaning.unit)
    title = f"{plain(held.series.column)} ({held.series.meaning.words})"
    ours, theirs = factor * held.ours[at], factor * held.series.values[at]
    traces = curve("pointcoord", x, ours, OURS), marks("file", x, theirs, OTHER)
    yield panel(f"{title} over {over}: {row.verdict}", over, f"[{unit}]", traces)
    words = f"{title}, difference: at most {used(row.share)}"
    limit = factor * file.outcome.factor * held.tolerance[at]
    yield gaps(words, over, x, factor * held.gap[at], limit, unit)
