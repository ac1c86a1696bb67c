"""Scenes by quantities: who agrees, and how close the closest number comes to its tolerance."""

from __future__ import annotations

from collections.abc import Sequence

from validate.comparison.compare import Comparison, Outcome
from validate.html.run import Run
from validate.html.section import Block, Cell, Grid, Section
from validate.output.report import about, heading, worst_rows

CAPTION = (
    "For each quantity the number that comes closest to its tolerance, or exceeds it the most: its largest "
    "difference as a share of what it is held to. It agrees up to 1."
)


def _blocks(run: Run) -> Sequence[Block]:
    outcomes = [outcome for one in run.told for outcome in one.examined.outcomes]
    quantities = list(dict.fromkeys(_heading(row) for outcome in outcomes for row in worst_rows(outcome)))
    rows = tuple(_row(outcome, quantities) for outcome in outcomes)
    return [Grid(CAPTION, ("scene", *quantities), rows)] if rows else []


def _heading(row: Comparison) -> str:
    return heading(row.quantity, row.name)


def _row(outcome: Outcome, quantities: Sequence[str]) -> tuple[Cell, ...]:
    cells = {_heading(row): _cell(row) for row in worst_rows(outcome)}
    pair = " and ".join(solution.formulation for solution in outcome.solutions)
    asked = (cells.get(quantity, Cell("not asked for")) for quantity in quantities)
    return (Cell(outcome.scene, pair), *asked)


def _cell(row: Comparison) -> Cell:
    if row.verdict == "not given":
        return Cell(row.verdict, row.name, row.verdict)
    told = f"{row.share:.1e} of its tolerance, {about(row.quantity, row.name)}, {row.instant:.4g} s"
    return Cell(row.verdict, told, row.verdict)


SECTION = Section("agreement", "Agreement", 20, _blocks)
