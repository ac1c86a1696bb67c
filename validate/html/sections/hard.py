"""Hard cases: the error against the distance to what is singular."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from validate.html.hard_cases import Case
from validate.html.plot import Panel, Plots, Trace, marks, panel, plain
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


def _blocks(run: Run) -> Iterator[Block]:
    if (hard := run.hard) is None:
        return
    # A run whose results say nothing of times has not noted when it began.
    when = "" if hard.started is None else f", {hard.started}"
    whose = "" if run.head.kind == "hard" else f"Tried by `{hard.command_line}`{when}. "
    yield Paragraph(f"{whose}{hard.sentence}. {WORDS}")
    outcomes = dict.fromkeys(outcome for found in hard.counts.values() for outcome in found)
    rows = tuple((name, *(str(found.get(o, 0)) for o in outcomes)) for name, found in hard.counts.items())
    yield Table(("formulation", *outcomes), rows, caption="Answers by formulation.")
    # Where something is not as expected it is shown whatever there is beside it.
    cases = sorted(filter(_is_drawn, hard.cases), key=lambda case: not case.unexpected)
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


def _is_drawn(case: Case) -> bool:
    """Whether there is a curve: errors at several distances."""
    return len({value for value, a in case.answers if a.error is not None and value > 0.0}) >= FEWEST


def _row(case: Case) -> tuple[str | Cell, ...]:
    verdict, told = "agrees", "as expected"
    if case.unexpected:
        wrong = (f"{u.formulation} is {u.outcome} at {u.value:g}: {u.reason}" for u in case.unexpected)
        verdict, told = "disagrees", f"not as expected: {'; '.join(wrong)}"
    return Cell(case.name, case.group), case.why, Cell(verdict, told, verdict), _answers(case)


def _answers(case: Case) -> str:
    counts = {name: Counter[str]() for name in case.formulations}
    for _, answer in case.answers:
        counts[answer.formulation][answer.outcome] += 1
    return "; ".join(
        f"{name}: {', '.join(f'{count} {outcome}' for outcome, count in found.items())}"
        for name, found in counts.items()
    )


def _panel(case: Case) -> Panel:
    # What is no error at all, and what is no number, is drawn below the least error.
    errors = [answer.error for _, answer in case.answers if answer.error]
    floor = min(errors, default=1e-16) / 10.0
    # Formulations refuse at the same places: each has a row of its own below what is right.
    refused = {a.formulation for _, a in case.answers if a.outcome == "refused"}
    refusing = (name for name in case.formulations if name in refused)
    step = (max(errors, default=1e-16) / floor) ** -ROW
    rows = {name: floor * step**k for k, name in enumerate(refusing, 1)}
    traces = (
        trace
        for i, name in enumerate(case.formulations)
        for trace in _traces(case, name, i, floor, rows.get(name, floor))
    )
    words = f"{case.name}, over {case.parameter}: {case.behaviour}"
    return panel(words, "distance", f"error [{plain(case.unit)}]", traces, logarithmic="xy")


def _traces(case: Case, name: str, i: int, floor: float, row: float) -> Iterator[Trace]:
    colour, symbol, told = COLOURS[i % len(COLOURS)], SYMBOLS[i % len(SYMBOLS)], plain(name)
    given = [
        (value, row if a.outcome == "refused" else max(a.error or 0.0, floor), a.outcome)
        for value, a in case.answers
        if a.formulation == name and value > 0.0
    ]

    def those(*outcomes: str) -> tuple[list[float], list[float]]:
        some = [(value, error) for value, error, outcome in given if outcome in outcomes]
        return [value for value, _ in some], [error for _, error in some]

    line = {"mode": "lines+markers", "line": {"color": colour, "width": 1}}
    every = (
        marks(told, *those("right"), colour, symbol, 6) | line,
        # How high a cross stands says nothing.
        marks(f"{told} refuses", *those("refused"), colour, "x-thin-open", 8) | {"hovertemplate": "at %{x}"},
        marks(f"{told}: no right answer", *those("noted", "wrong", "unjudged"), WRONG, f"{symbol}-open", 10),
    )
    return (trace for trace in every if trace["x"])


SECTION = Section("hard", "Hard cases", 85, _blocks, folded=True)
