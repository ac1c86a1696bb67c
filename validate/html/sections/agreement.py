"""Scenes by quantities: who agrees, and how much of a tolerance is used."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from validate.comparison.compare import Comparison, Outcome
from validate.html.run import FIRST, FURTHER, Run, Told
from validate.html.section import Block, Cell, Grid, Section
from validate.output.report import heading, when, worst_rows

CAPTION = (
    "For each quantity the verdict, and below it the number whose difference uses most of its tolerance: it "
    "agrees if that is 1 or less."
)
# A page stays small: no row of a scene that agrees below so many rows, and none of another one below so many.
MOST_THAT_AGREE, MOST = 1000, 1500


def _blocks(run: Run) -> Sequence[Block]:
    quantities = list(
        dict.fromkeys(
            _heading(row)
            for one in run.told
            for outcome in one.examined.outcomes
            for row in worst_rows(outcome)
        )
    )
    short = len(run.told) > FIRST + FURTHER
    rows: list[tuple[Cell, ...]] = []
    left_out: dict[str, int] = {}
    for one in run.told:
        if len(rows) >= (MOST_THAT_AGREE if one.verdict == "agrees" else MOST):
            left_out[one.verdict] = left_out.get(one.verdict, 0) + 1
        else:
            rows += list(_rows(one, quantities, short))
    if run.record is not None:
        words = f"not run: {run.record.stopped}"
        blank = (Cell("not tested", verdict="not tested"),) * len(quantities)
        rows += [
            (Cell(name), Cell("not tested", words, "not tested"), *blank)
            for name in run.record.not_run[:MOST]
        ]
    if not rows:
        return []
    caption = CAPTION
    if short:
        caption += " Of a further pair of formulations a row is shown where it does not agree."
    if left_out:
        more = ", ".join(f"{count} {verdict}" for verdict, count in left_out.items())
        caption += f" Not in this table: {more}; the data beside this page have them all."
    return [Grid(caption, ("scene", "verdict", *quantities), tuple(rows))]


def _heading(row: Comparison) -> str:
    return heading(row.quantity, row.name)


def _rows(one: Told, quantities: Sequence[str], short: bool) -> Iterator[tuple[Cell, ...]]:
    """A row for each pair that was compared; of a scene without one, why there is none."""
    name, complaint = one.examined.name, one.examined.complaint
    outcomes = one.examined.outcomes
    if not outcomes:
        verdict = one.verdict
        blank = (Cell("not tested", verdict="not tested"),) * len(quantities)
        why = f"{one.why_not}: {complaint}" if one.why_not else complaint
        yield Cell(name), Cell(verdict, why, verdict), *blank
        return
    for i, outcome in enumerate(outcomes):
        if short and i and outcome.passed:
            continue
        cells = {_heading(row): _cell(row, short) for row in worst_rows(outcome)}
        pair = " and ".join(solution.formulation for solution in outcome.solutions)
        verdict = _verdict(outcome)
        if complaint and verdict == "agrees":
            # One of the other formulations has no answer.
            verdict = one.verdict
        asked = (cells.get(quantity, Cell("not asked for")) for quantity in quantities)
        yield Cell(name, pair), Cell(verdict, complaint, verdict), *asked


def _verdict(outcome: Outcome) -> str:
    if outcome.passed:
        return "agrees"
    return "disagrees" if outcome.disagreements else "not tested"


def _cell(row: Comparison, short: bool) -> Cell:
    if row.verdict == "not given":
        return Cell(row.verdict, row.name, row.verdict)
    told = f"{row.share:.2g} of its tolerance"
    if not short or row.verdict != "agrees":
        # The heading says the quantity, or the whole name.
        of = "" if row.name == _heading(row) else f"{row.name}, "
        told += f": {of}{when(row, 4)}"
    return Cell(row.verdict, told, row.verdict)


SECTION = Section("agreement", "Agreement", 20, _blocks)
