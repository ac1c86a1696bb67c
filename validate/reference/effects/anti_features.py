r"""What share of the load that braking or driving shifts between the axles the links carry past the springs.

A force F that brakes the car shifts F h / L from the rear wheels to the front ones: h is the height of the
centre of gravity above the ground at this pose, L the wheelbase. This axle's part of it, b F rearward, acts
on a point of the wheel's carrier that moves with v as the wheel travels, and so lifts the wheel as a force
b F (v . rearward) / (v . up) would. What that takes off the shifted load, of all of it, is

    b s (v . rearward) / (v . up) L / h,      s = -1 at the front and +1 at the rear.

A brake at the wheel holds it to the carrier: v is that of the contact point. A driving force is forward and
shifts load rearward, which is the same quotient; its torque comes from the chassis by a shaft, so that the
carrier feels a force at the wheel centre W alone: v = W'.
"""

from __future__ import annotations

from validate.reference.car_data import AXLE, BRAKE_SHARE, DRIVE_SHARE, HEIGHT, WHEELBASE
from validate.reference.dual import value_of
from validate.reference.effects.car import KNUCKLE, RADIUS, WHEEL, Car
from validate.reference.effects.effect import TRAVEL, Effect
from validate.reference.effects.knuckle import KnuckleMotion
from validate.reference.effects.wheel_travel import CONTACT_TRAVEL
from validate.reference.vectors import Scalar, Vector, dot


def _anti_brake(car: Car) -> Scalar:
    """100 b s (v . rearward) / (v . up) L / h, v of the contact point."""
    return _share(car, BRAKE_SHARE, KnuckleMotion.of(car).of_contact)


def _anti_drive(car: Car) -> Scalar:
    """100 d s (v . rearward) / (v . up) L / h, v of the wheel centre."""
    return _share(car, DRIVE_SHARE, KnuckleMotion.of(car).of_centre)


def _share(car: Car, share: str, v: Vector) -> Scalar:
    data = car.drawn.data
    height = data[HEIGHT] - value_of(CONTACT_TRAVEL.evaluate(car))
    lever = data[WHEELBASE] / height
    return 100 * data[share] * data[AXLE] * dot(v, car.rearward) / dot(v, car.up) * lever


_NEEDS = (WHEEL, RADIUS, KNUCKLE, TRAVEL, AXLE, WHEELBASE, HEIGHT)

NUMBERS = (
    Effect(
        "anti_brake",
        "%",
        "braking lets the car dive less at the front, or lift less at the rear",
        (*_NEEDS, BRAKE_SHARE),
        _anti_brake,
        TRAVEL,
    ),
    Effect(
        "anti_drive",
        "%",
        "driving lets the car lift less at the front, or squat less at the rear",
        (*_NEEDS, DRIVE_SHARE),
        _anti_drive,
        TRAVEL,
    ),
)
