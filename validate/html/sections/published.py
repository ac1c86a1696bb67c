"""Tables that other programs printed, beside ours."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from validate.comparison.compare import Comparison
from validate.html.plot import OTHER, OURS, Panel, Plots, axis, numbers, plain
from validate.html.run import Run
from validate.html.section import Block, Paragraph, Section
from validate.output.report import about
from validate.output.table import Cell, Table
from validate.published.tables import Published

Array = NDArray[np.float64]


def _blocks(run: Run) -> Sequence[Block]:
    return [block for one in run.published for block in _of_table(one)]


def _of_table(one: Published) -> Iterator[Block]:
    outcome = one.found.outcome
    told = f"{one.table.title}, beside the built-in scene {one.table.scene}. Source: {one.table.source}."
    notes = [note for note in (one.table.note, *outcome.notes) if note]
    yield Paragraph(told + (f" Note: {'; '.join(notes)}." if notes else ""))
    rows = [row for row in outcome.rows if row.verdict != "not given"]
    yield Plots(
        f"{one.table.title}: crosses as printed, line as computed", tuple(_panel(one, r) for r in rows)
    )
    head = (one.found.over, *(f"{about(row.quantity, row.name)} [{_unit(row)}]" for row in rows))
    caption = f"{one.table.title}: printed, computed below it; compared to the printed digits"
    yield Table(head, _cells(one, rows), caption=caption)


def _values(one: Published, row: Comparison) -> tuple[Array, Array]:
    """Printed and computed, (N,); a vector's components follow each other."""
    sides = (solution.numbers[row.quantity][row.name] for solution in one.found.outcome.solutions)
    printed, computed = (np.degrees(side) if row.unit == "rad" else side for side in sides)
    return printed, computed


def _unit(row: Comparison) -> str:
    return "deg" if row.unit == "rad" else row.unit


def _panel(one: Published, row: Comparison) -> Panel:
    times = numbers(one.found.outcome.solutions[0].times, 6)
    printed, computed = (numbers(np.ravel(values), 6) for values in _values(one, row))
    traces: tuple[Mapping[str, Any], ...] = (
        {"x": times, "y": computed, "name": "computed", "mode": "lines", "line": {"color": OURS}},
        {
            "x": times,
            "y": printed,
            "name": "printed",
            "mode": "markers",
            "marker": {"symbol": "x", "color": OTHER, "size": 7},
        },
    )
    what = about(row.quantity, row.name)
    layout = {"xaxis": axis(plain(one.found.over)), "yaxis": axis(f"{what} [{_unit(row)}]")}
    return Panel(f"{what} over {one.found.over}: {row.verdict}", traces, layout)


def _cells(one: Published, rows: Sequence[Comparison]) -> tuple[tuple[Cell, ...], ...]:
    """A line for each printed one; the last says the verdicts."""
    times = one.found.outcome.solutions[0].times
    values = [_values(one, row) for row in rows]
    lines = [
        (
            Cell(f"{time:g}"),
            *(Cell(f"{printed[i] + 0.0:g}", _six(computed[i])) for printed, computed in values),
        )
        for i, time in enumerate(times)
    ]
    verdicts = (
        Cell(row.verdict, f"at most {row.share:.2f} of half its last digit", row.verdict) for row in rows
    )
    return (*lines, (Cell("verdict"), *verdicts))


def _six(value: float) -> str:
    # Nothing has no sign.
    return f"{round(value, 6) + 0.0:.6f}"


SECTION = Section("published", "Other programs' tables", 90, _blocks, folded=True)
