"""Hard cases: what came of each, and errors against the distance to what is singular."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import cycle

from validate.hard.answer import Answer
from validate.html.hard_cases import Case
from validate.html.plot import Panel, Plots, Trace, marks, panel, plain
from validate.html.run import Run
from validate.html.section import Block, Paragraph, Section
from validate.output.table import Cell, Table

WORDS = (
    "Every answer is compared with a reference in 60 digits that is proven. It has to be right within "
    "its own error bound, or refused with a reason. In the plots crosses at the lower edge are refused. "
    "Toward the left it gets harder."
)
# In the order in which a case names its formulations.
COLOURS = ("#2f86c9", "#d9641c", "#2a9d78", "#b266b2", "#8c8c1f", "#7a7a7a", "#c04848")
# Values of a curve, at least, and cases that are drawn, at most; where something is wrong they come first.
FEWEST, MOST = 3, 60


def _blocks(run: Run) -> Iterator[Block]:
    if (hard := run.hard) is None:
        return
    # A run whose results say nothing of times has not noted when it began.
    when = "" if hard.started is None else f", {hard.started}"
    yield Paragraph(f"Tried by `{hard.command_line}`{when}. {hard.sentence}. {WORDS}")
    outcomes = dict.fromkeys(outcome for found in hard.counts.values() for outcome in found)
    rows = tuple((name, *(str(found.get(o, 0)) for o in outcomes)) for name, found in hard.counts.items())
    yield Table(("formulation", *outcomes), rows, caption="Answers by formulation.")
    cases = sorted(hard.cases, key=lambda case: not case.unexpected)
    drawn = [case for case in cases if len({v for v, a in case.answers if a.error and v > 0.0}) >= FEWEST]
    if drawn:
        yield Plots("Error against distance", tuple(map(_panel, drawn[:MOST])))
    yield Table(("case", "why it is hard", "verdict"), tuple(map(_row, cases)), caption="Every case.")


def _panel(case: Case) -> Panel:
    """The errors of each formulation; what has no number stands below the least error."""
    floor = min(a.error for _, a in case.answers if a.error) / 10.0
    names = dict.fromkeys(answer.formulation for _, answer in case.answers)
    traces = (
        trace
        for name, colour in zip(names, cycle(COLOURS))
        for trace in _traces(
            [(v, a) for v, a in case.answers if a.formulation == name and v > 0.0], colour, floor
        )
    )
    words = f"{case.name}, over {case.parameter}"
    return panel(words, "distance", f"error [{plain(case.unit)}]", traces, logarithmic="xy")


def _traces(answers: Sequence[tuple[float, Answer]], colour: str, floor: float) -> Iterator[Trace]:
    for outcome in dict.fromkeys(answer.outcome for _, answer in answers):
        those = [(value, answer) for value, answer in answers if answer.outcome == outcome]
        name = plain(f"{those[0][1].formulation}: {outcome}")
        symbol = "x-thin-open" if outcome == "refused" else "circle" if outcome == "right" else "diamond-open"
        yield marks(
            name, [v for v, _ in those], [max(a.error or 0.0, floor) for _, a in those], colour, symbol
        )


def _row(case: Case) -> tuple[str | Cell, ...]:
    verdict, told = "agrees", "as expected"
    if case.unexpected:
        wrong = (f"{u.formulation} is {u.outcome} at {u.value:g}: {u.reason}" for u in case.unexpected)
        verdict, told = "disagrees", f"not as expected: {'; '.join(wrong)}"
    return Cell(case.name, case.group), case.why, Cell(verdict, told, verdict)


SECTION = Section("hard", "Hard cases", 85, _blocks, folded=True)
