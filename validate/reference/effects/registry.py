"""The effects that the reference knows, by the names of their numbers."""

from __future__ import annotations

from validate.reference.effects import axle, wheel
from validate.reference.effects.car import Effect

EFFECTS: dict[str, Effect] = {
    effect.name: effect for effect in (*wheel.OF_POSITIONS, *wheel.GRADIENTS, *wheel.OF_MOTION, *axle.NUMBERS)
}

ANGLES = ("camber", "kingpin", "toe", "caster")
"""The effects that are computed by default."""
