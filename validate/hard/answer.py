"""A solution compared with the reference, in one answer: right, noted or wrong, by how much and in what.

A formulation may say itself that some of its numbers have no meaning. Such a note covers the numbers that
are not finite in the quantity that it names, and nothing else: they are left out, and the rest is judged
once more.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene
from pointcoord.effects.registry import QUANTITIES
from validate.adjudication.reference_solution import told_by
from validate.comparison.compare import Comparison, compare_solutions
from validate.formulations.protocol import Solution

Array = NDArray[np.float64]
# right: every number lies within its bound of the reference. refused: a reason in place of numbers. noted:
# some numbers are out of their bounds, and the formulation itself says so. wrong: it does not say so.
# unjudged: the reference could not be proven, which is a failure of the catalogue unless the case allows it.
Outcome = Literal["right", "refused", "noted", "wrong", "unjudged"]


@dataclass(frozen=True)
class Answer:
    """What one formulation made of one value of a case's parameter.

    Attributes:
        formulation: its name.
        outcome: by the reference.
        reason: of a refusal; else which quantity came closest to its bound, or exceeded it the most.
        error: largest distance of a point from the reference, in the case's unit; None without numbers.
        bound: largest bound that the formulation gives for it, in the same unit.
        share: largest error of any quantity, rates and angles too, in parts of its bound.
        condition: largest condition number.
    """

    formulation: str
    outcome: Outcome
    reason: str = ""
    error: float | None = None
    bound: float | None = None
    share: float | None = None
    condition: float | None = None


def judged_answer(scene: Scene, answer: Solution, reference: Solution) -> Answer:
    """Compare all numbers of a solution with the reference, each by the bound that the solution gives."""
    rows = compare_solutions(scene, answer, reference, "hard", told_by(reference, scene)).rows
    outcome = _outcome(scene, answer, reference, rows)
    worst = max(rows, key=lambda row: np.inf if np.isnan(row.share) else row.share)
    bound = max(float(np.max(claim)) for claim in answer.accuracy.claims["position"].values())
    return Answer(
        formulation=answer.formulation,
        outcome=outcome,
        reason=_reason(worst, answer, outcome),
        error=_finite(_error(answer, reference)),
        bound=_finite(bound),
        share=_finite(worst.share),
        condition=_finite(float(np.max(answer.accuracy.condition))),
    )


def _outcome(scene: Scene, answer: Solution, reference: Solution, rows: tuple[Comparison, ...]) -> Outcome:
    if not _wrong(rows):
        return "right"
    mended = _without_noted(answer, reference)
    rest = compare_solutions(scene, mended, reference, "hard", told_by(reference, scene)).rows
    return "wrong" if _wrong(rest) else "noted"


def _wrong(rows: tuple[Comparison, ...]) -> bool:
    """Whether a number is further off than the solution claims, or not given at all.

    However much it claims: the reference tells what a partner with a wide tolerance could not.
    """
    return any(row.verdict in ("disagrees", "not given") for row in rows)


def _without_noted(answer: Solution, reference: Solution) -> Solution:
    """The answer with the reference in place of what is not finite and has a note."""
    return answer.with_numbers(
        {
            quantity: _mended(arrays, reference.numbers[quantity], QUANTITIES[quantity].words, answer.notes)
            for quantity, arrays in answer.numbers.items()
            if quantity in reference.numbers
        }
    )


def _mended(
    given: Mapping[str, Array], true: Mapping[str, Array], quantity: str, notes: tuple[str, ...]
) -> Mapping[str, Array]:
    if not any(note.startswith(f"{quantity} of") for note in notes):
        return given
    return {name: np.where(np.isfinite(array), array, true[name]) for name, array in given.items()}


def _error(answer: Solution, reference: Solution) -> float:
    """Largest component of the distance of any point from the reference, mm."""
    return max(
        float(np.max(np.abs(answer.position[name] - reference.position[name]))) for name in reference.position
    )


def _reason(worst: Comparison, answer: Solution, outcome: Outcome) -> str:
    where = f"{QUANTITIES[worst.quantity].words} of {worst.name}"
    if outcome == "right":
        return where
    if np.isfinite(worst.difference):
        off = f"is off by {worst.difference:.2g} {worst.unit}, {worst.share:.2g} of what is allowed,"
    else:
        off = "is not a number"
    said = f"; noted: {'; '.join(answer.notes)}" if outcome == "noted" else ""
    return f"{where} {off} at t = {worst.instant:.6g} s{said}"


def _finite(number: float) -> float | None:
    return number if np.isfinite(number) else None
