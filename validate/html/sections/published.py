"""Tables that other programs printed, beside ours."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from validate.comparison.compare import Comparison
from validate.html.plot import Plots
from validate.html.run import Run
from validate.html.section import Block, Paragraph, Section
from validate.html.sections.file import panels_of
from validate.output.report import about, degrees_of
from validate.output.table import Cell, Table
from validate.published.tables import Published


def _blocks(run: Run) -> Sequence[Block]:
    return [block for one in run.published for block in _of_table(one, run.points)]


def _of_table(one: Published, points: int) -> Iterator[Block]:
    outcome = one.found.outcome
    told = f"{one.table.title}, beside the built-in scene {one.table.scene}. Source: {one.table.source}."
    notes = [note for note in (one.table.note, *outcome.notes) if note]
    yield Paragraph(told + (f" Note: {'; '.join(notes)}." if notes else ""))
    rows = [row for row in outcome.rows if row.verdict != "not given"]
    # Curves only: differences are below the printed digits.
    panels = tuple(panel for row in rows for panel in panels_of(one.found, row, points)[:1])
    yield Plots(f"{one.table.title}: crosses as printed, line as computed", panels)
    head = (one.found.over, *(f"{about(row.quantity, row.name)} [{degrees_of(row.unit)[1]}]" for row in rows))
    caption = f"{one.table.title}: printed, computed below it; compared to the printed digits"
    yield Table(head, _cells(one, rows), caption=caption)


def _cells(one: Published, rows: Sequence[Comparison]) -> tuple[tuple[Cell, ...], ...]:
    """A line for each printed one; the last says the verdicts."""
    solutions = one.found.outcome.solutions
    values = [
        [degrees_of(row.unit)[0] * side.numbers[row.quantity][row.name] for side in solutions] for row in rows
    ]
    lines = [
        (
            Cell(f"{time:g}"),
            # Nothing has no sign.
            *(Cell(f"{printed[i] + 0.0:g}", f"{round(ours[i], 6) + 0.0:.6f}") for printed, ours in values),
        )
        for i, time in enumerate(solutions[0].times)
    ]
    verdicts = (
        Cell(row.verdict, f"at most {row.share:.2f} of half its last digit", row.verdict) for row in rows
    )
    return (*lines, (Cell("verdict"), *verdicts))


SECTION = Section("published", "Other programs' tables", 90, _blocks, folded=True)
