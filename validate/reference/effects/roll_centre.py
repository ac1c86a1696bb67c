r"""The roll centre in the front view: where the contact point's normal meets the car's middle plane.

As a point of the wheel's carrier the contact point c moves with v = W' + omega x (c - W) as the wheel
travels. The line through c at right angles to v meets the middle plane, which holds the origin of the user's
coordinates, (c . outboard) (v . outboard) / (v . up) above c.
"""

from __future__ import annotations

from validate.reference.dual import slope_of, value_of
from validate.reference.effects.car import KNUCKLE, RADIUS, WHEEL, Car
from validate.reference.effects.effect import TRAVEL, Effect
from validate.reference.jet import Jet
from validate.reference.kinematics import body_rates
from validate.reference.vectors import Scalar, cross, dot, each, minus, plus


def _roll_centre_height(car: Car) -> Scalar:
    """(c . outboard) (v . outboard) / (v . up), above c."""
    assert car.knuckle is not None
    c, centre = each(value_of, car.contact), car.wheel.end
    turning, _ = body_rates(*(each(_moving, vector) for vector in car.knuckle))
    v = plus(each(slope_of, centre), cross(turning, minus(c, each(value_of, centre))))
    out = dot(minus(c, car.drawn.origin), car.outboard)
    return out * dot(v, car.outboard) / dot(v, car.up)


def _moving(number: Scalar) -> Jet:
    return Jet(value_of(number), slope_of(number))


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
