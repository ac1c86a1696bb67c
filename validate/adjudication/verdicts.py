"""Who is right when two models differ, or when only one of them answers: both are held to the reference."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from pointcoord import Scene
from validate.adjudication.true_solution import as_solution
from validate.comparison.compare import compare_solutions
from validate.formulations.input_rates import rates
from validate.formulations.protocol import Solution
from validate.reference import InfeasibleError, NoReferenceError, solve_reference
from validate.reference.instant import Instant

NO_OBSTACLE = "no obstacle found"
NEITHER_WRONG = "neither wrong by its own tolerance"
BETWEEN = 24  # instants between the first and the last at which a pose is looked for


def judged(scene: Scene, one: Solution, two: Solution) -> str:
    """Which of two disagreeing solutions the reference contradicts, or why that cannot be said."""
    try:
        reference = true_solution(scene)
    except NoReferenceError as error:
        return _unproven(error)
    scene = _without_missing_angles(scene, reference)
    wrong = [
        s.formulation for s in (one, two) if compare_solutions(scene, s, reference, "judged").disagreements
    ]
    return f"{' and '.join(wrong)} wrong" if wrong else NEITHER_WRONG


def judged_alone(scene: Scene, answer: Solution) -> str:
    """Whether the positions of a solution that stands alone are those of the reference."""
    scene = scene.model_copy(update={"effects": ()})
    try:
        reference = true_solution(scene)
    except NoReferenceError as error:
        return _unproven(error)
    wrong = compare_solutions(scene, answer, reference, "judged").disagreements
    return "answer wrong" if wrong else "answer right"


def unanswered(scene: Scene) -> str:
    """Why a scene that nobody answers has no answer, as far as the reference can say."""
    try:
        for time in scene.instants.tolist():
            true_instant(scene, inputs_at(scene, time))
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
            true_instant(scene, inputs)
        except InfeasibleError:
            return "no pose"
        except NoReferenceError:
            return "no provable pose"
    return None


def _way_to_the_start(scene: Scene) -> list[dict[str, tuple[float, ...]]]:
    points = {name: np.array(point) for name, point in scene.mechanism.points.items()}
    arm = points["lower_ball_joint"] - points["lower_arm_front"]
    slide = points["tie_rod_inner"] - points.get("rack_centre", points["tie_rod_inner"])
    rise = float(arm @ np.array(scene.mechanism.up)) / float(np.linalg.norm(arm))
    travel = -float(slide @ np.array(scene.mechanism.right))
    first = inputs_at(scene, scene.time.start)
    way: list[dict[str, tuple[float, ...]]] = []
    for share in np.linspace(0.0, 1.0, BETWEEN).tolist():
        height = rise + share * (np.cos(first["arm_angle"][0]) - rise)
        slid = travel + share * (first["rack"][0] - travel)
        angle = float(np.arccos(np.clip(height, -1.0, 1.0)))
        way.append({"arm_angle": (angle, 0.0, 0.0), "rack": (slid, 0.0, 0.0)})
    return way


def inputs_at(scene: Scene, time: float) -> dict[str, tuple[float, ...]]:
    """Every input's value, rate and acceleration at an instant."""
    return {name: tuple(rates(part, np.array([time]))[0].tolist()) for name, part in scene.inputs.items()}


def true_instant(scene: Scene, inputs: Mapping[str, tuple[float, ...]]) -> Instant:
    """The reference for given inputs.

    Raises:
        NoReferenceError: there is no pose, or none can be proven.
    """
    part = scene.mechanism
    return solve_reference(
        dict(part.points), inputs, up=part.up, right=part.right, side=part.side, closure=part.closure
    )


def true_solution(scene: Scene) -> Solution:
    """The reference at a scene's instants, rounded, in the form that `compare_solutions` takes.

    Raises:
        NoReferenceError: an instant has no pose, or none can be proven.
    """
    return as_solution(
        scene.instants, [true_instant(scene, inputs_at(scene, t)) for t in scene.instants.tolist()]
    )


def _without_missing_angles(scene: Scene, reference: Solution) -> Scene:
    if len(reference.wheel) == 2:
        return scene
    return scene.model_copy(update={"effects": tuple(e for e in scene.effects if e != "wheel_angles")})


def _unproven(error: NoReferenceError) -> str:
    return (
        "no such pose, proven"
        if isinstance(error, InfeasibleError)
        else f"not provable: {type(error).__name__}"
    )
