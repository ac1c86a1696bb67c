"""Hard cases: the results of each, and errors over the distance to the singular pose."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import cycle

from validate.html.blocks import Block, Panel, Paragraph, Plots, marks, panel, plain
from validate.html.hard_cases import Case
from validate.html.run import Run
from validate.output.table import Cell, Table
from validate.plain_text import gathered

WORDS = (
    "Every answer is compared with a proven reference of 60 digits. An answer must be right within "
    "its error bound, or refused with a reason. In the plots, crosses at the lower edge are refusals. "
    "Cases get harder towards the left."
)
# Colours of the formulations, in the order of the case.
COLOURS = ("#2f86c9", "#d9641c", "#2a9d78", "#b266b2", "#8c8c1f", "#7a7a7a", "#c04848")
SYMBOLS = {"refused": "x-thin-open", "right": "circle", "wrong": "diamond-open", "unjudged": "diamond-open"}
# Smallest number of values of a curve; largest number of cases drawn, those with unexpected answers first.
FEWEST, MOST = 3, 60


def hard(run: Run) -> Iterator[Block]:
    """Numbers of answers by formulation, errors of the cases, and their verdicts."""
    if (found := run.hard) is None:
        return
    # A run without times in its results has no start time.
    when = "" if found.started is None else f", {found.started}"
    yield Paragraph(f"Run by `{found.command_line}`{when}. {found.sentence}. {WORDS}")
    outcomes = dict.fromkeys(outcome for counts in found.counts.values() for outcome in counts)
    rows = tuple((n, *(str(counts.get(one, 0)) for one in outcomes)) for n, counts in found.counts.items())
    yield Table(("formulation", *outcomes), rows, caption="Answers by formulation.")
    cases = sorted(found.cases, key=lambda case: not case.unexpected)
    drawn = [case for case in cases if len({v for v, a in case.answers if a.error and v > 0.0}) >= FEWEST]
    if drawn:
        yield Plots("Error against distance", tuple(map(_panel, drawn[:MOST])))
    yield Table(("case", "why it is hard", "verdict"), tuple(map(_row, cases)), caption="Every case.")


def _panel(case: Case) -> Panel:
    """The errors of each formulation by outcome; an answer without one is drawn below the least error."""
    floor = min(a.error for _, a in case.answers if a.error) / 10.0
    colours = dict(zip(dict.fromkeys(a.formulation for _, a in case.answers), cycle(COLOURS)))
    points = gathered(
        ((a.formulation, a.outcome), (value, max(a.error or 0.0, floor)))
        for value, a in case.answers
        if value > 0.0
    )
    traces = []
    for (name, outcome), some in sorted(points.items(), key=lambda one: [*colours].index(one[0][0])):
        values, errors = zip(*some, strict=True)
        traces.append(marks(plain(f"{name}: {outcome}"), values, errors, colours[name], SYMBOLS[outcome]))
    words = f"{case.name}, over {case.parameter}"
    return panel(words, "distance", f"error [{plain(case.unit)}]", traces, logarithmic="xy")


def _row(case: Case) -> tuple[str | Cell, ...]:
    verdict, detail = "agrees", "as expected"
    if case.unexpected:
        wrong = (f"{u.formulation} is {u.outcome} at {u.value:g}: {u.reason}" for u in case.unexpected)
        verdict, detail = "disagrees", f"not as expected: {'; '.join(wrong)}"
    return Cell(case.name, case.group), case.why, Cell(verdict, detail, verdict)
