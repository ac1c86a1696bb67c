"""Why a formulation refuses a scene: the kind of reason, so that two refusals can be compared, and its data.

A refusal says which formulation refused, with which error, at which instant, for which input, its value and
its limit; what the error does not know is None.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from numbers import Integral

from pointcoord import AssemblyError, Scene
from validate.errors import NoAnswer
from validate.formulations.protocol import FormulationError

DRAWING = "drawing has no assembly"
HARDPOINTS = "hardpoints make no mechanism"
START = "start out of reach"
MOTION = "motion leaves its reach"
INPUT = "input out of range"

# Two models may notice the same thing at different places: a drawing while it is checked or while it is
# assembled, the end of the reach on the way to the first instant or after it.
FAMILIES = ({DRAWING, HARDPOINTS}, {START, MOTION})

KINDS: Mapping[str, str] = {
    "SceneError": HARDPOINTS,
    "DescriptionError": HARDPOINTS,
    "InputOutOfRange": INPUT,
    "InputError": INPUT,
}
"""Of errors by the names of their classes: without Pinocchio there is no module of absolute to ask."""


def why_refused(error: FormulationError) -> str:
    """The kind of reason of a refusal; the name of its error where that is of no kind."""
    return _class_of(error.reason)


def _class_of(reason: Exception) -> str:
    names = [one.__name__ for one in type(reason).__mro__]
    if isinstance(reason, AssemblyError):
        if reason.problem.startswith("the drawing"):
            return DRAWING
        return START if reason.partial is None else MOTION
    found = next((KINDS[name] for name in names if name in KINDS), "")
    if isinstance(reason, NoAnswer) and reason.name:
        return HARDPOINTS if reason.value is None else INPUT
    if isinstance(reason, NoAnswer) or "PoseError" in names:
        # What cannot be solved at an instant, or in the drawing.
        instant = getattr(reason, "instant", None)
        return DRAWING if instant is None else START if instant == 0 else MOTION
    return found or type(reason).__name__


def same_reason(first: str, second: str) -> bool:
    """Whether two kinds of reason say the same thing about a scene."""
    return first == second or any({first, second} <= family for family in FAMILIES)


@dataclass(frozen=True)
class Refusal:
    """Why a formulation does not answer for a scene.

    Attributes:
        formulation: its name.
        error: the class of its error. reason: the kind of reason.
        message: in its own words, on one line.
        instant: of the scene, s.
        input: which input, or which key of the scene, is at fault.
        value: what it was to be there, rad or mm.
        limit: the last value that could be reached, or what is allowed in words.
        inputs, reached: all inputs as wanted and as reached.
        condition: condition number at the last pose that could be solved.
        links: what holds each other there, the strongest first.
    """

    formulation: str
    error: str
    reason: str
    message: str
    instant: float | None = None
    input: str | None = None
    value: float | str | None = None
    limit: float | str | None = None
    inputs: Mapping[str, float] | None = None
    reached: Mapping[str, float] | None = None
    condition: float | None = None
    links: tuple[str, ...] = ()


def refusal_of(formulation: str, reason: Exception, scene: Scene) -> Refusal:
    """The data of a refusal, as far as the error has them."""
    wanted = _numbers(getattr(reason, "wanted", None) or getattr(reason, "inputs", None))
    reached = _numbers(getattr(reason, "reached", None))
    name = _at_fault(reason, wanted, reached)
    value, limit = getattr(reason, "value", None), getattr(reason, "allowed", None)
    if name in wanted:
        value, limit = wanted[name], reached.get(name)
    return Refusal(
        formulation=formulation,
        error=type(reason).__name__,
        reason=_class_of(reason),
        message=" ".join(str(reason).split()),
        instant=_instant(reason, scene),
        input=name or None,
        value=_told(value),
        limit=_told(limit),
        inputs=wanted or None,
        reached=reached or None,
        condition=_told_number(getattr(reason, "condition", None)),
        links=tuple(map(str, getattr(reason, "limits", None) or getattr(reason, "links", None) or ())),
    )


def _instant(reason: Exception, scene: Scene) -> float | None:
    """The time of a refusal; errors of the models in Pinocchio count the instants."""
    instant = getattr(reason, "instant", None)
    if isinstance(instant, Integral):
        times = scene.instants
        return float(times[int(instant)]) if instant < len(times) else None
    return _told_number(instant)


def _at_fault(reason: Exception, wanted: Mapping[str, float], reached: Mapping[str, float]) -> str:
    """The input or key at fault; of several inputs the one that lacks the largest part of its value."""
    named = getattr(reason, "reduce", "") or getattr(reason, "name", "") or getattr(reason, "key", "")
    if named:
        return str(named)
    lacks = {
        name: abs(value - reached[name]) / (abs(value) + abs(reached[name]))
        for name, value in wanted.items()
        if name in reached and value != reached[name]
    }
    return max(lacks, key=lambda name: lacks[name], default="")


def _numbers(values: object) -> dict[str, float]:
    if not isinstance(values, Mapping):
        return {}
    return {str(name): float(value) for name, value in values.items()}


def _told(value: object) -> float | str | None:
    if value is None or isinstance(value, str):
        return value or None
    number = _told_number(value)
    return str(value) if number is None else number


def _told_number(value: object) -> float | None:
    if isinstance(value, int | float) and not isinstance(value, bool):
        return float(value) if math.isfinite(value) else None
    return None
