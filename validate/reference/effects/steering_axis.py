"""Where the steering axis A + t k passes the wheel.

c is the contact point, g the axis at its height; W is the wheel centre, w the axis at its height.
"""

from __future__ import annotations

from validate.reference.effects.car import RADIUS, STEERING, WHEEL, Car
from validate.reference.effects.effect import Effect
from validate.reference.vectors import Scalar, Vector, dot, length, minus, root, times


def _kingpin_offset(car: Car) -> Scalar:
    """(c - g) . outboard (ISO 8855, 7.2.6, along the car's y)."""
    return dot(_at_ground(car), car.outboard)


def _scrub_radius(car: Car) -> Scalar:
    """|c - g| (ISO 8855, 7.2.10)."""
    return length(_at_ground(car))


def _mechanical_trail(car: Car) -> Scalar:
    """(g - c) . x, x = (forward a . outboard - outboard a . forward) / h the tyre's own forward.

    a is the spin axis, and h the length of its level part (ISO 8855, 7.2.3).
    """
    offset, a = _at_ground(car), car.wheel.along
    out, ahead = dot(a, car.outboard), dot(a, car.forward)
    across = dot(offset, car.outboard) * ahead - dot(offset, car.forward) * out
    return across / root(out * out + ahead * ahead)


def _castor_offset(car: Car) -> Scalar:
    """(g - c) . forward."""
    return -dot(_at_ground(car), car.forward)


def _kingpin_offset_at_wheel(car: Car) -> Scalar:
    """(W - w) . outboard."""
    return dot(_from_axis(car, car.wheel.end), car.outboard)


def _hub_trail(car: Car) -> Scalar:
    """(w - W) . rearward = (W - w) . forward."""
    return dot(_from_axis(car, car.wheel.end), car.forward)


def _at_ground(car: Car) -> Vector:
    """c - g."""
    return _from_axis(car, car.contact)


def _from_axis(car: Car, point: Vector) -> Vector:
    """From the axis' point at the height of a point to it: P - A - k ((P - A) . up) / (k . up)."""
    off, k = minus(point, car.steering.start), car.steering.along
    return minus(off, times(k, dot(off, car.up) / dot(k, car.up)))


_LINES, _ALL = (WHEEL, STEERING), (WHEEL, STEERING, RADIUS)

NUMBERS = (
    Effect(
        "kingpin_offset",
        "mm",
        "the axis meets the ground inboard of the contact point",
        _ALL,
        _kingpin_offset,
    ),
    Effect("scrub_radius", "mm", "always", _ALL, _scrub_radius),
    Effect(
        "mechanical_trail",
        "mm",
        "the axis meets the ground ahead of the contact point, seen along the tyre",
        _ALL,
        _mechanical_trail,
    ),
    Effect(
        "castor_offset",
        "mm",
        "the axis meets the ground ahead of the contact point, seen along the car",
        _ALL,
        _castor_offset,
    ),
    Effect(
        "kingpin_offset_at_wheel",
        "mm",
        "the axis is inboard of the wheel centre",
        _LINES,
        _kingpin_offset_at_wheel,
    ),
    Effect("hub_trail", "mm", "the axis is behind the wheel centre", _LINES, _hub_trail),
)
