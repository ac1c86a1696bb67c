"""A file of results beside the car: what each of its columns says, ours, and how far they are apart."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from validate.ci.record import explained, why_undecided
from validate.comparison.compare import Comparison
from validate.html.plot import OTHER, OURS, Panel, Plots, axis, fewer, numbers, plain
from validate.html.run import Run, Told
from validate.html.section import Block, Paragraph, Section
from validate.measured.comparing import DataOutcome
from validate.output.report import about, counted_as, held_to, in_degrees, when, worst_rows
from validate.output.table import Cell, Table

Array = NDArray[np.float64]

# Rows of the table, those that do not agree first: a file may give every number of every point.
MOST = 300
HEAD = ("number", "verdict", "largest difference", "tolerance", "at", "what would explain it, or why not")


def _blocks(run: Run) -> Sequence[Block]:
    return [block for one in run.told if one.file is not None for block in _of_file(run, one, one.file)]


def _of_file(run: Run, one: Told, file: DataOutcome) -> Iterator[Block]:
    outcome = file.outcome
    source = outcome.solutions[0].formulation
    rows = sorted(outcome.rows, key=lambda row: row.verdict != "disagrees")
    yield Paragraph(
        f"{source} beside the car of {one.examined.name}: {counted_as(len(file.rows), 'row')} over "
        f"{file.over}, {held_to(run.factor)}."
    )
    caption = "Each point, body or angle that the file gives; angles in degrees."
    if len(rows) > MOST:
        caption += f" Not in this table: {len(rows) - MOST}; the data beside this page have them all."
    cells = [_cells(file, row) for row in rows[:MOST]]
    absent = Cell("not given", verdict="not given")
    cells += [(words, absent, "-", "-", "", "the scene asks for it") for words in file.absent]
    yield Table(HEAD, tuple(cells), caption=caption)
    worst = worst_rows(outcome)
    if panels := tuple(panel for row in worst for panel in _panels(file, row, run.points)):
        apart = any(row.verdict == "disagrees" for row in worst)
        yield Plots(f"{source}: crosses: the file; line: pointcoord", panels, at_once=apart)


def _cells(file: DataOutcome, row: Comparison) -> tuple[str | Cell, ...]:
    why = "; ".join(explained(row, file.outcome)[:1])
    if row.verdict == "not tested":
        why = why_undecided(row, file.outcome)
    there = not math.isnan(row.difference)
    return (
        Cell(about(row.quantity, row.name), ", ".join(h.series.column for h in file.columns_of(row))),
        Cell(row.verdict, f"{row.share:.1e} of its tolerance" if there else "", row.verdict),
        in_degrees(row.difference, row.unit),
        in_degrees(row.tolerance, row.unit),
        when(row, 4) if there else "",
        why,
    )


def _factor(unit: str) -> float:
    return math.degrees(1.0) if unit.startswith("rad") else 1.0


def _shown_unit(unit: str) -> str:
    return unit.replace("rad", "deg", 1) if unit.startswith("rad") else unit


def _panels(file: DataOutcome, row: Comparison, points: int) -> Iterator[Panel]:
    """The curve of a row's worst column, and how far it is apart; of one without ours none."""
    columns = [held for held in file.columns_of(row) if np.isfinite(held.gap).any()]
    if not columns:
        return
    held = max(columns, key=lambda held: float(np.nanmax(held.share)))
    meaning = held.series.meaning
    # Rows of a file are in any order; of two at the same value, which inputs tell apart, both are drawn.
    order = np.argsort(file.at, kind="stable")
    share = np.nan_to_num(held.share[order], nan=-1.0)
    at = order[np.asarray(fewer(share, points), dtype=np.intp)]
    unit = "deg" if file.over.endswith("[rad]") else ""
    over = file.over.replace("[rad]", "[deg]") if unit else file.over
    x = numbers(file.at[at] * (math.degrees(1.0) if unit else 1.0), 9)
    factor, words = _factor(meaning.unit), _shown_unit(meaning.unit)
    look = {"symbol": "x", "color": OTHER, "size": 6}
    given = {"x": x, "y": numbers(factor * held.series.values[at], 9), "name": "file", "mode": "markers"}
    ours = {"x": x, "y": numbers(factor * held.ours[at], 9), "name": "pointcoord", "line": {"color": OURS}}
    told = f"{plain(held.series.column)} ({meaning.words})"
    layout = {"xaxis": axis(plain(over)), "yaxis": axis(f"[{words}]"), "showlegend": True}
    yield Panel(f"{told}: {row.verdict}", (ours, given | {"marker": look}), layout)
    gap = np.where(held.gap > 0.0, held.gap, np.nan)
    limit = factor * file.outcome.factor * held.tolerance[at]
    # A logarithm has no place for a difference or a tolerance of nothing.
    difference = {
        "x": x,
        "y": numbers(factor * gap[at], 4),
        "name": "difference",
        "mode": "lines+markers",
        "marker": {"size": 4},
        "line": {"color": OURS, "width": 1},
    }
    tolerance = {
        "x": x,
        "y": numbers(np.where(limit > 0.0, limit, np.nan), 4),
        "name": "tolerance",
        "line": {"color": OTHER},
    }
    layout = {"xaxis": axis(plain(over)), "yaxis": axis(f"[{words}]", logarithmic=True)}
    words = f"{told}, difference: at most {row.share:.1e} of its tolerance"
    yield Panel(words, (tolerance, difference), layout)


SECTION = Section("file", "The file beside the car", 15, _blocks)
