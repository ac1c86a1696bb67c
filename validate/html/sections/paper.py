"""The paper: its figures and tables as its own equations give them, and what is wrong in it by how much."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from validate.html.plot import OTHER, OURS, Panel, Plots, Trace, curve, marks, panel
from validate.html.run import Run
from validate.html.section import Block, Paragraph, Section
from validate.output.report import paper_sentence, paper_tables, printed_parts
from validate.output.table import Table
from validate.paper.errata import ERRATA
from validate.paper.tables import WHY_NOT_EQUAL, Figure, PaperRow, figures

DASHES = ("solid", "dash")


def _blocks(run: Run) -> Iterator[Block]:
    record = run.record
    if record.paper:
        yield from _of_paper(record.paper)
    # What the formulas as printed get wrong.
    for part in printed_parts(record.examined, record.findings):
        # A table has its caption itself.
        if isinstance(part, Table):
            yield part
        elif not record.findings or not part.endswith("against the mended ones."):
            yield Paragraph(part)


def _of_paper(rows: Sequence[PaperRow]) -> Iterator[Block]:
    yield Plots(
        "Figures 5 to 8 of the paper: crosses as printed in its tables", tuple(map(_of_figure, figures()))
    )
    yield Paragraph(f"{WHY_NOT_EQUAL} {paper_sentence(rows)}")
    for table, number in zip(paper_tables(rows), (2, 3), strict=True):
        panels = tuple(_panels([row for row in rows if row.printed.table == number]))
        yield Plots(f"Table {number}: crosses as printed, rings as computed", panels)
        yield table
    lines = tuple(
        (str(number), one.where, one.wrong, one.measures or "changes no number")
        for number, one in enumerate(ERRATA, start=1)
    )
    caption = "What is wrong in the paper, and what it measures."
    yield Table(("no.", "where", "what", "measures"), lines, caption=caption)


def _of_figure(figure: Figure) -> Panel:
    return panel(figure.words, "time [s]", f"[{figure.unit}]", _traces(figure))


def _traces(figure: Figure) -> Iterator[Trace]:
    for (name, values), dash in zip(figure.curves.items(), DASHES, strict=False):
        yield curve(name, figure.times, values, OURS, dash=dash)
    if figure.printed is not None:
        yield marks("printed", *figure.printed, OTHER)


def _panels(rows: Sequence[PaperRow]) -> Iterator[Panel]:
    kinds = (
        ("wheel centre", "mm", [(row.printed.wheel_centre, row.wheel_centre) for row in rows]),
        ("omega", "rad/s", [(row.printed.omega, row.omega) for row in rows]),
        ("alpha", "rad/s^2", [(row.printed.alpha, row.alpha) for row in rows]),
    )
    times = [row.printed.time for row in rows]
    for words, unit, pairs in kinds:
        for i, component in enumerate("xyz"):
            printed, ours = np.array(pairs)[:, :, i].T
            crosses = marks("printed", times, printed, OTHER)
            rings = marks("computed", times, ours, OURS, "circle-open")
            yield panel(f"{words}, {component}, over time", "time [s]", f"[{unit}]", (crosses, rings))


SECTION = Section("paper", "The paper", 60, _blocks, folded=True)
