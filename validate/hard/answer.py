"""A scene solved by formulations, each answer compared with the reference: right or wrong, by how much.

Every number that a formulation gives is compared: positions, velocities, accelerations, body rates and
wheel angles at every instant, each against the formulation's own bound or tolerance (see `tolerance`).
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
from validate.formulations.protocol import FormulationError, Solution
from validate.formulations.reference_solution import reference_solution, told_by
from validate.formulations.registry import formulation
from validate.reference import InfeasibleError, NoReferenceError

OURS = "pointcoord"
# Every case that pointcoord has to solve is tried by a map of the inputs too.
MAP = "pointcoord-map"
NOT_ASKED = NoReferenceError("the reference", "is not asked, as all refuse", "an answer to compare")
# Factorisations of one map: some 0.3 s. Plain motions take a tenth of it; near folds no number is enough.
MAP_EFFORT = 1000
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


@dataclass(frozen=True)
class Trial:
    """One value of a parameter, tried by every formulation of the case.

    Attributes:
        facts: what else is to be said of it, by name with its unit.
        scene: None where it could not be read.
        came: a formulation's solution, or why there is none, by name.
        reference: at the scene's instants, or why there is none.
    """

    value: float
    answers: tuple[Answer, ...]
    facts: Mapping[str, float | str] = field(default_factory=dict)
    scene: Scene | None = field(default=None, compare=False, repr=False)
    came: Mapping[str, Solution | Exception] = field(default_factory=dict, compare=False, repr=False)
    reference: Solution | Exception = field(default=NOT_ASKED, compare=False, repr=False)


def try_scene(value: float, content: Mapping[str, Any], formulations: Sequence[str]) -> Trial:
    """Solve a scene by each formulation and compare the answers with the reference.

    A scene that cannot be read is refused by all. Where the reference has no pose no answer is right. It is
    not asked if all refuse, when there is nothing to compare with it. The drawings of hard cases are exact,
    so that it takes an unclear side from exact products.
    """
    try:
        scene = Scene.from_mapping(content)
    except SceneError as error:
        refused = tuple(Answer(name, "refused", said(error)) for name in formulations)
        return Trial(value, refused, {"reference": "not asked"})
    came = {name: solved(name, scene) for name in formulations}
    reference: Solution | Exception = NOT_ASKED
    if any(isinstance(one, Solution) for one in came.values()):
        try:
            reference = reference_solution(scene, exact_sides=True)
        except (NoReferenceError, ValueError, ArithmeticError) as error:
            # Inputs that overflow have no exact value to solve for.
            reference = error
    answers = tuple(_compared(scene, *one, reference) for one in came.items())
    told = {"reference": said(reference)} if isinstance(reference, Exception) else {}
    return Trial(value, answers, {} if reference is NOT_ASKED else told, scene, came, reference)


def solved(name: str, scene: Scene) -> Solution | Exception:
    """A formulation's solution, or why there is none: a warning is an error, and the run goes on.

    Raises:
        MissingLibrary: the formulation is not installed.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            one = formulation(name)
            if isinstance(one, PointCoordinates) and one.method is BY_MAP:
                # Given up early: thousands of hard cases have to be tried in little time.
                one = replace(one, method=replace(BY_MAP, map_effort=MAP_EFFORT))
            return one.solve(scene)
    except MissingLibrary:
        raise
    except Exception as error:
        return error


def _compared(scene: Scene, name: str, came: Solution | Exception, reference: Solution | Exception) -> Answer:
    """What a formulation came to, compared with the reference or with the proof that there is no pose.

    An error other than a refusal is a defect of the formulation, and its answer is wrong.
    """
    if isinstance(came, FormulationError | SceneError):
        return Answer(name, "refused", said(came.reason if isinstance(came, FormulationError) else came))
    if isinstance(came, Exception):
        return Answer(name, "wrong", f"fails: {said(came)}")
    if isinstance(reference, InfeasibleError):
        return Answer(name, "wrong", f"answers where there is no pose: {reference}")
    if isinstance(reference, Exception):
        return Answer(name, "unjudged", said(reference))
    try:
        with np.errstate(all="ignore"):
            return judged_answer(scene, came, reference)
    except (ValueError, ArithmeticError, np.linalg.LinAlgError) as error:
        return Answer(name, "unjudged", f"cannot be compared: {said(error)}")


def judged_answer(scene: Scene, answer: Solution, reference: Solution) -> Answer:
    """Compare all numbers of a solution with the reference, each by the bound that the solution gives.

    However large that is: the reference tells what a partner with a wide tolerance could not.
    """
    rows = compare_solutions(scene, answer, reference, "hard", told_by(reference, scene)).rows
    worst = max(rows, key=lambda row: np.inf if np.isnan(row.share) else row.share)
    outcome: Outcome = "right"
    reason = f"{QUANTITIES[worst.quantity].words} of {worst.name}"
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


def said(error: Exception) -> str:
    """An error's name and its message on one line."""
    return f"{type(error).__name__}: {' '.join(str(error).split())}"
