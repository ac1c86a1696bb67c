"""A scene made from a value of a parameter, tried by formulations and held to the reference.

Every number that a formulation gives is compared: positions, velocities, accelerations, body rates and
wheel angles at every instant, each against the formulation's own bound or tolerance (see `tolerance`).
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from pointcoord import PointcoordError, Scene, SceneError
from pointcoord.method import MAP
from pointcoord.simulation import Task
from validate.adjudication.reference_solution import reference_solution
from validate.extras import MissingPackage
from validate.formulations.point_coordinates import PointCoordinates, started
from validate.formulations.protocol import Formulation, FormulationError, Solution
from validate.formulations.registry import formulation
from validate.hard.case import OURS, REFUSED, Answer, Case, Expected, Trial, described
from validate.hard.classify import judged_answer
from validate.reference import InfeasibleError, NoReferenceError

Facts = Mapping[str, float | str]


@dataclass(frozen=True)
class Tried:
    """A scene after its trial, for whatever else a case measures.

    Attributes:
        solutions: of the formulations that answered, by name.
        reference: at the scene's instants; None if there is none.
    """

    scene: Scene
    solutions: Mapping[str, Solution]
    reference: Solution | None


Measure = Callable[[Tried], Facts]

NOT_ASKED = NoReferenceError("not asked, as all refuse")

# Factorisations of one map: some 0.3 s. Plain motions take a tenth of it; near folds no number is enough.
MAP_EFFORT = 1000


def scene_case(
    *,
    name: str,
    group: str,
    why: str,
    parameter: str,
    values: Sequence[float],
    scene: Callable[[float], Mapping[str, Any]],
    expected: Mapping[str, Expected],
    behaviour: str = "",
    measure: Measure | None = None,
    also_answered: tuple[float, ...] = (),
    proven: bool = True,
    judged: Callable[[float, Trial], Trial] | None = None,
    given: bool = True,
) -> Case:
    """A case whose trial is one scene.

    Args:
        scene: the content of the scene at a value of the parameter; see `scene_content`.
        expected: by name of a formulation; these are tried.
        behaviour: what is expected, where that is more than `expected` says.
        measure: what else is measured on the solutions.
        also_answered: see `Case`.
        proven: see `try_scene`.
        judged: the trial at a value, with what else is asked of its answers.
        given: whether the scene can be given to another solver.
    """

    def examine(value: float) -> Trial:
        trial = try_scene(value, scene(value), tuple(expected), measure, proven)
        return trial if judged is None else judged(value, trial)

    return Case(
        name,
        group,
        why,
        parameter,
        tuple(values),
        expected,
        behaviour or described(expected),
        examine,
        content=scene if given else None,
        without_pose=given and all(one == REFUSED for one in expected.values()),
        also_answered=also_answered,
    )


def try_scene(
    value: float,
    content: Mapping[str, Any],
    formulations: Sequence[str],
    measure: Measure | None = None,
    proven: bool = True,
) -> Trial:
    """Solve a scene by each formulation and hold the answers to the reference.

    A scene that cannot be read is refused by all. Where the reference has no pose no answer is right. The
    drawings of hard cases are exact, so that the reference takes an unclear side from exact products.

    Args:
        proven: whether the reference is asked even if all refuse, when nothing is to be held to it.
    """
    try:
        scene = Scene.from_mapping(content)
    except SceneError as error:
        refused = tuple(Answer(name, "refused", _told(error)) for name in formulations)
        return Trial(value, refused, {"reference": "not asked"})
    start = _started(scene) if OURS in formulations else None
    tried = {name: solved(name, scene, start) for name in formulations}
    solutions = {name: one for name, one in tried.items() if isinstance(one, Solution)}
    reference = _reference(scene) if proven or solutions else NOT_ASKED
    answers = tuple(_held(scene, name, one, reference) for name, one in tried.items())
    said = _told(reference) if isinstance(reference, Exception) else "answers"
    facts: dict[str, float | str] = {"reference": said}
    if measure is not None:
        known = None if isinstance(reference, Exception) else reference
        facts |= measure(Tried(scene, solutions, known))
    unknown = isinstance(reference, Exception) and not isinstance(reference, InfeasibleError)

    def judge(name: str) -> Answer:
        return _held(scene, name, solved(name, scene, start), reference)

    return Trial(value, answers, facts, None if unknown else judge)


def _started(scene: Scene) -> Task | PointcoordError | None:
    """Where all methods of pointcoord start; None if that fails, so that each fails by itself."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            return started(scene)
    except Exception:
        return None


def solved(name: str, scene: Scene, start: Task | PointcoordError | None = None) -> Solution | Answer:
    """A formulation's solution, or its refusal as an answer.

    Args:
        start: of pointcoord, if it is at hand.

    Any other error is a defect of the formulation, and so is a warning: its answer is wrong, and the run
    goes on.

    Raises:
        MissingPackage: the formulation is not installed.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            one = _with_bounded_effort(formulation(name))
            return one.solve(scene, start) if isinstance(one, PointCoordinates) else one.solve(scene)
    except FormulationError as error:
        return Answer(name, "refused", _told(error.reason))
    except SceneError as error:
        return Answer(name, "refused", _told(error))
    except MissingPackage:
        raise
    except Exception as error:
        return Answer(name, "wrong", f"fails: {_told(error)}")


def _with_bounded_effort(one: Formulation) -> Formulation:
    """A map of hard cases is given up early: thousands of them have to be tried in little time."""
    if isinstance(one, PointCoordinates) and one.method is MAP:
        return replace(one, method=replace(MAP, map_effort=MAP_EFFORT))
    return one


def _reference(scene: Scene) -> Solution | Exception:
    """The reference, or why there is none."""
    try:
        return reference_solution(scene, exact_sides=True)
    except NoReferenceError as error:
        return error
    except (ValueError, ArithmeticError) as error:
        # Inputs that overflow have no exact value to solve for.
        return error


def _held(scene: Scene, name: str, one: Solution | Answer, reference: Solution | Exception) -> Answer:
    """What a formulation came to, held to the reference or to the proof that there is no pose."""
    if isinstance(one, Answer):
        return one
    if isinstance(reference, InfeasibleError):
        return Answer(name, "wrong", f"answers where there is no pose: {reference}")
    if isinstance(reference, Exception):
        return Answer(name, "unjudged", _told(reference))
    return _judged(scene, one, reference)


def _judged(scene: Scene, answer: Solution, reference: Solution) -> Answer:
    try:
        with np.errstate(all="ignore"):
            return judged_answer(scene, answer, reference)
    except (ValueError, ArithmeticError, np.linalg.LinAlgError) as error:
        return Answer(answer.formulation, "unjudged", f"cannot be compared: {_told(error)}")


def _told(error: Exception) -> str:
    """An error's name and its message on one line."""
    return f"{type(error).__name__}: {' '.join(str(error).split())}"
