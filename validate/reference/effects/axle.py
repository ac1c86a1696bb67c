"""The numbers of an axle, from both wheels, defined in `pointcoord/effects/README.md`.

c is a contact point, v its velocity as a point of the wheel's carrier during the wheel's travel, d a steer
angle, positive to the left, L the wheelbase, t the track as drawn.
"""

from __future__ import annotations

import validate.reference.car_data as data
from validate.reference.effects.car import Car, Effect
from validate.reference.effects.wheel import MOVING, ON_GROUND, steer_angle, velocity_of_contact
from validate.reference.jet import angle, only_where, value_of
from validate.reference.vectors import Scalar, Vector, dot, each, minus, root


def _track(left: Car, right: Car) -> Scalar:
    """(c right - c left) . right."""
    return dot(minus(right.contact, left.contact), right.outboard)


def _roll_centre(left: Car, right: Car) -> tuple[Scalar, Scalar]:
    """Offset and height of the point P in the front view where (P - c) . v = 0 on both sides.

    The offset is measured from the origin along right, the height from the line through both c.
    """

    def seen(car: Car, vector: Vector) -> tuple[Scalar, Scalar]:
        return dot(vector, right.outboard), dot(vector, car.up)

    (y, z), (y2, z2) = (
        seen(car, minus(each(value_of, car.contact), car.drawn.origin)) for car in (left, right)
    )
    (vy, vz), (vy2, vz2) = (seen(car, velocity_of_contact(car)) for car in (left, right))
    one, two = y * vy + z * vz, y2 * vy2 + z2 * vz2
    across = vy * vz2 - vz * vy2
    offset, height = (one * vz2 - two * vz) / across, (two * vy - one * vy2) / across
    return offset, height - z - (offset - y) * (z2 - z) / (y2 - y)


def _by_side(left: Car, right: Car, to_left: Scalar, to_right: Scalar) -> Scalar:
    """One number if both wheels are steered to the left, another if to the right, otherwise NaN."""
    one, two = (value_of(steer_angle(car)) for car in (left, right))
    lefts, rights = (one > 0) & (two > 0), (one < 0) & (two < 0)
    return only_where(to_left * lefts + to_right * rights, lefts | rights)


def _cotangent(car: Car) -> Scalar:
    """cot d."""
    return dot(car.wheel.along, car.outboard) / (dot(car.wheel.along, car.forward) * car.side)


def _turning_radius(left: Car, right: Car) -> Scalar:
    """L |cot d left + cot d right| / 2."""
    twice = left.drawn.data[data.WHEELBASE] * (_cotangent(left) + _cotangent(right))
    # Beyond a right angle to the left the cotangent is negative.
    size = root(twice * twice) / 2
    return _by_side(left, right, size, size)


def _drawn_track(left: Car, right: Car) -> Scalar:
    return dot(minus(right.drawn.contact, left.drawn.contact), right.outboard)


def _ackermann(left: Car, right: Car) -> Scalar:
    """100 (d inner - d outer) / (arccot((R - t/2) / L) - arccot((R + t/2) / L)), R the turning radius.

    The angles are magnitudes; their difference is d left - d right, whichever wheel is the inner one.
    """
    wheelbase, radius = left.drawn.data[data.WHEELBASE], _turning_radius(left, right)
    half = _drawn_track(left, right) / 2

    def steered(at: Scalar) -> Scalar:
        return angle(at * 0 + wheelbase, at)

    return 100 * (steer_angle(left) - steer_angle(right)) / (steered(radius - half) - steered(radius + half))


def _ackermann_error(left: Car, right: Car) -> Scalar:
    """d outer - arccot(cot d inner + t / L), magnitudes: excess of the outer wheel's steer angle."""
    apart = _drawn_track(left, right) / left.drawn.data[data.WHEELBASE]

    def needed(inner: Scalar) -> Scalar:
        return angle(inner * 0 + 1, inner + apart)

    return _by_side(
        left,
        right,
        steer_angle(right) - needed(_cotangent(left)),
        -steer_angle(left) - needed(-_cotangent(right)),
    )


_MOVED = (data.PAIR, *MOVING)
_STEERED = (data.PAIR, *ON_GROUND, data.WHEELBASE)

NUMBERS = (
    Effect("track", "mm", (data.PAIR, *ON_GROUND), _track),
    Effect("axle_roll_centre_height", "mm", _MOVED, lambda *cars: _roll_centre(*cars)[1], data.TRAVEL),
    Effect("axle_roll_centre_offset", "mm", _MOVED, lambda *cars: _roll_centre(*cars)[0], data.TRAVEL),
    Effect("turning_radius", "mm", _STEERED, _turning_radius),
    Effect("ackermann", "%", _STEERED, _ackermann),
    Effect("ackermann_error", "rad", _STEERED, _ackermann_error),
)
