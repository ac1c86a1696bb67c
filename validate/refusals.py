"""Classes of reasons for which a model refuses a scene, so that two refusals can be held together."""

from __future__ import annotations

from absolute import errors as absolute_errors
from pointcoord import AssemblyError, InputOutOfRange, SceneError
from validate.formulation import FormulationError

DRAWING = "drawing has no assembly"
HARDPOINTS = "hardpoints make no mechanism"
START = "start out of reach"
MOTION = "motion leaves its reach"
INPUT = "input out of range"

# Two models may notice the same thing at different places: a drawing while it is checked or while it is
# assembled, the end of the reach on the way to the first instant or after it.
FAMILIES = ({DRAWING, HARDPOINTS}, {START, MOTION})


def why_refused(error: FormulationError) -> str:
    """The class of a refusal; an error of no class is its own, by its type's name."""
    reason = error.reason
    if isinstance(reason, SceneError):
        return HARDPOINTS
    if isinstance(reason, InputOutOfRange):
        return INPUT
    if isinstance(reason, AssemblyError):
        if reason.problem.startswith("the drawing"):
            return DRAWING
        return MOTION if reason.partial is not None else START
    if isinstance(reason, absolute_errors.DescriptionError):
        return HARDPOINTS
    if isinstance(reason, absolute_errors.InputError):
        return INPUT
    if isinstance(reason, absolute_errors.PoseError):
        if reason.instant is None:
            return DRAWING
        return START if reason.instant == 0 else MOTION
    return type(reason).__name__


def same_reason(first: str, second: str) -> bool:
    """Whether two classes say the same thing about a scene."""
    return first == second or any({first, second} <= family for family in FAMILIES)
