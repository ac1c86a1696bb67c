"""The effects that the reference knows, by the names of their numbers."""

from __future__ import annotations

from collections.abc import Iterable

from validate.reference.effects import axle, wheel
from validate.reference.effects.effect import RACK, ROLL, TIME, TRAVEL, Effect
from validate.reference.errors import BadInputError

EFFECTS: dict[str, Effect] = {
    effect.name: effect for effect in (*wheel.OF_POSITIONS, *wheel.GRADIENTS, *wheel.OF_MOTION, *axle.NUMBERS)
}

ANGLES = ("camber", "kingpin", "toe", "caster")
"""Those that are computed where nobody says which."""

OF_POSITIONS = tuple(effect.name for effect in wheel.OF_POSITIONS)
"""Those of a wheel that positions tell."""


def named(names: Iterable[str]) -> dict[str, Effect]:
    """Effects by the names of numbers, with the prefix of a part or without.

    Raises:
        BadInputError: there is no such effect.
    """
    found = {}
    for name in names:
        effect = EFFECTS.get(name.rpartition(".")[2])
        if effect is None:
            others = ", ".join(one.name for one in (*wheel.OF_MOTION, *axle.NUMBERS))
            ways = f"each of these also with _{TRAVEL}, _{RACK}, _{ROLL} or _{TIME}; {others}"
            raise BadInputError("effect", name, f"one of {', '.join(OF_POSITIONS)}, {ways}")
        found[name] = effect
    return found
