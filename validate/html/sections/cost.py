"""Accuracy against time: the error of each way to solve a scene over what a configuration takes."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from validate.cost.findings import (
    a_configuration,
    accuracy_rows,
    phases,
    quantities_of,
    scenes_of,
    unit_of,
    words_of,
)
from validate.cost.looks import Look, looks
from validate.cost.report import Report
from validate.cost.row import Row
from validate.cost.tables import full_tables
from validate.html.plot import Panel, Plots, axis, numbers, plain
from validate.html.run import Run
from validate.html.section import Block, Cell, Grid, Paragraph, Section

# An error of exactly nothing has no place on a logarithmic axis; it is drawn so far below the least one.
BELOW = 10.0
# Scenes whose curves are drawn, and full tables and their lines, at most: a page stays small.
SCENES, TABLES, LINES = 8, 60, 120
LINE = 1.5  # pixels, of a curve
KEY = (
    "A line is a way, a mark one of its settings; down is more accurate, left is quicker. Filled and with a "
    "star: one solve serves any instant; hollow: every instant is solved."
)


def _blocks(run: Run) -> Sequence[Block]:
    return [] if run.cost is None else list(_told(run.cost, run.head.kind == "cost"))


def _told(cost: Report, of_this_run: bool) -> Iterator[Block]:
    rows = tuple((Cell(what), Cell(words)) for what, words in cost.head())
    yield Grid("How it was measured.", ("what", "value"), rows)
    yield from (Paragraph(sentence) for sentence in cost.sentences)
    accuracy = accuracy_rows(cost.rows)
    ways = looks(row.way for row in accuracy if row.status == "measured")
    scenes = scenes_of(accuracy)
    if ways:
        yield Paragraph(KEY)
    for scene in scenes[:SCENES]:
        here = [row for row in accuracy if row.scene == scene and row.status == "measured"]
        panels = tuple(_panel(here, quantity, ways) for quantity in quantities_of(here))
        if panels:
            yield Plots(f"{scene}: error against time, a line for each way", panels)
    if len(scenes) > SCENES:
        yield Paragraph(f"Drawn are the first {SCENES} of {len(scenes)} scenes.")
    if of_this_run:
        for table in full_tables(cost.rows, cost.found)[:TABLES]:
            lines = tuple(tuple(Cell(text) for text in line) for line in table.rows[:LINES])
            yield Grid(table.title, tuple(table.head), lines)
    for row in cost.rows:
        if row.status == "failed":
            yield Paragraph(f"{row.scene}, {row.way} {row.setting}: failed: {row.reason}")


def _panel(here: Sequence[Row], quantity: str, ways: Mapping[str, Look]) -> Panel:
    errors = [row.errors[quantity].largest for row in here if quantity in row.errors]
    floor = min((error for error in errors if 0.0 < error < math.inf), default=1e-16) / BELOW
    traces = []
    for way, look in ways.items():
        mine = [row for row in here if row.way == way]
        points = list(_points(mine, quantity, floor))
        if points:
            traces.append(_trace(way, look, any(row.dense for row in mine), np.array(points)))
    layout = {
        "xaxis": axis("time a configuration [us]", logarithmic=True),
        "yaxis": axis(f"largest error [{plain(unit_of(quantity))}]", logarithmic=True),
    }
    nothing = ", exactly 0 at the lower edge" if 0.0 in errors else ""
    return Panel(f"{words_of(quantity)}: largest error over time{nothing}", tuple(traces), layout)


def _points(rows: Sequence[Row], quantity: str, floor: float) -> Iterator[tuple[float, float]]:
    """Time, us, and error of each setting."""
    for row in rows:
        error, time = row.errors.get(quantity), a_configuration(row, phases(quantity))
        if error is not None and time is not None and math.isfinite(error.largest):
            yield 1e6 * time.median, max(error.largest, floor)


def _trace(way: str, look: Look, dense: bool, points: Any) -> Mapping[str, Any]:
    """As in the pictures: filled markers and a star for a way whose one solve serves any instant."""
    dash = ",".join(f"{LINE * length:g}px" for length in look.dash)
    symbol = look.symbol if dense else f"{look.symbol}-open"
    # Thin symbols have no inside.
    edge = {"width": LINE, "color": look.colour}
    return {
        "x": numbers(points[:, 0], 4),
        "y": numbers(points[:, 1], 3),
        "name": plain(way) + ("*" if dense else ""),
        "mode": "lines+markers",
        "line": {"color": look.colour, "width": LINE, **({"dash": dash} if dash else {})},
        "marker": {"symbol": symbol, "color": look.colour, "size": 8, "line": edge},
    }


SECTION = Section("cost", "Accuracy against time", 80, _blocks)
