"""Accuracy against time: the error of each solution method over its time for a pose."""

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

SCENES = 8  # largest number of scenes with curves, so that the page stays small
LINE = 1.5  # width of a curve, pixels


def cost(run: Run) -> Iterator[Block]:
    """Run time against accuracy: first a sentence and one picture, then all others."""
    if (found := run.cost) is None:
        return
    # Imported here: pandas takes half a second, and most pages have no cost section.
    from validate.cost.findings import timed
    from validate.cost.looks import KEY, looks

    accuracy, sentences = timed(found.table), [*map(Paragraph, found.sentences)]
    ways, scenes = looks(accuracy.way), list(dict.fromkeys(accuracy.scene))
    pictures = []
    for scene in scenes[:SCENES]:
        here = accuracy[accuracy.scene == scene]
        panels = tuple(_panel(of, q, ways) for q, of in here.groupby("quantity", sort=False))
        pictures.append(Plots(f"{scene}: error against time, a line for each method", panels))
    yield from sentences[:1]
    for picture in pictures[:1]:
        yield Plots(picture.caption, (replace(picture.panels[0], rem=20.0),))
    if ways:
        yield Paragraph(KEY)
    yield Table(("what", "value"), tuple(found.head()), caption="How it was measured.", folded=True)
    yield from sentences[1:]
    yield from pictures
    if len(scenes) > SCENES:
        yield Paragraph(f"The first {SCENES} of {len(scenes)} scenes are drawn.")
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
    """A curve in the style of the pictures: filled markers and a star if one solve serves any instant."""
    dash, dense = ",".join(f"{LINE * length:g}px" for length in look.dash), bool(line.dense.any())
    name, symbol = (f"{plain(way)}*", look.symbol) if dense else (plain(way), f"{look.symbol}-open")
    trace = marks(name, 1e6 * line.time.to_numpy(), line.error.to_numpy(), look.colour, symbol, 8)
    # Thin symbols have no fill colour, only a line.
    trace["marker"]["line"] = {"width": LINE, "color": look.colour}
    drawn = {"color": look.colour, "width": LINE, **({"dash": dash} if dash else {})}
    return trace | {"mode": "lines+markers", "line": drawn}
