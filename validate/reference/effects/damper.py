"""How long the damper is."""

from __future__ import annotations

from validate.reference.effects.car import DAMPER, Car
from validate.reference.effects.effect import Effect
from validate.reference.vectors import Scalar, length


def _damper_length(car: Car) -> Scalar:
    """The distance of its ends."""
    return length(car.damper.along)


NUMBERS = (Effect("damper_length", "mm", "always", (DAMPER,), _damper_length),)
