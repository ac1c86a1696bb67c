"""A solution compared with the reference, in one answer: right or wrong, by how much and in what."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from pointcoord import Scene
from pointcoord.effects.registry import QUANTITIES
from validate.comparison.compare import compare_solutions
from validate.formulations.protocol import Solution
from validate.formulations.reference_solution import told_by

# right: every number lies within its bound of the reference. refused: a reason in place of numbers. wrong:
# some do not. unjudged: the reference could not be proven, a failure unless the case allows it.
Outcome = Literal["right", "refused", "wrong", "unjudged"]


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
    """Compare all numbers of a solution with the reference, each by the bound that the solution gives.

    However large that is: the reference tells what a partner with a wide tolerance could not.
    """
    rows = compare_solutions(scene, answer, reference, "hard", told_by(reference, scene)).rows
    worst = max(rows, key=lambda row: np.inf if np.isnan(row.share) else row.share)
    reason = f"{QUANTITIES[worst.quantity].words} of {worst.name}"
    outcome: Outcome = "right"
    if any(row.verdict in ("disagrees", "not given") for row in rows):
        outcome, off = "wrong", "is not a number"
        if np.isfinite(worst.difference):
            off = f"is off by {worst.difference:.2g} {worst.unit}, {worst.share:.2g} of what is allowed,"
        reason += f" {off} at t = {worst.instant:.6g} s"
    error = max(np.max(np.abs(answer.position[n] - place)) for n, place in reference.position.items())
    bound = max(np.max(claim) for claim in answer.accuracy.claims["position"].values())
    sizes = (error, bound, worst.share, np.max(answer.accuracy.condition))
    finite = (float(size) if np.isfinite(size) else None for size in sizes)
    return Answer(answer.formulation, outcome, reason, *finite)
