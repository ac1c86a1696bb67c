"""Shipped mechanism files with a drawing, as the plain descriptions that the reference takes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from mechanism_files import mechanism_file, plain

from validate.reference import Design, Instant, instants_of
from validate.reference.effects.registry import ANGLES
from validate.reference.route import CLEAR

DRIVEN = ("arm_angle", "rack", "heave")
Points = Mapping[str, Sequence[Any]]


def plain_mechanism(
    name: str, points: Points, driven: Sequence[str] = DRIVEN, **settings: Any
) -> dict[str, Any]:
    """A shipped file and a drawing, mm, flattened; settings are those of a scene's mechanism."""
    return plain(mechanism_file(name), {"points": points, **settings}, driven)


def design_of(points: Points, suspension: str = "macpherson", **settings: Any) -> Design:
    """The reference's own of a shipped suspension that arm angle, rack and heave drive."""
    return Design.from_plain(plain_mechanism(suspension, points, **settings))


def solve_car(
    points: Points,
    inputs: Mapping[str, Any],
    digits: int = 60,
    clearness: float = CLEAR,
    effects: Sequence[str] = ANGLES,
    **settings: Any,
) -> Instant:
    """The reference at one instant of it."""
    return next(instants_of(design_of(points, **settings), [inputs], digits, clearness, effects))
