"""Scenes by quantities: who agrees, and how much of a tolerance is used."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from validate.ci.verdict import complaints, standing
from validate.comparison.compare import Comparison
from validate.comparison.examined import Examined
from validate.html.plot import Panel, Plots, plain
from validate.html.run import Run
from validate.html.section import Block, Section
from validate.output.report import HEAD, about, pair_of, quantity_rows, used, when, worst_of
from validate.output.table import Cell, Table

MOST = 1000  # rows of the table: a page stays small
DRAWN = 60  # rows of the picture
WORDS = (
    "Share of the tolerance used: the darker the green, the more; red disagrees, amber is not tested, "
    "empty is not asked for"
)
INK = "#000"  # stands out of each of the colours, in light and in dark
# From -1, not tested, over 0 to 1, shares of the tolerance, to 2, beyond it.
AMBER, PALE, GREEN, RED = "#e0a92e", "#dff2ea", "#2a9d78", "#d9481c"
COLOURS = ((0.0, AMBER), (0.33, AMBER), (0.33, PALE), (0.67, GREEN), (0.67, RED), (1.0, RED))
ROW, EDGE = 1.4, 8.0  # rem, of a row of the picture and of what stands around it


def _blocks(run: Run) -> Sequence[Block]:
    # Where something is not as wanted it is seen however many scenes there are.
    compared = sorted(run.record.examined, key=lambda one: one.status == 0)
    rows = sorted((row for one in compared for row in _rows(one)), key=lambda row: _agrees(row[-1]))
    if not rows:
        return []
    drawn = [one for one in compared if one.outcomes and not run.record.files][:DRAWN]
    caption = "For each quantity the verdict, and the number that is closest to its tolerance."
    if len(rows) > MOST:
        caption += f" and {len(rows) - MOST} rows more: the data beside this page have them all."
    head = ("scene", "compared", *HEAD)
    table = Table(head, tuple(rows[:MOST]), caption=caption, folded=bool(drawn))
    return [*([_picture(drawn)] if drawn else ()), table]


def _rows(one: Examined) -> Iterator[tuple[str | Cell, ...]]:
    """A row for each quantity of each pair that was compared; of a scene without one, why there is none."""
    if why := ": ".join(complaints(one)):
        yield one.name, *("-" for _ in HEAD), Cell(standing(one)[0], why, standing(one)[0])
    for outcome in one.outcomes:
        yield from ((one.name, pair_of(outcome), *row) for row in quantity_rows(outcome))


def _agrees(cell: str | Cell) -> bool:
    return isinstance(cell, Cell) and cell.verdict == "agrees"


def _picture(drawn: Sequence[Examined]) -> Block:
    """A heat map; of several pairs of formulations the one that uses most."""
    cells = [worst_of(row for outcome in one.outcomes for row in outcome.rows) for one in drawn]
    quantities = list(dict.fromkeys(name for row in cells for name in row))
    seen = [[_seen(row[name]) if name in row else (None, "", "") for name in quantities] for row in cells]
    levels, texts, words = ([[one[i] for one in row] for row in seen] for i in range(3))
    trace = {
        "type": "heatmap",
        "x": [plain(name) for name in quantities],
        "y": [plain(one.name) for one in drawn],
        "z": levels,
        "text": texts,
        "customdata": words,
        "texttemplate": "%{text}",
        "hovertemplate": "%{y}<br>%{customdata}<extra></extra>",
        "colorscale": COLOURS,
        "zmin": -1.0,
        "zmax": 2.0,
        "showscale": False,
        "xgap": 1,
        "ygap": 1,
        "textfont": {"size": 9, "color": INK},
    }
    layout = {
        "xaxis": {"side": "top", "automargin": True, "showgrid": False},
        "yaxis": {"autorange": "reversed", "automargin": True, "showgrid": False},
        "showlegend": False,
    }
    return Plots("Every scene and quantity", (Panel(WORDS, (trace,), layout, EDGE + ROW * len(drawn)),), True)


def _seen(row: Comparison) -> tuple[float, str, str]:
    """The place of a cell among the colours, what stands in it, and what the pointer brings."""
    told = f"{about(row.quantity, row.name)}: {row.verdict}"
    if row.verdict == "not given":
        return -1.0, row.verdict, plain(told)
    words = plain(f"{told}, {used(row.share)} at {when(row, 4)}")
    if row.verdict == "agrees":
        return float(f"{row.share:.2g}"), f"{100.0 * row.share:.0f}%", words
    return (2.0 if row.verdict == "disagrees" else -1.0), row.verdict, words


SECTION = Section("agreement", "Agreement", 20, _blocks)
