"""Who is right when two models differ, or when only one of them answers: both are held to the reference."""

from __future__ import annotations

import math

import numpy as np

from pointcoord import Scene
from validate.adjudication.reference_solution import (
    inputs_at,
    reference_instant,
    reference_solution,
    told_by,
)
from validate.cars.input_limits import Linkage
from validate.cars.scene_content import car_of
from validate.comparison.compare import compare_solutions
from validate.formulations.protocol import Solution
from validate.reference import InfeasibleError, NoReferenceError

NO_OBSTACLE = "no obstacle found"
NEITHER_WRONG = "neither wrong by its own tolerance"
BETWEEN = 24  # instants between the first and the last at which a pose is looked for


def judged(scene: Scene, one: Solution, two: Solution) -> str:
    """Which of two disagreeing solutions the reference contradicts, or why that cannot be said."""
    try:
        reference = reference_solution(scene)
    except NoReferenceError as error:
        return _unproven(error)
    wrong = [s.formulation for s in (one, two) if _is_wrong(scene, s, reference)]
    return f"{' and '.join(wrong)} wrong" if wrong else NEITHER_WRONG


def judged_alone(scene: Scene, answer: Solution) -> str:
    """Whether the positions of a solution that stands alone are those of the reference."""
    scene = scene.model_copy(update={"effects": ()})
    try:
        reference = reference_solution(scene)
    except NoReferenceError as error:
        return _unproven(error)
    return "answer wrong" if _is_wrong(scene, answer, reference) else "answer right"


def _is_wrong(scene: Scene, answer: Solution, reference: Solution) -> bool:
    asked = told_by(reference, scene)
    return bool(compare_solutions(scene, answer, reference, "judged", asked).disagreements)


def unanswered(scene: Scene) -> str:
    """Why a scene that nobody answers has no answer, as far as the reference can say."""
    try:
        for time in scene.instants.tolist():
            reference_instant(scene, inputs_at(scene, time))
    except InfeasibleError:
        return "an instant has no pose"
    except NoReferenceError as error:
        return _unproven(error)
    return obstacle(scene)


def obstacle(scene: Scene) -> str:
    """Where, between its drawing and its last instant, a scene has no pose: why a path cannot go on.

    The way from the drawing to the first instant is straight in the driven coordinates.
    """
    time = scene.time
    if (place := _first_without_pose(scene, _way_to_the_start(scene))) is not None:
        return f"{place} on the way from the drawing to the start"
    times = np.linspace(time.start, time.stop, BETWEEN + 2)
    if (place := _first_without_pose(scene, [inputs_at(scene, t) for t in times.tolist()])) is not None:
        return f"{place} between the instants"
    return NO_OBSTACLE


def _first_without_pose(scene: Scene, way: list[dict[str, tuple[float, ...]]]) -> str | None:
    for inputs in way:
        try:
            reference_instant(scene, inputs)
        except InfeasibleError:
            return "no pose"
        except NoReferenceError:
            return "no provable pose"
    return None


def _way_to_the_start(scene: Scene) -> list[dict[str, tuple[float, ...]]]:
    home, first = Linkage.of(car_of(scene)).home, inputs_at(scene, scene.time.start)
    rise, travel = math.cos(home["arm_angle"]), home["rack"]
    way: list[dict[str, tuple[float, ...]]] = []
    for share in np.linspace(0.0, 1.0, BETWEEN).tolist():
        height = rise + share * (math.cos(first["arm_angle"][0]) - rise)
        slid = travel + share * (first["rack"][0] - travel)
        way.append({"arm_angle": (math.acos(height), 0.0, 0.0), "rack": (slid, 0.0, 0.0)})
    return way


def _unproven(error: NoReferenceError) -> str:
    return (
        "no such pose, proven"
        if isinstance(error, InfeasibleError)
        else f"not provable: {type(error).__name__}"
    )
