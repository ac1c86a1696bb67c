r"""The numbers of one wheel, defined in `pointcoord/effects/README.md`.

a is the wheel's spin axis, k the steering axis, W the wheel centre, c the contact point. Where the car's
numbers are duals, ' is the derivative by their input. The wheel's carrier turns with omega and moves its own
point at p with W' + omega x (p - W); v is that of c.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from validate.reference.car_data import (
    AXLE,
    BRAKE_SHARE,
    DRIVE_SHARE,
    FREE_LENGTH,
    HEIGHT,
    SPRING_RATE,
    WHEELBASE,
)
from validate.reference.dual import angle, slope_of, value_of
from validate.reference.effects.car import DAMPER, KNUCKLE, RADIUS, STEERING, WHEEL, Car, Line, contact_of
from validate.reference.effects.effect import RACK, ROLL, TIME, TRAVEL, Effect
from validate.reference.jet import Jet
from validate.reference.kinematics import body_rates
from validate.reference.vectors import Scalar, Vector, cross, dot, each, length, minus, plus, root, times


def _camber(car: Car) -> Scalar:
    """atan2(-a . up, a . outboard), eq. (17) of the paper."""
    return angle(-dot(car.wheel.along, car.up), dot(car.wheel.along, car.outboard))


def _kingpin(car: Car) -> Scalar:
    """atan2(-k . outboard, k . up), eq. (16)."""
    return angle(-dot(car.steering.along, car.outboard), dot(car.steering.along, car.up))


def _toe(car: Car) -> Scalar:
    """atan2(a . forward, a . outboard) (ISO 8855, 7.1.6)."""
    return angle(dot(car.wheel.along, car.forward), dot(car.wheel.along, car.outboard))


def _caster(car: Car) -> Scalar:
    """atan2(k . rearward, k . up)."""
    return angle(-dot(car.steering.along, car.forward), dot(car.steering.along, car.up))


def _arcsine(sine: Scalar, one: Scalar, other: Scalar) -> Scalar:
    """asin of a component of a unit vector, from it and the other two of a vector of any length.

    They are all along the car's axes, which are rounded: l^2 - s^2 would be of other axes than s is.
    """
    return angle(sine, root(one * one + other * other))


def _camber_by_arcsine(car: Car) -> Scalar:
    """-asin(n . up), n = a / |a| (Adams/Car)."""
    a = car.wheel.along
    return _arcsine(-dot(a, car.up), dot(a, car.outboard), dot(a, car.forward))


def _toe_by_arcsine(car: Car, wheel: Line | None = None) -> Scalar:
    """asin(n . forward), n = a / |a| (OptimumK)."""
    a = (wheel or car.wheel).along
    return _arcsine(dot(a, car.forward), dot(a, car.outboard), dot(a, car.up))


def _toe_change_by_arcsine(car: Car) -> Scalar:
    """asin(n . forward) - asin(drawn n . forward) (OptimumK's steer angle, the other way)."""
    return _toe_by_arcsine(car) - _toe_by_arcsine(car, car.drawn.lines[WHEEL])


def steer_angle(car: Car) -> Scalar:
    """Toe of a right wheel, minus toe of a left one: positive to the left."""
    ahead = dot(car.wheel.along, car.forward)
    return angle(ahead if car.is_right else -ahead, dot(car.wheel.along, car.outboard))


def _travel(car: Car) -> Scalar:
    """(W - drawn W) . up, before the turns of the chassis."""
    return dot(minus(car.on_chassis[WHEEL].end, car.drawn.lines[WHEEL].end), car.up)


def _contact_travel(car: Car) -> Scalar:
    """(c - drawn c) . up, before the turns of the chassis, c of the disc that hangs along its own up."""
    return dot(minus(contact_of(car.drawn, car.on_chassis[WHEEL]), car.drawn.contact), car.up)


def _half_track_change(car: Car) -> Scalar:
    """(c - drawn c) . outboard."""
    return dot(minus(car.contact, car.drawn.contact), car.outboard)


def _recession(car: Car) -> Scalar:
    """(c - drawn c) . rearward."""
    return dot(minus(car.contact, car.drawn.contact), car.rearward)


def _level(off: Vector, k: Vector, up: Vector) -> Vector:
    """From the point of an axis along k that is as high as a point to it: o - k (o . up) / (k . up).

    Args:
        off: o, from any point of the axis.
    """
    return minus(off, times(k, dot(off, up) / dot(k, up)))


def _from_axis(car: Car, point: Vector) -> Vector:
    """From the steering axis' point at the height of a point to it."""
    return _level(minus(point, car.steering.start), car.steering.along, car.up)


def _kingpin_offset(car: Car) -> Scalar:
    """From the axis to c along outboard (ISO 8855, 7.2.6)."""
    return dot(_from_axis(car, car.contact), car.outboard)


def _scrub_radius(car: Car) -> Scalar:
    """From the axis to c (ISO 8855, 7.2.10)."""
    return length(_from_axis(car, car.contact))


def _mechanical_trail(car: Car) -> Scalar:
    """From c to the axis along (forward a . outboard - outboard a . forward) / h, the tyre's own forward.

    h is the length of the level part of a (ISO 8855, 7.2.3).
    """
    return _ahead(car, _from_axis(car, car.contact), car.wheel.along)


def _ahead(car: Car, offset: Vector, a: Vector) -> Scalar:
    """Of an offset, backward along the level part of the plane of the tyre."""
    out, ahead = dot(a, car.outboard), dot(a, car.forward)
    across = dot(offset, car.outboard) * ahead - dot(offset, car.forward) * out
    return across / root(out * out + ahead * ahead)


def _castor_offset(car: Car) -> Scalar:
    """From c to the axis along forward."""
    return -dot(_from_axis(car, car.contact), car.forward)


def _kingpin_offset_at_wheel(car: Car) -> Scalar:
    """From the axis to W along outboard."""
    return dot(_from_axis(car, car.wheel.end), car.outboard)


def _hub_trail(car: Car) -> Scalar:
    """From W to the axis along rearward."""
    return dot(_from_axis(car, car.wheel.end), car.forward)


def _damper_length(car: Car) -> Scalar:
    """The distance of its ends."""
    return length(car.lines[DAMPER].along)


def _turning(car: Car) -> Vector:
    """omega."""
    assert car.knuckle is not None
    u, v = (each(lambda x: Jet(value_of(x), slope_of(x)), vector) for vector in car.knuckle)
    return body_rates(u, v)[0]


def velocity_of_contact(car: Car) -> Vector:
    """v = W' + omega x (c - W)."""
    centre = car.wheel.end
    arm = minus(each(value_of, car.contact), each(value_of, centre))
    return plus(each(slope_of, centre), cross(_turning(car), arm))


def _roll_centre_height(car: Car) -> Scalar:
    """(c . outboard) (v . outboard) / (v . up).

    The line through c at right angles to v meets the middle plane, which holds the origin, there above c.
    """
    v, contact = velocity_of_contact(car), each(value_of, car.contact)
    return dot(minus(contact, car.drawn.origin), car.outboard) * dot(v, car.outboard) / dot(v, car.up)


def _arm_roll_centre_height(car: Car) -> Scalar:
    """The same with the turn omega + f k about the steering axis besides, f such that no point of the axis of
    this motion moves along it: (omega + f k) . u = 0 with u = W' + omega x (A - W), A the axis' lower point.
    """
    lower, k = each(value_of, car.steering.start), each(value_of, car.steering.along)
    arm = minus(each(value_of, car.contact), lower)
    omega, centre = _turning(car), each(value_of, car.wheel.end)
    u = plus(each(slope_of, car.wheel.end), cross(omega, minus(lower, centre)))
    turn = minus(omega, times(k, dot(omega, u) / dot(k, u)))
    v = plus(u, cross(turn, arm))
    far = dot(minus(each(value_of, car.contact), car.drawn.origin), car.outboard)
    return far * dot(v, car.outboard) / dot(v, car.up)


def _damper_per_wheel(car: Car) -> Scalar:
    """-l' / travel'."""
    return -slope_of(_damper_length(car)) / slope_of(_travel(car))


def _wheel_per_damper(car: Car) -> Scalar:
    """-travel' / l'."""
    return -slope_of(_travel(car)) / slope_of(_damper_length(car))


def _spring_force(car: Car) -> Scalar:
    """K (l_0 - l)."""
    data = car.drawn.data
    return data[SPRING_RATE] * (data[FREE_LENGTH] - value_of(_damper_length(car)))


def _wheel_rate(car: Car) -> Scalar:
    """K (l' / travel')^2."""
    return car.drawn.data[SPRING_RATE] * _damper_per_wheel(car) * _damper_per_wheel(car)


# As the rack moves, all else held, the carrier turns with omega about an axis that leads through
# W + omega x W' / omega^2, and goes along it by omega . W' / omega^2 per radian. Where it does not turn, or
# omega is level, the quotients are not finite.


def _from_screw(car: Car, point: Vector) -> Vector:
    """From the point of the screw axis at the height of a point to it."""
    omega, moved = _turning(car), each(slope_of, car.wheel.end)
    beside = times(cross(omega, moved), 1 / dot(omega, omega))
    off = minus(minus(each(value_of, point), each(value_of, car.wheel.end)), beside)
    return _level(off, omega, car.up)


def _screw_lean(car: Car, direction: Vector) -> Scalar:
    """atan2(k . direction, k . up) of the axis k = omega (omega . up), which leads up."""
    omega = _turning(car)
    rise = dot(omega, car.up)
    return angle(dot(omega, direction) * rise, rise * rise)


def _screw_pitch(car: Car) -> Scalar:
    """Omega . W' / omega^2."""
    omega = _turning(car)
    return dot(omega, each(slope_of, car.wheel.end)) / dot(omega, omega)


# In the plane through c that a level direction h and `up` span, the carrier moves its points as a plane
# figure. The point c + x h + z up rests in this plane where
#     v . h - z omega . a = 0,      v . up + x omega . a = 0,      a = h x up.
# Where omega . a = 0 this instant centre is at infinity: the quotients are not finite.


def _aside(car: Car, h: Vector) -> Scalar:
    """x."""
    return -dot(velocity_of_contact(car), car.up) / dot(_turning(car), cross(h, car.up))


def _above(car: Car, h: Vector) -> Scalar:
    """z."""
    return dot(velocity_of_contact(car), h) / dot(_turning(car), cross(h, car.up))


# A force F that brakes the car shifts F h / L from the rear wheels to the front ones: h is the height of the
# centre of gravity above the ground at this pose, L the wheelbase. This axle's part of it, b F rearward, acts
# on a point of the carrier that moves with v as the wheel travels, and so lifts the wheel as a force
# b F (v . rearward) / (v . up) would. What that takes off the shifted load, of all of it, is
#     b s (v . rearward) / (v . up) L / h,      s = -1 at the front and +1 at the rear.
# A brake at the wheel holds it to the carrier: v is that of c. A driving force is forward and shifts load
# rearward, which is the same quotient; its torque comes from the chassis by a shaft, so that the carrier
# feels a force at the wheel centre alone: v = W'.


def _anti(car: Car, share: str, v: Vector) -> Scalar:
    data = car.drawn.data
    lever = data[WHEELBASE] / (data[HEIGHT] - value_of(_contact_travel(car)))
    return 100 * data[share] * data[AXLE] * dot(v, car.rearward) / dot(v, car.up) * lever


ANGLES = (
    Effect("camber", "rad", (WHEEL,), _camber),
    Effect("kingpin", "rad", (STEERING,), _kingpin),
    Effect("toe", "rad", (WHEEL,), _toe),
    Effect("caster", "rad", (STEERING,), _caster),
)

OF_POSITIONS = (
    *ANGLES,
    Effect("camber_by_arcsine", "rad", (WHEEL,), _camber_by_arcsine),
    Effect("toe_by_arcsine", "rad", (WHEEL,), _toe_by_arcsine),
    Effect("toe_change_by_arcsine", "rad", (WHEEL,), _toe_change_by_arcsine),
    Effect("steer_angle", "rad", (WHEEL,), steer_angle),
    Effect("travel", "mm", (WHEEL,), _travel),
    Effect("contact_travel", "mm", (WHEEL, RADIUS), _contact_travel),
    Effect("half_track_change", "mm", (WHEEL, RADIUS), _half_track_change),
    Effect("recession", "mm", (WHEEL, RADIUS), _recession),
    Effect("kingpin_offset", "mm", (WHEEL, STEERING, RADIUS), _kingpin_offset),
    Effect("scrub_radius", "mm", (WHEEL, STEERING, RADIUS), _scrub_radius),
    Effect("mechanical_trail", "mm", (WHEEL, STEERING, RADIUS), _mechanical_trail),
    Effect("castor_offset", "mm", (WHEEL, STEERING, RADIUS), _castor_offset),
    Effect("kingpin_offset_at_wheel", "mm", (WHEEL, STEERING), _kingpin_offset_at_wheel),
    Effect("hub_trail", "mm", (WHEEL, STEERING), _hub_trail),
    Effect("damper_length", "mm", (DAMPER,), _damper_length),
)


PER = {TRAVEL: "mm", RACK: "mm", ROLL: "rad", TIME: "s"}


def _gradient(effect: Effect, along: str) -> Effect:
    """N', by the one driven input that goes along, see `Effect.along`; by travel N' / travel'."""
    travels = along == TRAVEL
    needs = (*effect.needs, *([WHEEL] if travels else []), *([] if along == TIME else [along]))

    def evaluate(car: Car) -> Scalar:
        slope = slope_of(effect.evaluate(car))
        return slope / slope_of(_travel(car)) if travels else slope

    return replace(
        effect,
        name=f"{effect.name}_{along}",
        unit=f"{effect.unit}/{PER[along]}",
        needs=tuple(dict.fromkeys(needs)),
        evaluate=evaluate,
        along=along,
    )


MOVING = (WHEEL, RADIUS, KNUCKLE, TRAVEL)
_OF_THE_CAR = (*MOVING, AXLE, WHEELBASE, HEIGHT)

STEERED = (WHEEL, RADIUS, KNUCKLE, RACK)
SPRUNG = (DAMPER, WHEEL, TRAVEL, SPRING_RATE, FREE_LENGTH)

OF_SCREW: tuple[tuple[str, str, Callable[[Car], Scalar]], ...] = (
    ("kingpin", "rad", lambda car: -_screw_lean(car, car.outboard)),
    ("caster", "rad", lambda car: -_screw_lean(car, car.forward)),
    ("kingpin_offset", "mm", lambda car: dot(_from_screw(car, car.contact), car.outboard)),
    ("scrub_radius", "mm", lambda car: length(_from_screw(car, car.contact))),
    (
        "mechanical_trail",
        "mm",
        lambda car: _ahead(car, _from_screw(car, car.contact), each(value_of, car.wheel.along)),
    ),
    ("castor_offset", "mm", lambda car: -dot(_from_screw(car, car.contact), car.forward)),
    ("kingpin_offset_at_wheel", "mm", lambda car: dot(_from_screw(car, car.wheel.end), car.outboard)),
    ("hub_trail", "mm", lambda car: dot(_from_screw(car, car.wheel.end), car.forward)),
    ("pitch", "mm/rad", _screw_pitch),
)

OF_MOTION = (
    *(Effect(f"screw_{name}", unit, STEERED, evaluate, RACK) for name, unit, evaluate in OF_SCREW),
    Effect("damper_per_wheel", "mm/mm", (DAMPER, WHEEL, TRAVEL), _damper_per_wheel, TRAVEL),
    Effect("wheel_per_damper", "mm/mm", (DAMPER, WHEEL, TRAVEL), _wheel_per_damper, TRAVEL),
    Effect("spring_force", "N", SPRUNG, _spring_force, TRAVEL),
    Effect("wheel_force", "N", SPRUNG, lambda car: _spring_force(car) * _damper_per_wheel(car), TRAVEL),
    Effect("wheel_rate", "N/mm", SPRUNG, _wheel_rate, TRAVEL),
    Effect("arm_roll_centre_height", "mm", (*MOVING, STEERING), _arm_roll_centre_height, TRAVEL),
    Effect("roll_centre_height", "mm", MOVING, _roll_centre_height, TRAVEL),
    Effect("front_view_swing_arm", "mm", MOVING, lambda car: -_aside(car, car.outboard), TRAVEL),
    Effect("front_view_centre_height", "mm", MOVING, lambda car: _above(car, car.outboard), TRAVEL),
    Effect("side_view_swing_arm", "mm", MOVING, lambda car: _aside(car, car.rearward), TRAVEL),
    Effect("side_view_centre_height", "mm", MOVING, lambda car: _above(car, car.rearward), TRAVEL),
    Effect(
        "anti_brake",
        "%",
        (*_OF_THE_CAR, BRAKE_SHARE),
        lambda car: _anti(car, BRAKE_SHARE, velocity_of_contact(car)),
        TRAVEL,
    ),
    Effect(
        "anti_drive",
        "%",
        (*_OF_THE_CAR, DRIVE_SHARE),
        lambda car: _anti(car, DRIVE_SHARE, each(slope_of, car.wheel.end)),
        TRAVEL,
    ),
)

GRADIENTS = tuple(_gradient(effect, along) for effect in OF_POSITIONS for along in PER)
