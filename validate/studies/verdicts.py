"""Decides by the reference which model is right if two models differ, or if only one of them answers."""

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
DIGITS = 15  # digits of the reference if only the existence of a pose matters
BETWEEN = 24  # number of instants between the first and the last at which a pose is looked for


def judged(scene: Scene, *answers: Solution) -> str:
    """The solutions that the reference contradicts, in words, or why this is not known."""
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
    """Why a scene that all models refuse has no answer, as far as the reference can tell."""
    try:
        for time in scene.instants.tolist():
            reference_instant(scene, inputs_at(scene, time))
    except InfeasibleError:
        return "an instant has no pose"
    except NoReferenceError as error:
        return _unproven(error)
    return obstacle(scene)


def obstacle(scene: Scene) -> str:
    """Where between its drawing and its last instant a scene has no pose, so that a path cannot continue.

    The path from the drawing to the first instant is straight in the functions of the inputs that the
    reference's equations contain.
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
