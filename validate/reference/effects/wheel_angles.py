"""Angles of the spin axis and of the steering axis, each projected on two directions of the car."""

from __future__ import annotations

from validate.reference.dual import angle
from validate.reference.effects.car import STEERING, WHEEL, Car
from validate.reference.effects.effect import Effect
from validate.reference.vectors import Scalar, dot


def _camber(car: Car) -> Scalar:
    """atan2(-w . up, w . outboard), eq. (17) of the paper: the lean of the spin axis w in the front view."""
    return angle(-dot(car.wheel.along, car.up), dot(car.wheel.along, car.outboard))


def _kingpin(car: Car) -> Scalar:
    """atan2(-a . outboard, a . up), eq. (16): the lean of the steering axis a in the front view."""
    return angle(-dot(car.steering.along, car.outboard), dot(car.steering.along, car.up))


def _toe(car: Car) -> Scalar:
    """atan2(w . forward, w . outboard): how far w points forward in the plan view (ISO 8855, 7.1.6)."""
    return angle(dot(car.wheel.along, car.forward), dot(car.wheel.along, car.outboard))


def _caster(car: Car) -> Scalar:
    """atan2(a . rearward, a . up), rearward = -forward: the lean of a in the side view."""
    return angle(-dot(car.steering.along, car.forward), dot(car.steering.along, car.up))


NUMBERS = (
    Effect("camber", "rad", "the wheel leans out at the top", (WHEEL,), _camber),
    Effect("kingpin", "rad", "the steering axis leans in at the top", (STEERING,), _kingpin),
    Effect("toe", "rad", "the front edge of the wheel is nearer the car's middle", (WHEEL,), _toe),
    Effect("caster", "rad", "the steering axis leans rearward at the top", (STEERING,), _caster),
)
