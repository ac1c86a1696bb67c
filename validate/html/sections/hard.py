"""Hard cases: the results of each, and errors over the distance to the singular pose."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import cycle

from validate.html.blocks import Block, Panel, Paragraph, Plots, marks, panel, plain
from validate.html.hard_cases import Case, answers_of
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
    document, cases = found.document, found.cases
    when = f", {document['started']}" if document["started"] else ""
    yield Paragraph(f"Run by `{document['command_line']}`{when}. {found.sentence}. {WORDS}")
    counts = document["counts"]
    outcomes = dict.fromkeys(outcome for of_one in counts.values() for outcome in of_one)
    rows = tuple((n, *(str(of_one.get(one, 0)) for one in outcomes)) for n, of_one in counts.items())
    yield Table(("formulation", *outcomes), rows, caption="Answers by formulation.")
    drawn = [case for case in cases if len({value for value, error, *_ in _points(case) if error}) >= FEWEST]
    if drawn:
        yield Plots("Error against distance", tuple(map(_panel, drawn[:MOST])))
    yield Table(("case", "why it is hard", "verdict"), tuple(map(_row, cases)), caption="Every case.")


def _points(case: Case) -> list[tuple[float, float | None, str, str]]:
    """Value, error, formulation and outcome of each answer that has a place on a logarithmic axis."""
    keys = ("value", "error", "formulation", "outcome")
    return [tuple(answer[key] for key in keys) for answer in answers_of(case) if answer["value"] > 0.0]


def _panel(case: Case) -> Panel:
    """The errors of each formulation by outcome; an answer without one is drawn below the least error."""
    points = _points(case)
    floor = min(error for _, error, *_ in points if error) / 10.0
    curves = gathered(((who, came), (value, max(error or 0.0, floor))) for value, error, who, came in points)
    colours, traces = dict(zip(dict.fromkeys(who for who, _ in curves), cycle(COLOURS))), []
    for (who, came), some in curves.items():
        values, errors = zip(*some, strict=True)
        traces.append(marks(plain(f"{who}: {came}"), values, errors, colours[who], SYMBOLS[came]))
    words = f"{case['name']}, over {case['parameter']}"
    return panel(words, "distance", f"error [{plain(case['unit'])}]", traces, logarithmic="xy")


def _row(case: Case) -> tuple[str | Cell, ...]:
    verdict, detail = "agrees", "as expected"
    if case["unexpected"]:
        each = (
            "{formulation} is {outcome} at {value:g}: {reason}".format(**one) for one in case["unexpected"]
        )
        verdict, detail = "disagrees", f"not as expected: {'; '.join(each)}"
    return Cell(case["name"], case["group"]), case["why"], Cell(verdict, detail, verdict)
