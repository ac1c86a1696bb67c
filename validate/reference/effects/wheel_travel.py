"""How far the wheel has gone from where it is drawn: W is the wheel centre, c its contact point."""

from __future__ import annotations

from validate.reference.effects.car import RADIUS, WHEEL, Car, contact_of
from validate.reference.effects.effect import Effect
from validate.reference.vectors import Scalar, Vector, dot, minus


def _travel(car: Car) -> Scalar:
    """(W - drawn W) . up, before the turns of the chassis."""
    return dot(minus(car.on_chassis[WHEEL].end, car.drawn.lines[WHEEL].end), car.up)


def _contact_travel(car: Car) -> Scalar:
    """(c - drawn c) . up, before the turns of the chassis, c of the disc that hangs along its own up."""
    return dot(minus(contact_of(car.drawn, car.on_chassis[WHEEL]), _drawn_contact(car)), car.up)


def _half_track_change(car: Car) -> Scalar:
    """(c - drawn c) . outboard."""
    return dot(minus(car.contact, _drawn_contact(car)), car.outboard)


def _recession(car: Car) -> Scalar:
    """(c - drawn c) . rearward, rearward = -forward."""
    return -dot(minus(car.contact, _drawn_contact(car)), car.forward)


def _drawn_contact(car: Car) -> Vector:
    return contact_of(car.drawn, car.drawn.lines[WHEEL])


CONTACT_TRAVEL = Effect(
    "contact_travel", "mm", "the contact point has gone up", (WHEEL, RADIUS), _contact_travel
)
TRAVELLED = Effect("travel", "mm", "the wheel centre is above its drawn place", (WHEEL,), _travel)

NUMBERS = (
    TRAVELLED,
    CONTACT_TRAVEL,
    Effect("half_track_change", "mm", "the track is wider", (WHEEL, RADIUS), _half_track_change),
    Effect("recession", "mm", "the contact point has gone rearward", (WHEEL, RADIUS), _recession),
)
