"""`pointcoord validate --tables`: compares tables that other programs printed with both models."""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence

from validate.ci.record import Record
from validate.commands.comparing import comparing
from validate.comparison.examined import Examined
from validate.exit_status import ExitStatus
from validate.output.console import Console
from validate.output.report import with_unit
from validate.output.table import Cell, Part, Table
from validate.plain_text import counted_as
from validate.published.tables import MODELS, NOT_HELD, Column, Published, compare_published, tables


def run(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Compare every printed table."""
    record = Record([table.name for table in tables()])
    with comparing(options, console, record, "table") as compared:
        found = compare_published()
        for one in found:
            compared.add(Examined(one.table.name, one.table.title, one.outcomes, solved=MODELS))
            console.show((*_parts(one), ""))
        console.say(_sentence([column for one in found for column in one.columns]))
    return compared.journal.status


def _parts(one: Published) -> Iterator[Part]:
    """The comparison of a table's columns, its source and licence, notes, and columns left out."""
    table = one.table
    yield f"{table.title}: {counted_as(len(one.at), 'row')} over {one.over}"
    head = ("column", *MODELS, "allowed", "at", "verdict")
    yield Table(head, tuple(tuple(_cells(column)) for column in one.columns), indent=2)
    yield f"  source: {table.source}; licence: {table.licence}"
    yield from (f"  note: {note}" for note in one.outcomes[0].notes)
    if table.left_out:
        yield f"  left out: {table.left_out}"


def _cells(column: Column) -> Iterator[str | Cell]:
    """The largest difference of each model from a printed column, in the printed unit."""
    worst = max(column.rows, key=lambda row: row.share)
    yield column.name
    yield from (with_unit(row.difference / column.per, "", 2) for row in column.rows)
    yield with_unit(worst.tolerance / column.per, column.unit, 2)
    yield worst.place
    word = column.verdict.upper() if column.verdict == "disagrees" else column.verdict
    yield Cell(word, verdict=column.verdict)


def _sentence(columns: Sequence[Column]) -> str:
    held = [column for column in columns if not column.open]
    wrong = [f"{column.rows[0].first}, {column.name}" for column in held if column.verdict == "disagrees"]
    parts = [f"{len(held) - len(wrong)} of {counted_as(len(held), 'printed column')} agree to the last digit"]
    parts += [f"disagrees: {'; '.join(wrong)}"] if wrong else []
    parts.append(f"{NOT_HELD}: {len(columns) - len(held)}")
    return f"{'; '.join(parts)}."
