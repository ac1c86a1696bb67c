r"""The roll centre in the front view: where the contact point's normal meets the car's middle plane.

As a point of the wheel's carrier the contact point c moves with v = W' + omega x (c - W) as the wheel
travels. The line through c at right angles to v meets the middle plane, which holds the origin of the user's
coordinates, (c . outboard) (v . outboard) / (v . up) above c.
"""

from __future__ import annotations

from validate.reference.effects.car import KNUCKLE, RADIUS, WHEEL, Car
from validate.reference.effects.effect import TRAVEL, Effect
from validate.reference.effects.knuckle import KnuckleMotion
from validate.reference.vectors import Scalar, dot, minus


def _roll_centre_height(car: Car) -> Scalar:
    """(c . outboard) (v . outboard) / (v . up), above c."""
    motion = KnuckleMotion.of(car)
    v, out = motion.of_contact, dot(minus(motion.contact, car.drawn.origin), car.outboard)
    return out * dot(v, car.outboard) / dot(v, car.up)


NUMBERS = (
    Effect(
        "roll_centre_height",
        "mm",
        "the roll centre is above the contact point",
        (WHEEL, RADIUS, KNUCKLE, TRAVEL),
        _roll_centre_height,
        TRAVEL,
    ),
)
