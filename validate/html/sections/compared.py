"""Sections on the scenes of a run: verdict, agreement by quantity, differences over time, and machine."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from validate.arrays import Array
from validate.ci.verdict import by_scene, complaints, disagreements, notes, standing, undecided, word
from validate.comparison.compare import Comparison, Outcome
from validate.comparison.examined import Examined
from validate.comparison.given import given_by_both
from validate.comparison.pair import Pair
from validate.exit_status import ExitStatus
from validate.html.blocks import Block, Panel, Paragraph, Plots, fewer, gaps, plain
from validate.html.run import POINTS, Run
from validate.output.report import (
    HEAD,
    about,
    pair_of,
    quantity_rows,
    used,
    when,
    worst_of,
    worst_rows,
)
from validate.output.table import Cell, Table
from validate.plain_text import shown

LINES = 150  # largest number of remarks on all scenes together: there may be hundreds of scenes
DRAWN = 60  # largest number of rows of the heat map
WORDS = (
    "Share of the tolerance used: the darker the green, the larger. Red: disagrees. Amber: not tested. "
    "Empty: not asked for"
)
INK = "#000"  # readable on each of the colours, in light and in dark mode
# Scale: -1 is not tested; 0 to 1 is the share of the tolerance; 2 disagrees.
AMBER, PALE, GREEN, RED = "#e0a92e", "#dff2ea", "#2a9d78", "#d9481c"
COLOURS = ((0.0, AMBER), (0.33, AMBER), (0.33, PALE), (0.67, GREEN), (0.67, RED), (1.0, RED))
FACTS = ("command_line", "program", "started", "exit_status", "verdict", "tolerance_factor", "machine")
"""Parts of the document of a run that say how a page was made."""
ROW, EDGE = 1.4, 8.0  # height of a row of the heat map, and of its labels and margins, rem


def verdict(run: Run) -> Iterator[Block]:
    """The verdict in a sentence, then the explanations, refusals, warnings and notes of the scenes."""
    # Measured times are neither right nor wrong.
    times = run.head.kind == "cost" and run.status is ExitStatus.AGREE
    status = f"Exit status {run.status.value}: {run.head.verdict(run.status)}"
    yield Paragraph(run.sentence, "measured" if times else word(run.status), status)
    # Remarks that affect the verdict come first; a remark on several scenes is printed once.
    lines = by_scene(run.record, disagreements, complaints, undecided, notes)
    yield from map(Paragraph, lines[:LINES])
    if len(lines) > LINES:
        yield Paragraph(f"{len(lines) - LINES} more remarks are in the data files of this page.")


def agreement(run: Run) -> Iterator[Block]:
    """The heat map and the table of scenes and quantities, with verdicts and shares of the tolerance."""
    # Scenes that do not agree come first, so that they are shown however many scenes there are.
    compared = sorted(run.record.examined, key=lambda one: one.status == 0)
    agrees = Cell("agrees", verdict="agrees")
    rows = sorted((row for one in compared for row in _rows(one)), key=lambda row: row[-1] == agrees)
    drawn = [one for one in compared if one.outcomes and not run.record.files][:DRAWN]
    if drawn:
        yield _heat_map(drawn)
    if rows:
        caption = "For each quantity: the verdict, and the number with the largest share of its tolerance."
        yield Table(("scene", "compared", *HEAD), tuple(rows), caption=caption, folded=bool(drawn))


def _rows(one: Examined) -> Iterator[tuple[str | Cell, ...]]:
    """A row for each quantity of each compared pair; for a scene that was not compared, the reason."""
    if why := ": ".join(complaints(one)):
        yield one.name, *("-" for _ in HEAD), Cell(standing(one)[0], why, standing(one)[0])
    for outcome in one.outcomes:
        yield from ((one.name, pair_of(outcome), *row) for row in quantity_rows(outcome))


def _heat_map(drawn: Sequence[Examined]) -> Block:
    """The heat map of shares by scene and quantity: the largest share of all pairs of formulations."""
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
    return Plots("Every scene and quantity", (Panel(WORDS, (trace,), layout, EDGE + ROW * len(drawn)),))


def _seen(row: Comparison) -> tuple[float, str, str]:
    """A cell of the heat map: its value on the colour scale, its text, and its hover text."""
    text = f"{about(row.quantity, row.name)}: {row.verdict}"
    if row.verdict == "not given":
        return -1.0, row.verdict, plain(text)
    words = plain(f"{text}, {used(row.share)} at {when(row, 4)}")
    if row.verdict == "agrees":
        return float(f"{row.share:.2g}"), f"{100.0 * row.share:.0f}%", words
    return (2.0 if row.verdict == "disagrees" else -1.0), row.verdict, words


def differences(run: Run) -> Iterator[Block]:
    """Differences over time with their tolerances."""
    blocks = []
    for one in run.by_verdict:
        for outcome in one.examined.outcomes:
            rows = worst_rows(outcome)
            panels = tuple(panel for row in rows for panel in _panels(outcome, row, one.scene.instants))
            if panels:
                blocks.append(Plots(f"{outcome.scene}: {pair_of(outcome)}", panels))
    if blocks:
        yield from map(Paragraph, run.not_drawn)
    yield from blocks


def _panels(outcome: Outcome, row: Comparison, instants: Array) -> Iterator[Panel]:
    """The differences of a row over time; nothing if one of the two formulations does not give the number."""
    times, one, two = given_by_both(*outcome.solutions, instants)
    pair = Pair(row.quantity, (one, two), outcome.factor)
    if row.name in pair.names:
        held = pair.held(row.name)
        # At each instant, the component that comes closest to its tolerance.
        worst = np.argmax(held.share, axis=1, keepdims=True)
        gap, allowed, share = (
            np.take_along_axis(of, worst, axis=1)[:, 0] for of in (held.gap, held.allowed, held.share)
        )
        at = fewer(share, POINTS)
        words = f"{about(row.quantity, row.name)}: {row.verdict}, at most {used(row.share)}"
        yield gaps(words, "time [s]", times[at], gap[at], allowed[at], row.unit)


def machine(run: Run) -> Iterator[Block]:
    """The command, versions, machine and settings of the run."""
    facts = {key: run.document[key] for key in FACTS if key in run.document}
    if run.head.kind == "cost":
        del facts["machine"]  # the page may be made elsewhere: the cost section has the one that measured
    rows = ((name.replace("_", " "), shown(value)) for name, value in _flat(facts))
    yield Table(("what", "value"), tuple(rows), caption="How this page was made.")


def _flat(data: Mapping[str, Any], place: str = "") -> Iterator[tuple[str, str]]:
    """Names and values of nested mappings, flattened."""
    for name, value in data.items():
        if isinstance(value, Mapping):
            yield from _flat(value, f"{name} ")
        else:
            yield place + name, "not installed or not set" if value is None else str(value)
