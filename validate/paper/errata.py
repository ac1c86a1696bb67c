"""The paper's printed formulas held against the mended ones: what they get wrong, and why."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from validate.comparison.compare import Comparison, Outcome

EQUATION_23 = (
    "eq. (23): rows 8-11 lack the factor 2 of a product's second derivative, and row 11 repeats points 7, 5"
)
QUOTIENT = "the printed quotient for omega is 0/0 when omega lies in the plane of points 5, 6, 7"

CAUSES = {
    "acceleration": EQUATION_23,
    "angular_velocity": QUOTIENT,
}


@dataclass(frozen=True)
class Finding:
    """A quantity of a scene that the printed formulas get wrong, its worst row and the erratum."""

    scene: str
    quantity: str
    worst: Comparison
    erratum: str


def findings(outcomes: Iterable[Outcome]) -> tuple[Finding, ...]:
    """What disagrees in comparisons with the printed formulas, a row per scene and quantity."""
    result = []
    for outcome in outcomes:
        wrong: dict[str, Comparison] = {}
        for row in outcome.disagreements:
            if row.quantity not in wrong or row.share > wrong[row.quantity].share:
                wrong[row.quantity] = row
        result += [Finding(outcome.scene, q, row, _cause(q, wrong)) for q, row in wrong.items()]
    return tuple(result)


def _cause(quantity: str, wrong: dict[str, Comparison]) -> str:
    """The erratum behind a wrong quantity; the knuckle's alpha inherits from what it is made of."""
    if quantity == "angular_acceleration":
        parts = [CAUSES[q] for q in ("acceleration", "angular_velocity") if q in wrong]
        return "; ".join(parts) or QUOTIENT.replace("omega", "alpha")
    return CAUSES.get(quantity, "no known erratum: look into it")
