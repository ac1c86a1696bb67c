"""Refusals of scenes by formulations: the kind of reason, so that two refusals can be compared, and the data.

A refusal states the formulation, the error, the instant, the input, its value and its limit; data that the
error does not have are None.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from numbers import Integral
from typing import Any

from pointcoord import AssemblyError, Scene
from validate.errors import NoAnswer
from validate.formulations.protocol import reason_of

DRAWING = "drawing has no assembly"
HARDPOINTS = "hardpoints make no mechanism"
START = "start out of reach"
MOTION = "motion leaves its reach"
INPUT = "input out of range"

# Two models may find the same fault at different stages: a wrong drawing when it is checked or when it is
# assembled; the end of the reach before or after the first instant.
FAMILIES = ({DRAWING, HARDPOINTS}, {START, MOTION})

KINDS: Mapping[str, str] = {
    "SceneError": HARDPOINTS,
    "DescriptionError": HARDPOINTS,
    "InputOutOfRange": INPUT,
    "InputError": INPUT,
}
"""Kinds of reason by the name of the error's class: without Pinocchio, absolute cannot be imported."""


def why_refused(error: Exception) -> str:
    """The kind of reason of a refusal, or of the error inside it; the name of its class if it has no kind."""
    reason = reason_of(error)
    names = [one.__name__ for one in type(reason).__mro__]
    if isinstance(reason, AssemblyError):
        if not reason.reduce:  # no input has a change left: the drawing itself does not close
            return DRAWING
        return START if reason.partial is None else MOTION
    if isinstance(reason, NoAnswer) and reason.name:
        return HARDPOINTS if reason.value is None else INPUT
    if isinstance(reason, NoAnswer) or "PoseError" in names:
        # A pose that cannot be solved, at an instant or, without an instant, in the drawing.
        instant = getattr(reason, "instant", None)
        return DRAWING if instant is None else START if instant == 0 else MOTION
    return next((KINDS[name] for name in names if name in KINDS), type(reason).__name__)


def same_reason(first: str, second: str) -> bool:
    """Whether two kinds of reason are the same fault of a scene."""
    return first == second or any({first, second} <= family for family in FAMILIES)


@dataclass(frozen=True)
class Refusal:
    """Why a formulation refuses a scene.

    Attributes:
        formulation: name of the formulation.
        error: class of its error.
        reason: kind of reason.
        message: message of the error, on one line.
        instant: instant of the scene, s.
        input: the input, or the key of the scene, at fault.
        value: its required value, rad or mm.
        limit: the last value that could be reached, or what is allowed in words.
        inputs, reached: values of all inputs, required and reached.
        condition: condition number at the last pose that could be solved.
        links: the links that block each other there, the strongest first.
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


def refusal_of(formulation: str, error: Exception, scene: Scene) -> Refusal:
    """The data of a refusal, or of the error inside it, as far as the error has them."""
    reason = reason_of(error)

    def first(*attributes: str) -> Any:
        """The first of these attributes of the error that is not empty."""
        return next((found for name in attributes if (found := getattr(reason, name, None))), None)

    wanted = {str(name): float(value) for name, value in (first("wanted", "inputs") or {}).items()}
    reached = {str(name): float(value) for name, value in (first("reached") or {}).items()}
    shortfalls = {
        name: abs(value - reached[name]) / (abs(value) + abs(reached[name]))
        for name, value in wanted.items()
        if name in reached and value != reached[name]
    }
    # Of several inputs the one with the largest relative shortfall is at fault.
    name = str(first("reduce", "name", "key") or max(shortfalls, key=shortfalls.__getitem__, default=""))
    value, limit = getattr(reason, "value", None), getattr(reason, "allowed", None)
    if name in wanted:
        value, limit = wanted[name], reached.get(name)
    instant = getattr(reason, "instant", None)
    if isinstance(instant, Integral):  # some models give its number instead of its time
        instant = scene.instants[instant] if instant < len(scene.instants) else None
    return Refusal(
        formulation=formulation,
        error=type(reason).__name__,
        reason=why_refused(reason),
        message=" ".join(str(reason).split()),
        instant=_finite(instant),
        input=name or None,
        value=_plain(value),
        limit=_plain(limit),
        inputs=wanted or None,
        reached=reached or None,
        condition=_finite(getattr(reason, "condition", None)),
        links=tuple(map(str, first("limits", "links") or ())),
    )


def _plain(value: object) -> float | str | None:
    """A value that JSON can hold."""
    if value is None or isinstance(value, str):
        return value or None
    number = _finite(value)
    return str(value) if number is None else number


def _finite(value: object) -> float | None:
    return float(value) if isinstance(value, int | float) and math.isfinite(value) else None
