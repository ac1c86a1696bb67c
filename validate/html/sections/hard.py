"""Hard cases: the error against the distance to what is singular."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from validate.html.hard_cases import Answer, Case, HardCases
from validate.html.plot import Panel, Plots, axis, numbers, plain
from validate.html.run import Run
from validate.html.section import Block, Paragraph, Section
from validate.output.table import Cell, Table

WORDS = (
    "Every answer is compared with a reference in 60 digits that is proven. It has to be right within "
    "its own error bound, or refused with a reason. Filled: right; crosses at the lower edge, a row "
    "for each formulation: refused; red rings: neither. Toward the left it gets harder."
)
# In the order in which a case names its formulations.
COLOURS = ("#2f86c9", "#d9641c", "#2a9d78", "#b266b2", "#8c8c1f", "#7a7a7a", "#c04848")
SYMBOLS = ("circle", "square", "diamond", "triangle-up", "pentagon", "star", "hexagon")
WRONG = "#d40000"
# Of the height of the errors, from one row of crosses to the next.
ROW = 0.09
# Values of a curve, at least: cases of a few kinds are told in the table.
FEWEST = 3
# Cases that are drawn, at most.
MOST = 120


def _blocks(run: Run) -> Sequence[Block]:
    return [] if run.hard is None else list(_told(run.hard, run.head.kind == "hard"))


def _told(hard: HardCases, of_this_run: bool) -> Iterator[Block]:
    # A run whose results say nothing of times has not noted when it began.
    when = "" if hard.document["started"] is None else f", {hard.document['started']}"
    whose = "" if of_this_run else f"Tried by `{hard.document['command_line']}`{when}. "
    yield Paragraph(f"{whose}{hard.sentence}. {WORDS}")
    yield _counted(hard)
    cases = [case for case in hard.cases if _is_drawn(case)]
    # Where something is not as expected it is shown whatever there is beside it.
    cases.sort(key=lambda case: not case.unexpected)
    chosen = {case.name for case in cases[:MOST]}
    for group in dict.fromkeys(case.group for case in hard.cases):
        drawn = [case for case in hard.cases if case.group == group and case.name in chosen]
        if drawn:
            wrong = any(case.unexpected for case in drawn)
            yield Plots(group, tuple(map(_panel, drawn)), at_once=wrong)
    if len(cases) > MOST:
        yield Paragraph(f"{len(cases) - MOST} more cases that go by decades are in the table and not drawn.")
    head = ("case", "why it is hard", "verdict", "answers")
    yield Table(head, tuple(map(_row, hard.cases)), caption="Every case.")


def _counted(hard: HardCases) -> Table:
    outcomes = list(dict.fromkeys(outcome for found in hard.counts.values() for outcome in found))
    rows = tuple(
        (name, *(str(found.get(outcome, 0)) for outcome in outcomes)) for name, found in hard.counts.items()
    )
    return Table(("formulation", *outcomes), rows, caption="Answers by formulation.")


def _is_drawn(case: Case) -> bool:
    """Whether there is a curve: errors at several distances."""
    return (
        len({answer.value for answer in case.answers if answer.error >= 0.0 and answer.value > 0.0}) >= FEWEST
    )


def _row(case: Case) -> tuple[str | Cell, ...]:
    wrong = "disagrees" if case.unexpected else "agrees"
    told = f"not as expected: {'; '.join(case.unexpected)}" if case.unexpected else "as expected"
    return Cell(case.name, case.group), case.why, Cell(wrong, told, wrong), _answers(case)


def _answers(case: Case) -> str:
    parts = []
    for name in case.formulations:
        given = [answer.outcome for answer in case.answers if answer.formulation == name]
        counts = ", ".join(f"{given.count(outcome)} {outcome}" for outcome in dict.fromkeys(given))
        parts.append(f"{name}: {counts}")
    return "; ".join(parts)


def _panel(case: Case) -> Panel:
    # What is no error at all, and what is no number, is drawn below the least error.
    errors = [answer.error for answer in case.answers if answer.error > 0.0 and np.isfinite(answer.error)]
    floor = min(errors, default=1e-16) / 10.0
    # Formulations refuse at the same places: each has a row of its own below what is right.
    refusing = [n for n in case.formulations if any(a.refused for a in case.answers if a.formulation == n)]
    step = (max(errors, default=1e-16) / floor) ** -ROW
    rows = {name: floor * step**k for k, name in enumerate(refusing, 1)}
    traces = tuple(
        trace
        for i, name in enumerate(case.formulations)
        for trace in _traces(case, name, i, floor, rows.get(name, floor))
    )
    title = f"error [{plain(case.unit)}]"
    layout = {
        "xaxis": axis("distance", logarithmic=True),
        "yaxis": axis(title, logarithmic=True),
    }
    return Panel(f"{case.name}, over {case.parameter}: {case.behaviour}", traces, layout)


def _traces(case: Case, name: str, i: int, floor: float, row: float) -> Iterator[Mapping[str, Any]]:
    given = [answer for answer in case.answers if answer.formulation == name and answer.value > 0.0]
    colour, symbol = COLOURS[i % len(COLOURS)], SYMBOLS[i % len(SYMBOLS)]
    told = plain(name)
    right = [answer for answer in given if answer.outcome == "right"]
    refused = [answer for answer in given if answer.refused]
    other = [answer for answer in given if answer.outcome != "right" and not answer.refused]
    marker = {"symbol": symbol, "color": colour, "size": 6}
    if right:
        line = {"color": colour, "width": 1}
        yield {**_at(right, floor), "name": told, "mode": "lines+markers", "marker": marker, "line": line}
    if refused:
        cross = {"symbol": "x-thin-open", "color": colour, "size": 8}
        below = {**_at(refused, floor), "y": [float(f"{row:.3g}")] * len(refused)}
        # How high a cross stands says nothing.
        words = {"name": f"{told} refuses", "hovertemplate": "at %{x}"}
        yield {**below, **words, "mode": "markers", "marker": cross}
    if other:
        ring = {"symbol": f"{symbol}-open", "color": WRONG, "size": 10}
        yield {**_at(other, floor), "name": f"{told}: no right answer", "mode": "markers", "marker": ring}


def _at(answers: Sequence[Answer], floor: float) -> Mapping[str, Any]:
    errors = np.array([answer.error for answer in answers])
    drawn = np.where(np.isfinite(errors) & (errors > floor), errors, floor)
    return {"x": numbers(np.array([answer.value for answer in answers]), 6), "y": numbers(drawn, 3)}


SECTION = Section("hard", "Hard cases", 85, _blocks, folded=True)
