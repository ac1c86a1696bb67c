"""The last values that inputs can reach: the folds at which the reference proves that a path cannot continue.

To find an end, the mechanism is redrawn at the values of the other inputs, to many digits. The reference then
drives the one input beyond the end that pointcoord finds.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cache

from pointcoord import Scene
from pointcoord.drawing_stands import End, reach_of
from validate.formulations.reference_solution import reference_instant
from validate.hard.cars import drawn_at
from validate.hard.subjects import Subject
from validate.reference import Design, InfeasibleError
from validate.reference.exact import as_fraction
from validate.reference.route import CLEAR, reached

NEAR = 1e-6  # largest error of pointcoord's end, as a share of the range
BEYOND = 1e-3  # how far beyond pointcoord's end the reference is driven, as a share of the range
Values = tuple[float, ...]


@dataclass(frozen=True)
class LastValue:
    """One end of an input, with the other inputs held.

    Attributes:
        value: the end, rad or mm; poses exist up to this value.
        reach: distance from this end to the opposite end, rad or mm.
        ahead: whether it is the upper end.
    """

    value: Fraction
    reach: float
    ahead: bool

    def beyond(self, share: float) -> float:
        """The value beyond this end by a share of the reach, rad or mm; before it for a negative share."""
        return float(self.value + (1 if self.ahead else -1) * Fraction(share) * Fraction(self.reach))


def last_value(
    subject: Subject, driven: str, ahead: bool, held: Mapping[str, float] | None = None
) -> LastValue:
    """The end of an input.

    Args:
        ahead: whether the upper end is wanted.
        held: values of all inputs within their ranges, from which this input is driven; `home` if not given.
    Raises:
        ValueError: the reference finds no end near pointcoord's end.
    """
    there = held or subject.home
    return _last_value(subject, driven, ahead, tuple(there[name] for name in subject.driven))


def ends_of(subject: Subject) -> tuple[tuple[str, bool], ...]:
    """The ends of a mechanism's inputs, with the others as drawn: the input, and whether it is the upper end.

    Inputs of the kind `turn` are left out: they have no end, or end where something else locks.
    """
    drawn = tuple(subject.drawn[name] for name in subject.driven)
    return tuple(
        (name, bool(ahead))
        for name in subject.driven
        if not subject.is_a("turn", name)
        for ahead, end in enumerate(_seen(subject, name, drawn))
        if end.limits
    )


@cache
def _last_value(subject: Subject, driven: str, ahead: bool, values: Values) -> LastValue:
    held = dict(zip(subject.driven, values, strict=True))
    low, high = _seen(subject, driven, values)
    reach, seen = high.value - low.value, Fraction((low, high)[ahead].value)
    # Redrawn at the pose of the held inputs, to many digits, so that one input alone leads from there to its
    # end.
    plain = subject.plain
    if held != subject.drawn:
        pose = reference_instant(subject.scene, {name: (value, 0, 0) for name, value in held.items()})
        plain["points"] = {name: pose.position[name] for name in plain["points"]}
    design = Design.from_plain(plain)
    beyond = {**held, driven: seen + Fraction(BEYOND * (reach if ahead else -reach))}
    try:
        reached(design, CLEAR, design.driven({name: (value, 0, 0) for name, value in beyond.items()}))
    except InfeasibleError as fold:
        end = as_fraction(fold.inputs[driven], driven)
        if abs(end - seen) <= Fraction(NEAR * reach):
            return LastValue(end, reach, ahead)
    raise ValueError(f"{driven} of {subject.name!r} has no end near {float(seen)!r}")


@cache
def _seen(subject: Subject, driven: str, values: Values) -> tuple[End, End]:
    """Both ends of an input as pointcoord finds them, with the other inputs held at these values."""
    held = dict(zip(subject.driven, values, strict=True))
    there = subject.car if held == subject.drawn else drawn_at(subject.car, held)
    return reach_of(Scene.from_mapping(subject.absolute(held, there)), driven)
