"""Compares the paper's printed formulas with the corrected ones: which quantities are wrong, and why."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from validate.comparison.compare import Comparison, Outcome
from validate.paper.errata import erratum_of


@dataclass(frozen=True)
class Finding:
    """A quantity of a scene that the printed formulas get wrong, its worst row, and the erratum."""

    scene: str
    quantity: str
    worst: Comparison
    erratum: str


def findings(outcomes: Iterable[Outcome]) -> tuple[Finding, ...]:
    """The disagreements in comparisons with the printed formulas, one per scene and quantity."""
    result = []
    for outcome in outcomes:
        wrong: dict[str, Comparison] = {}
        for row in outcome.disagreements:
            if row.quantity not in wrong or row.difference > wrong[row.quantity].difference:
                wrong[row.quantity] = row
        result += [Finding(outcome.scene, q, row, erratum_of(q, wrong)) for q, row in wrong.items()]
    return tuple(result)
