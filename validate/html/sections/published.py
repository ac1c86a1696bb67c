"""Tables that other programs printed, beside ours."""

from __future__ import annotations

from collections.abc import Iterator

from validate.html.run import Run
from validate.html.section import Block, Paragraph, Section
from validate.output.table import Cell, Table
from validate.published.tables import MODELS, Column, Published


def _blocks(run: Run) -> Iterator[Block]:
    for one in run.published:
        yield from _of_table(one)


def _of_table(one: Published) -> Iterator[Block]:
    table, notes = one.table, one.outcomes[0].notes
    told = (
        f"{table.title}, beside the car of {table.scene}. Source: {table.source}; licence: {table.licence}."
    )
    told += f" Note: {'; '.join(notes)}." if notes else ""
    yield Paragraph(told + (f" Left out: {table.left_out}." if table.left_out else ""))
    head = (one.over, *(f"{column.name} [{column.unit}]" for column in one.columns))
    caption = f"{table.title}: printed, below it what {' and '.join(MODELS)} compute; held to printed digits"
    yield Table(head, tuple(_cells(one)), caption=caption)


def _cells(one: Published) -> Iterator[tuple[Cell, ...]]:
    """A line for each printed one; the last says the verdicts."""
    for i, at in enumerate(one.at):
        yield Cell(f"{at:g}"), *(_numbers(column, i) for column in one.columns)
    yield Cell("verdict"), *(_verdict(column) for column in one.columns)


def _numbers(column: Column, row: int) -> Cell:
    # Rounding of a nothing is none, and adding 0 turns -0 into 0.
    printed, *ours = (round(values[row] / column.per, 14) + 0.0 for values in (column.printed, *column.ours))
    return Cell(f"{printed:.9g}", ", ".join(f"{value:.9g}" for value in ours))


def _verdict(column: Column) -> Cell:
    share = max(row.share for row in column.rows)
    words = f"at most {share:.2f} of what is allowed"
    return Cell(column.verdict, words, "" if column.open else column.verdict)


SECTION = Section("published", "Other programs' tables", 90, _blocks, folded=True)
