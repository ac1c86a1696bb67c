"""Hard cases: what came of each."""

from __future__ import annotations

from collections.abc import Iterator

from validate.html.hard_cases import Case
from validate.html.run import Run
from validate.html.section import Block, Paragraph, Section
from validate.output.table import Cell, Table

WORDS = (
    "Every answer is compared with a reference in 60 digits that is proven. It has to be right within "
    "its own error bound, or refused with a reason."
)


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
    yield Table(("case", "why it is hard", "verdict"), tuple(map(_row, cases)), caption="Every case.")


def _row(case: Case) -> tuple[str | Cell, ...]:
    verdict, told = "agrees", "as expected"
    if case.unexpected:
        wrong = (f"{u.formulation} is {u.outcome} at {u.value:g}: {u.reason}" for u in case.unexpected)
        verdict, told = "disagrees", f"not as expected: {'; '.join(wrong)}"
    return Cell(case.name, case.group), case.why, Cell(verdict, told, verdict)


SECTION = Section("hard", "Hard cases", 85, _blocks, folded=True)
