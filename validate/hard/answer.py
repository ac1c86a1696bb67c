"""Solves a scene by several formulations, and compares each answer with the reference.

Every number of a formulation is compared: positions, velocities, accelerations, body rates and wheel angles
at every instant, each against the error bound that the formulation states (see `comparison.pair`).
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np

from pointcoord import MissingLibrary, Scene, SceneError
from pointcoord.effects.registry import QUANTITIES
from pointcoord.method import MAP as BY_MAP
from validate.comparison.compare import compare_solutions
from validate.formulations.point_coordinates import PointCoordinates
from validate.formulations.protocol import FormulationError, Solution, reason_of
from validate.formulations.reference_solution import reference_solution, told_by
from validate.formulations.registry import formulation
from validate.plain_text import named
from validate.reference import InfeasibleError, NoReferenceError

OURS = "pointcoord"
# Every case that pointcoord has to solve is also solved by a map of the inputs.
MAP = "pointcoord-map"
NOT_ASKED = NoReferenceError("the reference", "is not solved, because all refuse", "an answer to compare")
# Limit of factorisations of a map: some 0.3 s. Plain motions take a tenth; near a fold no limit would be
# enough.
MAP_EFFORT = 1000
# right: every number is within its bound of the reference. wrong: some number is not. refused: a reason
# instead of numbers. unjudged: the reference could not be proven, which is a failure unless the case allows
# it.
Outcome = Literal["right", "refused", "wrong", "unjudged"]


@dataclass(frozen=True)
class Answer:
    """The answer of one formulation at one value of a case's parameter.

    Attributes:
        formulation: name of the formulation.
        outcome: the judgement by the reference.
        reason: of a refusal; else the quantity with the largest error / bound.
        error: largest error of a point's position, in the case's unit; None without numbers.
        bound: largest error bound of a position that the formulation states, in the same unit.
        share: largest error / bound of any quantity, rates and angles included.
        condition: largest condition number.
    """

    formulation: str
    outcome: Outcome
    reason: str = ""
    error: float | None = None
    bound: float | None = None
    share: float | None = None
    condition: float | None = None


@dataclass(frozen=True)
class Trial:
    """The answers of all formulations of a case at one value of its parameter.

    Attributes:
        facts: further facts on the value, by name with unit.
        scene: the scene; None if it could not be read.
        came: by formulation, its solution, or the error.
        reference: the reference at the scene's instants, or the error.
    """

    value: float
    answers: tuple[Answer, ...]
    facts: Mapping[str, float | str] = field(default_factory=dict)
    scene: Scene | None = field(default=None, compare=False, repr=False)
    came: Mapping[str, Solution | Exception] = field(default_factory=dict, compare=False, repr=False)
    reference: Solution | Exception = field(default=NOT_ASKED, compare=False, repr=False)


def try_scene(value: float, content: Mapping[str, Any], formulations: Sequence[str]) -> Trial:
    """Solve a scene by each formulation and compare the answers with the reference.

    A scene that cannot be read counts as refused by all. If the reference proves that there is no pose, no
    answer is right. If all refuse, the reference is not solved. The drawings of hard cases are exact, so
    the reference decides an unclear side of the drawing by exact products.
    """
    try:
        scene = Scene.from_mapping(content)
    except SceneError as error:
        return Trial(value, tuple(Answer(name, "refused", named(error)) for name in formulations))
    came = {name: solved(name, scene) for name in formulations}
    reference: Solution | Exception = NOT_ASKED
    if any(isinstance(one, Solution) for one in came.values()):
        try:
            reference = reference_solution(scene, exact_sides=True)
        except NoReferenceError as error:
            reference = error
    answers = tuple(_compared(scene, *one, reference) for one in came.items())
    return Trial(value, answers, {}, scene, came, reference)


def solved(name: str, scene: Scene) -> Solution | Exception:
    """A formulation's solution, or its error. Python warnings count as errors; errors do not end the run.

    Raises:
        MissingLibrary: the formulation is not installed.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            one = formulation(name)
            if isinstance(one, PointCoordinates) and one.method is BY_MAP:
                # With limited effort: thousands of hard cases have to be solved in little time.
                one = replace(one, method=replace(BY_MAP, map_effort=MAP_EFFORT))
            return one.solve(scene)
    except MissingLibrary:
        raise
    except Exception as error:
        return error


def _compared(scene: Scene, name: str, came: Solution | Exception, reference: Solution | Exception) -> Answer:
    """A formulation's result, compared with the reference or with the proof that there is no pose.

    An error that is not a refusal is a defect of the formulation, and counts as a wrong answer.
    """
    if isinstance(came, FormulationError | SceneError):
        return Answer(name, "refused", named(reason_of(came)))
    if isinstance(came, Exception):
        return Answer(name, "wrong", f"fails: {named(came)}")
    if isinstance(reference, InfeasibleError):
        return Answer(name, "wrong", f"answers where there is no pose: {reference}")
    if isinstance(reference, Exception):
        return Answer(name, "unjudged", named(reference))
    with np.errstate(all="ignore"):
        return judged_answer(scene, came, reference)


def judged_answer(scene: Scene, answer: Solution, reference: Solution) -> Answer:
    """Compare all numbers of a solution with the reference, each by the error bound of the solution.

    The bound counts however large it is: the error of the reference is negligible, unlike another model's.
    """
    rows = compare_solutions(scene, answer, reference, "hard", told_by(reference, scene)).rows
    worst = max(rows, key=lambda row: np.inf if np.isnan(row.share) else row.share)
    outcome: Outcome = "right"
    reason = f"{QUANTITIES[worst.quantity].words} of {worst.name}"
    if any(row.verdict in ("disagrees", "not given") for row in rows):
        outcome, off = "wrong", "is not a number"
        if np.isfinite(worst.difference):
            off = f"has an error of {worst.difference:.2g} {worst.unit}, {worst.share:.2g} times its bound,"
        reason += f" {off} at t = {worst.instant:.6g} s"
    error = max(np.max(np.abs(answer.position[n] - place)) for n, place in reference.position.items())
    bound = max(np.max(claim) for claim in answer.accuracy.claims["position"].values())
    sizes = (error, bound, worst.share, np.max(answer.accuracy.condition))
    finite = (float(size) if np.isfinite(size) else None for size in sizes)
    return Answer(answer.formulation, outcome, reason, *finite)
