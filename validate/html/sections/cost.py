"""Accuracy against time: the error of each way to solve a scene over what a pose takes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from validate.html.blocks import Block, Panel, Paragraph, Plots, Trace, marks, panel, plain
from validate.html.run import Run
from validate.output.table import Table

if TYPE_CHECKING:
    import pandas as pd

    from validate.cost.looks import Look

SCENES = 8  # whose curves are drawn, at most: a page stays small
LINE = 1.5  # pixels, of a curve


def cost(run: Run) -> Iterator[Block]:
    """What accuracy costs, in a sentence and one picture, then the rest."""
    if (found := run.cost) is None:
        return
    # Imported here: pandas takes half a second, and most pages tell of no cost.
    from validate.cost.findings import timed
    from validate.cost.looks import KEY, looks

    accuracy, said = timed(found.table), [*map(Paragraph, found.sentences)]
    ways, scenes = looks(accuracy.way), list(dict.fromkeys(accuracy.scene))
    pictures = []
    for scene in scenes[:SCENES]:
        here = accuracy[accuracy.scene == scene]
        panels = tuple(_panel(of, q, ways) for q, of in here.groupby("quantity", sort=False))
        pictures.append(Plots(f"{scene}: error against time, a line for each way", panels))
    yield from said[:1]
    for picture in pictures[:1]:
        yield Plots(picture.caption, (replace(picture.panels[0], rem=20.0),), at_once=True)
    if ways:
        yield Paragraph(KEY)
    yield Table(("what", "value"), tuple(found.head()), caption="How it was measured.", folded=True)
    yield from said[1:]
    yield from pictures
    if len(scenes) > SCENES:
        yield Paragraph(f"Drawn are the first {SCENES} of {len(scenes)} scenes.")
    for row in found.rows:
        if row.verdict == "failed":
            yield Paragraph(f"{row.scene}, {row.way} {row.setting}: failed: {row.reason}")
    if run.head.kind == "cost":
        yield from (replace(one, folded=True) for one in found.tables)


def _panel(here: pd.DataFrame, quantity: str, ways: Mapping[str, Look]) -> Panel:
    from validate.cost.findings import heights, unit_of, words_of

    drawn, nothing = heights(here.error)
    here = here.assign(error=drawn)
    traces = (_trace(way, ways[way], line) for way, line in here.groupby("way", sort=False))
    words = f"{words_of(quantity)}: largest error over time{nothing}"
    up = f"largest error [{plain(unit_of(quantity))}]"
    return panel(words, "time a pose [us]", up, traces, logarithmic="xy")


def _trace(way: str, look: Look, line: pd.DataFrame) -> Trace:
    """As in the pictures: filled markers and a star for a way whose one solve serves any instant."""
    dash, dense = ",".join(f"{LINE * length:g}px" for length in look.dash), bool(line.dense.any())
    name, symbol = (f"{plain(way)}*", look.symbol) if dense else (plain(way), f"{look.symbol}-open")
    trace = marks(name, 1e6 * line.time.to_numpy(), line.error.to_numpy(), look.colour, symbol, 8)
    # Thin symbols have no inside.
    trace["marker"]["line"] = {"width": LINE, "color": look.colour}
    drawn = {"color": look.colour, "width": LINE, **({"dash": dash} if dash else {})}
    return trace | {"mode": "lines+markers", "line": drawn}
