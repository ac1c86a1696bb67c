"""Printed numbers compared with computed ones: the paper with its errata, and other programs' tables."""

from __future__ import annotations

from collections.abc import Iterator

from validate.html.blocks import OTHER, OURS, Block, Panel, Paragraph, Plots, curve, marks, panel
from validate.html.run import Run
from validate.output.report import paper_sentence, paper_tables, printed_parts
from validate.output.table import Cell, Table
from validate.paper.errata import ERRATA
from validate.paper.tables import WHY_NOT_EQUAL, Figure, figures
from validate.published.tables import MODELS, Column, Published

DASHES = ("solid", "dash")


def paper(run: Run) -> Iterator[Block]:
    """The figures and tables of the paper, printed and computed, and its errata with their effects."""
    record = run.record
    if rows := record.paper:
        drawn = tuple(map(_figure, figures()))
        yield Plots("Figures 5 to 8 of the paper: crosses as printed in its tables", drawn)
        yield Paragraph(f"{WHY_NOT_EQUAL} {paper_sentence(rows)}")
        yield from paper_tables(rows)
        lines = tuple(
            (str(number), one.where, one.wrong, one.measures or "changes no number")
            for number, one in enumerate(ERRATA, start=1)
        )
        caption = "Errata of the paper, and how much each changes."
        yield Table(("no.", "where", "erratum", "change"), lines, caption=caption)
    for part in printed_parts(record.examined, record.findings):
        yield Paragraph(part) if isinstance(part, str) else part


def _figure(figure: Figure) -> Panel:
    curves = zip(figure.curves.items(), DASHES, strict=False)
    traces = [curve(name, figure.times, values, OURS, dash=dash) for (name, values), dash in curves]
    traces += [marks("printed", *figure.printed, OTHER)] if figure.printed else []
    return panel(figure.words, "time [s]", f"[{figure.unit}]", traces)


def published(run: Run) -> Iterator[Block]:
    """Other programs' tables: each number with the computed numbers below, and a verdict for each column."""
    for one in run.published:
        table, notes = one.table, one.outcomes[0].notes
        text = f"{table.title}, compared with the car of {table.scene}. "
        text += f"Source: {table.source}; licence: {table.licence}."
        text += f" Note: {'; '.join(notes)}." if notes else ""
        yield Paragraph(text + (f" Left out: {table.left_out}." if table.left_out else ""))
        head = (one.over, *(f"{column.name} [{column.unit}]" for column in one.columns))
        models = " and ".join(MODELS)
        caption = f"{table.title}: printed, and below it as computed by {models}; tolerance: printed digits"
        yield Table(head, tuple(_rows(one)), caption=caption)


def _rows(one: Published) -> Iterator[tuple[Cell, ...]]:
    """A row for each printed row; the last row has the verdicts."""
    for i, at in enumerate(one.at):
        yield Cell(f"{at:g}"), *(_numbers(column, i) for column in one.columns)
    yield Cell("verdict"), *(_verdict(column) for column in one.columns)


def _numbers(column: Column, row: int) -> Cell:
    # Rounding to 14 decimals turns rounding errors about zero into zero; adding 0.0 turns -0 into 0.
    printed, *ours = (round(values[row] / column.per, 14) + 0.0 for values in (column.printed, *column.ours))
    return Cell(f"{printed:.9g}", ", ".join(f"{value:.9g}" for value in ours))


def _verdict(column: Column) -> Cell:
    share = max(row.share for row in column.rows)
    words = f"at most {share:.2f} of the tolerance"
    return Cell(column.verdict, words, "" if column.open else column.verdict)
