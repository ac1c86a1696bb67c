"""Who is right when two models differ, or when only one of them answers: both are held to the reference."""

from __future__ import annotations

import numpy as np

from pointcoord import Scene
from validate.comparison.compare import compare_solutions
from validate.formulations.protocol import Solution
from validate.formulations.reference_solution import (
    design_of,
    inputs_at,
    reference_instant,
    reference_solution,
    told_by,
)
from validate.reference import InfeasibleError, NoReferenceError, instants_of

NO_OBSTACLE = "no obstacle found"
NONE_WRONG = "none wrong by its own tolerance"
DIGITS = 15  # of the reference where only whether there is a pose counts
BETWEEN = 24  # instants between the first and the last at which a pose is looked for


def judged(scene: Scene, *answers: Solution) -> str:
    """Which of some solutions the reference contradicts, or why that cannot be said."""
    try:
        reference = reference_solution(scene)
    except NoReferenceError as error:
        return _unproven(error)
    asked = told_by(reference, scene)
    wrong = [
        one.formulation
        for one in answers
        if compare_solutions(scene, one, reference, "judged", asked).disagreements
    ]
    return f"{' and '.join(wrong)} wrong" if wrong else NONE_WRONG


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

    The way from the drawing to the first instant is straight in the numbers that the reference's equations
    take of the inputs.
    """
    times = np.linspace(scene.time.start, scene.time.stop, BETWEEN + 2)
    instants = instants_of(design_of(scene), (inputs_at(scene, t) for t in times.tolist()), DIGITS)
    for where in ("on the way from the drawing to the start", *["between the instants"] * (len(times) - 1)):
        try:
            next(instants)
        except InfeasibleError:
            return f"no pose {where}"
        except NoReferenceError:
            return f"no provable pose {where}"
    return NO_OBSTACLE


def _unproven(error: NoReferenceError) -> str:
    return (
        "no such pose on the way from the drawing, proven"
        if isinstance(error, InfeasibleError)
        else f"not provable: {error.reason}"
    )
