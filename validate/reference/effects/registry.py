"""The effects that the reference knows, by the names of their numbers."""

from __future__ import annotations

from collections.abc import Collection, Iterable

from validate.reference.effects import (
    anti_features,
    damper,
    instant_centres,
    roll_centre,
    steering_axis,
    wheel_angles,
    wheel_travel,
)
from validate.reference.effects.effect import RACK, TRAVEL, Effect
from validate.reference.effects.gradients import by_rack, by_travel
from validate.reference.errors import BadInputError

_OF_POSITIONS = (*wheel_angles.NUMBERS, *wheel_travel.NUMBERS, *steering_axis.NUMBERS, *damper.NUMBERS)
_OF_MOTION = (*roll_centre.NUMBERS, *instant_centres.NUMBERS, *anti_features.NUMBERS)

EFFECTS: dict[str, Effect] = {
    effect.name: effect
    for effect in (
        *_OF_POSITIONS,
        *(gradient(effect) for effect in _OF_POSITIONS for gradient in (by_travel, by_rack)),
        *_OF_MOTION,
    )
}

ANGLES = tuple(effect.name for effect in wheel_angles.NUMBERS)
"""Those that are computed where nobody says which."""

OF_POSITIONS = tuple(effect.name for effect in _OF_POSITIONS)
"""Those that positions tell; the others take a derivative of the pose."""


def named(names: Iterable[str]) -> dict[str, Effect]:
    """Effects by name.

    Raises:
        BadInputError: there is no such effect.
    """
    wanted = tuple(names)
    for name in wanted:
        if name not in EFFECTS:
            others = ", ".join(effect.name for effect in _OF_MOTION)
            ways = f"each of these also with _{TRAVEL} or _{RACK}; {others}"
            raise BadInputError("effect", name, f"one of {', '.join(OF_POSITIONS)}, {ways}")
    return {name: EFFECTS[name] for name in wanted}


def available(names: Iterable[str], has: Collection[str]) -> dict[str, Effect]:
    """Those of some effects that a car can have.

    Args:
        has: what it has, of `effect.NEEDS`.
    Raises:
        BadInputError: there is no such effect.
    """
    return {name: effect for name, effect in named(names).items() if not effect.lacks(has)}
