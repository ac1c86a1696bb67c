"""The paper: its figures and tables as its own equations give them, and what is wrong in it by how much."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from validate.html.plot import OTHER, OURS, Panel, Plots, Trace, curve, marks, panel
from validate.html.run import Run
from validate.html.section import Block, Paragraph, Section
from validate.output.report import paper_sentence, paper_tables, printed_parts
from validate.output.table import Table
from validate.paper.errata import errata
from validate.paper.tables import WHY_NOT_EQUAL, Figure, PaperRow, figures

FIGURES = (
    "What the paper's Figures 5 to 8 show, computed from its hardpoints and its laws of the inputs; crosses "
    "are the rows of its printed tables, which print no angle."
)
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
    yield Paragraph(FIGURES)
    yield Plots("Figures 5 to 8 of the paper", tuple(map(_of_figure, figures())))
    yield Paragraph(f"{WHY_NOT_EQUAL} {paper_sentence(rows)}")
    yield from paper_tables(rows)
    lines = tuple((str(e.number), e.where, e.wrong, e.measures or "changes no number") for e in errata(rows))
    caption = "What is wrong in the paper, and what it measures."
    yield Table(("no.", "where", "what", "measures"), lines, caption=caption)


def _of_figure(figure: Figure) -> Panel:
    words = f"Figure {figure.number}: {figure.words}, over time"
    return panel(words, "time [s]", f"[{figure.unit}]", _traces(figure))


def _traces(figure: Figure) -> Iterator[Trace]:
    for (name, values), dash in zip(figure.curves.items(), DASHES, strict=False):
        yield curve(name, figure.times, values, OURS, dash=dash)
    if figure.printed is not None:
        at, values = figure.printed
        yield marks("printed", at, values, OTHER)


SECTION = Section("paper", "The paper", 60, _blocks, folded=True)
