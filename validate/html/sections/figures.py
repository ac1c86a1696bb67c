"""The paper's figures as its own equations give them, with the points of its printed tables."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from validate.html.plot import OTHER, OURS, Panel, Plots, axis, numbers
from validate.html.run import Run
from validate.html.section import Block, Paragraph, Section
from validate.paper.figures import Figure, figures

WORDS = (
    "What the paper's Figures 5 to 8 show, computed from its hardpoints and its laws of the inputs; crosses "
    "are the rows of its printed tables, which print no angle."
)
DASHES = ("solid", "dash")


def _blocks(run: Run) -> Sequence[Block]:
    if not run.paper:
        return []
    return [Paragraph(WORDS), Plots("Figures 5 to 8 of the paper", tuple(map(_panel, figures())))]


def _panel(figure: Figure) -> Panel:
    layout = {"xaxis": axis("time [s]"), "yaxis": axis(f"[{figure.unit}]")}
    return Panel(f"Figure {figure.number}: {figure.words}, over time", tuple(_traces(figure)), layout)


def _traces(figure: Figure) -> Iterator[Mapping[str, Any]]:
    times = numbers(figure.times, 6)
    for (name, values), dash in zip(figure.curves.items(), DASHES, strict=False):
        line = {"color": OURS, "dash": dash}
        yield {"x": times, "y": numbers(values, 6), "name": name, "mode": "lines", "line": line}
    if figure.printed is not None:
        at, values = figure.printed
        marker = {"symbol": "x", "color": OTHER, "size": 7}
        shown = {"x": numbers(at, 6), "y": numbers(values, 6)}
        yield {**shown, "name": "printed", "mode": "markers", "marker": marker}


SECTION = Section("figures", "The paper's figures", 55, _blocks)
