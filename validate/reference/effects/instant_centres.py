r"""Where the wheel's carrier has its instant centres, seen from the front and from the side.

In the plane through the contact point c that a level direction h and `up` span, a carrier that turns with
omega and moves c with v moves its points as a plane figure. Of the point c + x h + z up

    v . h - z omega . a = 0,      v . up + x omega . a = 0,      a = h x up,

say that it rests in this plane. Where omega . a = 0 the centre is at infinity: the quotients are not finite.
"""

from __future__ import annotations

from validate.reference.effects.car import KNUCKLE, RADIUS, WHEEL, Car
from validate.reference.effects.effect import TRAVEL, Effect
from validate.reference.effects.knuckle import KnuckleMotion
from validate.reference.vectors import Scalar, Vector, cross, dot


def _front_view_swing_arm(car: Car) -> Scalar:
    """-x, h = outboard."""
    return -_aside(car, car.outboard)


def _front_view_centre_height(car: Car) -> Scalar:
    """z, h = outboard."""
    return _above(car, car.outboard)


def _side_view_swing_arm(car: Car) -> Scalar:
    """x, h = rearward."""
    return _aside(car, car.rearward)


def _side_view_centre_height(car: Car) -> Scalar:
    """z, h = rearward."""
    return _above(car, car.rearward)


def _aside(car: Car, h: Vector) -> Scalar:
    """x."""
    motion = KnuckleMotion.of(car)
    return -dot(motion.of_contact, car.up) / dot(motion.turning, cross(h, car.up))


def _above(car: Car, h: Vector) -> Scalar:
    """z."""
    motion = KnuckleMotion.of(car)
    return dot(motion.of_contact, h) / dot(motion.turning, cross(h, car.up))


_NEEDS = (WHEEL, RADIUS, KNUCKLE, TRAVEL)

NUMBERS = (
    Effect(
        "front_view_swing_arm",
        "mm",
        "the centre of the front view is inboard of the contact point",
        _NEEDS,
        _front_view_swing_arm,
        TRAVEL,
    ),
    Effect(
        "front_view_centre_height",
        "mm",
        "the centre of the front view is above the contact point",
        _NEEDS,
        _front_view_centre_height,
        TRAVEL,
    ),
    Effect(
        "side_view_swing_arm",
        "mm",
        "the centre of the side view is behind the contact point",
        _NEEDS,
        _side_view_swing_arm,
        TRAVEL,
    ),
    Effect(
        "side_view_centre_height",
        "mm",
        "the centre of the side view is above the contact point",
        _NEEDS,
        _side_view_centre_height,
        TRAVEL,
    ),
)
