"""A scene made from a value of a parameter, solved by formulations and compared with the reference.

Every number that a formulation gives is compared: positions, velocities, accelerations, body rates and
wheel angles at every instant, each against the formulation's own bound or tolerance (see `tolerance`).
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from pointcoord import Scene, SceneError
from pointcoord.method import MAP as BY_MAP
from validate.extras import MissingPackage
from validate.formulations.point_coordinates import PointCoordinates
from validate.formulations.protocol import FormulationError, Solution
from validate.formulations.reference_solution import reference_solution
from validate.formulations.registry import formulation
from validate.hard.answer import Answer, judged_answer
from validate.reference import InfeasibleError, NoReferenceError

OURS = "pointcoord"
# Every case that pointcoord has to solve is tried by a map of the inputs too.
MAP = "pointcoord-map"
NOT_ASKED = NoReferenceError("not asked, as all refuse")
# Factorisations of one map: some 0.3 s. Plain motions take a tenth of it; near folds no number is enough.
MAP_EFFORT = 1000


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

    @property
    def wrong(self) -> tuple[Answer, ...]:
        """Wrong numbers, which their formulation gave as right."""
        return tuple(a for a in self.answers if a.outcome == "wrong")


def try_scene(value: float, content: Mapping[str, Any], formulations: Sequence[str]) -> Trial:
    """Solve a scene by each formulation and compare the answers with the reference.

    A scene that cannot be read is refused by all. Where the reference has no pose no answer is right. It is
    not asked if all refuse, when there is nothing to compare with it.
    """
    try:
        scene = Scene.from_mapping(content)
    except SceneError as error:
        refused = tuple(Answer(name, "refused", said(error)) for name in formulations)
        return Trial(value, refused, {"reference": "not asked"})
    came = {name: solved(name, scene) for name in formulations}
    asked = any(isinstance(one, Solution) for one in came.values())
    reference = asked_reference(scene) if asked else NOT_ASKED
    answers = tuple(compared(scene, *one, reference) for one in came.items())
    facts = {"reference": said(reference)} if asked and isinstance(reference, Exception) else {}
    return Trial(value, answers, facts, scene, came, reference)


def solved(name: str, scene: Scene) -> Solution | Exception:
    """A formulation's solution, or why there is none: a warning is an error, and the run goes on.

    Raises:
        MissingPackage: the formulation is not installed.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            one = formulation(name)
            if isinstance(one, PointCoordinates) and one.method is BY_MAP:
                # Given up early: thousands of hard cases have to be tried in little time.
                one = replace(one, method=replace(BY_MAP, map_effort=MAP_EFFORT))
            return one.solve(scene)
    except MissingPackage:
        raise
    except Exception as error:
        return error


def asked_reference(scene: Scene) -> Solution | Exception:
    """The reference, or why there is none.

    The drawings of hard cases are exact, so that it takes an unclear side from exact products.
    """
    try:
        return reference_solution(scene, exact_sides=True)
    except (NoReferenceError, ValueError, ArithmeticError) as error:
        # Inputs that overflow have no exact value to solve for.
        return error


def compared(scene: Scene, name: str, came: Solution | Exception, reference: Solution | Exception) -> Answer:
    """What a formulation came to, compared with the reference or with the proof that there is no pose.

    An error other than a refusal is a defect of the formulation, and its answer is wrong.
    """
    if isinstance(came, FormulationError):
        return Answer(name, "refused", said(came.reason))
    if isinstance(came, SceneError):
        return Answer(name, "refused", said(came))
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


def said(error: Exception) -> str:
    """An error's name and its message on one line."""
    return f"{type(error).__name__}: {' '.join(str(error).split())}"
