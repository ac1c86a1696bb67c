"""A solution held to the truth, in one answer: right, noted or wrong, by how much and in what.

A formulation may say itself that some of its numbers have no meaning. Such a note covers the numbers that
are not finite in the quantity that it names, and nothing else: they are left out, and the rest is judged
once more.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, replace

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene
from validate.compare import Comparison, compare_solutions
from validate.formulation import Accuracy, Solution
from validate.hard.case import Answer, Outcome

Array = NDArray[np.float64]


# The truth is proven to 60 digits of the greatest number of its kind; ten are left for what "greatest" means.
DUST = 1e-50


def without_dust(truth: Solution) -> Solution:
    """The truth with zeros where it is zero up to its own proven error.

    Its numbers are the middles of intervals about 0 there, some 1e-170 large, and a rate that is exactly zero
    is held to exactly zero. Of an acceleration the parts that cancel count: speed squared over size.
    """
    corners = np.stack(list(truth.position.values()))
    size = float((corners.max(axis=0) - corners.min(axis=0)).max())
    fastest, hardest = _largest(truth.velocity), _largest(truth.acceleration)
    push = hardest + fastest * (fastest / size)
    return replace(
        truth,
        velocity=_swept(truth.velocity, fastest),
        acceleration=_swept(truth.acceleration, push),
        angular_velocity=_swept(truth.angular_velocity, fastest / size),
        angular_acceleration=_swept(truth.angular_acceleration, push / size),
    )


def _swept(vectors: Mapping[str, Array], scale: float) -> dict[str, Array]:
    return {name: np.where(np.abs(array) > DUST * scale, array, 0.0) for name, array in vectors.items()}


def _largest(vectors: Mapping[str, Array]) -> float:
    return max(float(np.abs(array).max()) for array in vectors.values())


def judged_answer(scene: Scene, answer: Solution, truth: Solution) -> Answer:
    """Hold all numbers of a solution to the truth, which knows the sensitivities that tolerances need."""
    rows = compare_solutions(scene, answer, truth, "hard").rows
    outcome = _outcome(scene, answer, truth, rows)
    worst = max(rows, key=lambda row: row.share if np.isfinite(row.share) else np.inf)
    accuracy = answer.accuracy
    bound = accuracy.pose_error * np.maximum(accuracy.carried_gain, 1.0) + accuracy.stored
    return Answer(
        formulation=answer.formulation,
        outcome=outcome,
        reason=_reason(worst, answer, outcome),
        error=_finite(_error(answer, truth)),
        bound=_finite(float(np.max(bound))),
        share=_finite(worst.share),
        condition=_finite(float(np.max(accuracy.condition))),
    )


def _outcome(scene: Scene, answer: Solution, truth: Solution, rows: tuple[Comparison, ...]) -> Outcome:
    if all(row.verdict == "agrees" for row in rows):
        return "right"
    if not _bounded(answer.accuracy) and _finite_throughout(answer):
        # Any number lies within an infinite bound: a formulation that gives one says that it knows nothing.
        return "noted"
    rest = compare_solutions(scene, _without_noted(answer, truth), truth, "hard").rows
    return "noted" if all(row.verdict == "agrees" for row in rest) else "wrong"


def _bounded(accuracy: Accuracy) -> bool:
    """Whether a solution says of every instant how accurate it is."""
    factors = (getattr(accuracy, field.name) for field in fields(accuracy))
    return all(bool(np.isfinite(factor).all()) for factor in factors)


def _finite_throughout(answer: Solution) -> bool:
    channels = (answer.position, answer.velocity, answer.acceleration, answer.angular_velocity)
    every = (*channels, answer.angular_acceleration, answer.wheel)
    return all(bool(np.isfinite(array).all()) for channel in every for array in channel.values())


def _without_noted(answer: Solution, truth: Solution) -> Solution:
    """The answer with the truth in place of what is not finite and has a note."""
    return replace(
        answer,
        angular_velocity=_mended(
            answer.angular_velocity, truth.angular_velocity, "angular velocity", answer.notes
        ),
        angular_acceleration=_mended(
            answer.angular_acceleration, truth.angular_acceleration, "angular acceleration", answer.notes
        ),
    )


def _mended(
    given: Mapping[str, Array], true: Mapping[str, Array], quantity: str, notes: tuple[str, ...]
) -> Mapping[str, Array]:
    if not any(note.startswith(f"{quantity} of") for note in notes):
        return given
    return {name: np.where(np.isfinite(array), array, true[name]) for name, array in given.items()}


def _error(answer: Solution, truth: Solution) -> float:
    """Largest component of the distance of any point from the truth, mm."""
    return max(float(np.max(np.abs(answer.position[name] - truth.position[name]))) for name in truth.position)


def _reason(worst: Comparison, answer: Solution, outcome: Outcome) -> str:
    where = f"{worst.quantity.replace('_', ' ')} of {worst.name}"
    if outcome == "right":
        return where
    if outcome == "noted" and not _bounded(answer.accuracy):
        return f"{where}: no finite bound is given"
    if np.isfinite(worst.difference):
        off = f"is off by {worst.difference:.2g} {worst.unit}, {worst.share:.2g} of what is allowed,"
    else:
        off = "is not a number"
    said = f"; noted: {'; '.join(answer.notes)}" if outcome == "noted" else ""
    return f"{where} {off} at t = {worst.instant:.6g} s{said}"


def _finite(number: float) -> float | None:
    return number if np.isfinite(number) else None
