r"""The numbers of one wheel, defined in `pointcoord/effects/README.md`.

a is the wheel's spin axis, k the steering axis, W the wheel centre, c the contact point. ' is the derivative
if the car's numbers are duals. The wheel's carrier turns with omega; v is the velocity of its point at c.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import validate.reference.car_data as data
from validate.reference.effects.car import Car, Effect
from validate.reference.jet import angle, only_where, slope_of, value_of
from validate.reference.vectors import Scalar, Vector, cross, dot, each, length, minus, plus, root, times

_WHEEL = (data.WHEEL,)
ON_GROUND = (*_WHEEL, data.RADIUS)
MOVING = (*ON_GROUND, data.KNUCKLE, data.TRAVEL)

# Of positions.

LEANS: dict[str, tuple[str, Callable[[Scalar, Scalar, Scalar], Scalar]]] = {
    "camber": (data.WHEEL, lambda out, _, up: angle(-up, out)),  # eq. (17) of the paper
    "kingpin": (data.STEERING, lambda out, _, up: angle(-out, up)),  # eq. (16)
    "toe": (data.WHEEL, lambda out, ahead, _: angle(ahead, out)),  # ISO 8855, 7.1.6
    "caster": (data.STEERING, lambda _, ahead, up: angle(-ahead, up)),
    # The arcsine of the component of a unit vector. As the car's axes are rounded, l^2 - s^2 is not exactly
    # the sum of squares of the other two components.
    "camber_by_arcsine": (data.WHEEL, lambda out, ahead, up: angle(-up, root(out * out + ahead * ahead))),
    "toe_by_arcsine": (data.WHEEL, lambda out, ahead, up: angle(ahead, root(out * out + up * up))),
}
"""Angles of a line of a role from its components outboard, forward and up; arcsines as in Adams/Car,
OptimumK.
"""


def _lean(name: str, car: Car, along: Vector | None = None) -> Scalar:
    """One of `LEANS`, of the line of its role or of another direction."""
    role, formula = LEANS[name]
    v = along or car.lines[role].along
    return formula(dot(v, car.outboard), dot(v, car.forward), dot(v, car.up))


def _toe_change_by_arcsine(car: Car) -> Scalar:
    """asin(n . forward) - asin(drawn n . forward) (OptimumK's steer angle with the opposite sign)."""
    return _lean("toe_by_arcsine", car) - _lean("toe_by_arcsine", car.drawn)


def steer_angle(car: Car) -> Scalar:
    """Toe of a right wheel, minus toe of a left one: positive to the left."""
    a = car.wheel.along
    return angle(dot(a, car.forward) * car.side, dot(a, car.outboard))


def _travel(car: Car) -> Scalar:
    """(W - drawn W) . up, before the turns of the chassis."""
    return dot(minus(car.on_chassis[data.WHEEL].end, car.drawn.wheel.end), car.up)


def _contact_travel(car: Car) -> Scalar:
    """(c - drawn c) . up, before the turns of the chassis."""
    return dot(minus(car.contact_of(car.on_chassis[data.WHEEL]), car.drawn.contact), car.up)


def _contact_moved(car: Car, along: Vector) -> Scalar:
    return dot(minus(car.contact, car.drawn.contact), along)


def _damper_length(car: Car) -> Scalar:
    return length(car.lines[data.DAMPER].along)


def _behind(car: Car, off: Vector, a: Vector) -> Scalar:
    """Backward along the level part of the tyre's plane: (forward a . outboard - outboard a . forward) / h.

    h is the length of the level part of a (ISO 8855, 7.2.3).
    """
    out, ahead = dot(a, car.outboard), dot(a, car.forward)
    across = dot(off, car.outboard) * ahead - dot(off, car.forward) * out
    return across / root(out * out + ahead * ahead)


OFFSETS: dict[str, tuple[bool, Callable[[Car, Vector, Vector], Scalar]]] = {
    "kingpin_offset": (True, lambda car, off, _: dot(off, car.outboard)),  # ISO 8855, 7.2.6
    "scrub_radius": (True, lambda _, off, __: length(off)),  # ISO 8855, 7.2.10
    "mechanical_trail": (True, _behind),
    "castor_offset": (True, lambda car, off, _: -dot(off, car.forward)),
    "kingpin_offset_at_wheel": (False, lambda car, off, _: dot(off, car.outboard)),
    "hub_trail": (False, lambda car, off, _: dot(off, car.forward)),
}
"""For each number, whether it belongs to c or to W, and its formula from that point's offset and from a."""


def _offset(name: str, car: Car, start: Vector, k: Vector) -> Scalar:
    """One of `OFFSETS`, from the point of an axis along k at the same height: o - k (o . up) / (k . up).

    Args:
        start: any point of the axis.
    """
    at_contact, formula = OFFSETS[name]
    o = minus(car.contact if at_contact else car.wheel.end, start)
    level = minus(o, times(k, dot(o, car.up) / dot(k, car.up)))
    return formula(car, level, car.wheel.along)


def _from_steering(name: str, car: Car) -> Scalar:
    axis = car.lines[data.STEERING]
    return _offset(name, car, axis.start, axis.along)


OF_POSITIONS = (
    *(Effect(name, "rad", (role,), partial(_lean, name)) for name, (role, _) in LEANS.items()),
    Effect("toe_change_by_arcsine", "rad", _WHEEL, _toe_change_by_arcsine),
    Effect("steer_angle", "rad", _WHEEL, steer_angle),
    Effect("travel", "mm", _WHEEL, _travel),
    Effect("contact_travel", "mm", ON_GROUND, _contact_travel),
    Effect("half_track_change", "mm", ON_GROUND, lambda car: _contact_moved(car, car.outboard)),
    Effect("recession", "mm", ON_GROUND, lambda car: -_contact_moved(car, car.forward)),
    *(
        Effect(
            name, "mm", (data.STEERING, *(ON_GROUND if grounded else _WHEEL)), partial(_from_steering, name)
        )
        for name, (grounded, _) in OFFSETS.items()
    ),
    Effect("damper_length", "mm", (data.DAMPER,), _damper_length),
)


# By the travel of the wheel.


def velocity_of_contact(car: Car) -> Vector:
    """v."""
    return car.velocity(car.contact)


def _roll_centre(car: Car, v: Vector) -> Scalar:
    """(c . outboard) (v . outboard) / (v . up).

    The line through c at right angles to v meets the middle plane, which contains the origin, at this height
    above c.
    """
    far = dot(minus(each(value_of, car.contact), car.drawn.origin), car.outboard)
    return far * dot(v, car.outboard) / dot(v, car.up)


def _arm_roll_centre_height(car: Car) -> Scalar:
    """The roll centre with an added turn f k about the steering axis that makes the motion a pure rotation:
    (omega + f k) . u = 0 with u the velocity at the axis' lower point.
    """
    axis, omega = car.lines[data.STEERING], car.turning
    lower, k = each(value_of, axis.start), each(value_of, axis.along)
    u = car.velocity(axis.start)
    turn = minus(omega, times(k, dot(omega, u) / dot(k, u)))
    return _roll_centre(car, plus(u, cross(turn, minus(each(value_of, car.contact), lower))))


def _damper_per_wheel(car: Car) -> Scalar:
    """-l' / travel'."""
    return -slope_of(_damper_length(car)) / slope_of(_travel(car))


def _wheel_per_damper(car: Car) -> Scalar:
    return -slope_of(_travel(car)) / slope_of(_damper_length(car))


def _spring_force(car: Car) -> Scalar:
    """K (l_0 - l)."""
    given = car.drawn.data
    return given[data.SPRING_RATE] * (given[data.FREE_LENGTH] - value_of(_damper_length(car)))


def _wheel_rate(car: Car) -> Scalar:
    """K (l' / travel')^2."""
    return car.drawn.data[data.SPRING_RATE] * _damper_per_wheel(car) * _damper_per_wheel(car)


# In the plane through c that a level direction h and `up` span, the instant centre of the carrier is
# c + x h + z up with
#     v . h - z omega . a = 0,      v . up + x omega . a = 0,      a = h x up.
# It has no number if omega . a = 0 or if it is farther from c than this, in wheel radii.
FARTHEST = 10**9


def _beside(car: Car, h: Vector) -> Scalar:
    """x of the instant centre; NaN at infinity."""
    far = -dot(velocity_of_contact(car), car.up) / dot(car.turning, cross(h, car.up))
    return only_where(far, abs(value_of(far)) <= FARTHEST * car.drawn.data[data.RADIUS])


def _above(car: Car, h: Vector) -> Scalar:
    """z of the instant centre; NaN at infinity."""
    return dot(velocity_of_contact(car), h) / dot(car.turning, cross(h, car.up)) + 0 * _beside(car, h)


# A force F that brakes the car shifts the load F h / L from the rear to the front wheels; h is the height of
# the centre of gravity above the ground at this pose, L the wheelbase. This axle's part, b F rearward, acts
# on a point of the carrier that moves with v as the wheel travels, like a lifting force
# b F (v . rearward) / (v . up). The share of the shifted load that this force carries is
#     b s (v . rearward) / (v . up) L / h,      s = -1 at the front and +1 at the rear.
# A brake locks the wheel to the carrier: v is the velocity of c. A driving force points forward and shifts
# load rearward, which gives the same quotient; the shaft from the chassis takes the torque, so v = W'.


def _anti(share: str, velocity: Callable[[Car], Vector], car: Car) -> Scalar:
    given, v = car.drawn.data, velocity(car)
    lever = given[data.WHEELBASE] / (given[data.HEIGHT] - value_of(_contact_travel(car)))
    return 100 * given[share] * given[data.AXLE] * -dot(v, car.forward) / dot(v, car.up) * lever


_DAMPED = (data.DAMPER, data.WHEEL, data.TRAVEL)
_SPRUNG = (*_DAMPED, data.SPRING_RATE, data.FREE_LENGTH)
_BRAKED = (*MOVING, data.AXLE, data.WHEELBASE, data.HEIGHT, data.BRAKE_SHARE)
_DRIVEN = (*_BRAKED[:-1], data.DRIVE_SHARE)
_BY_TRAVEL: dict[str, tuple[str, tuple[str, ...], Callable[[Car], Scalar]]] = {
    "damper_per_wheel": ("mm/mm", _DAMPED, _damper_per_wheel),
    "wheel_per_damper": ("mm/mm", _DAMPED, _wheel_per_damper),
    "spring_force": ("N", _SPRUNG, _spring_force),
    "wheel_force": ("N", _SPRUNG, lambda car: _spring_force(car) * _damper_per_wheel(car)),
    "wheel_rate": ("N/mm", _SPRUNG, _wheel_rate),
    "arm_roll_centre_height": ("mm", (*MOVING, data.STEERING), _arm_roll_centre_height),
    "roll_centre_height": ("mm", MOVING, lambda car: _roll_centre(car, velocity_of_contact(car))),
    "front_view_swing_arm": ("mm", MOVING, lambda car: -_beside(car, car.outboard)),
    "front_view_centre_height": ("mm", MOVING, lambda car: _above(car, car.outboard)),
    "side_view_swing_arm": ("mm", MOVING, lambda car: _beside(car, times(car.forward, -1))),
    "side_view_centre_height": ("mm", MOVING, lambda car: _above(car, times(car.forward, -1))),
    "anti_brake": ("%", _BRAKED, partial(_anti, data.BRAKE_SHARE, velocity_of_contact)),
    "anti_drive": ("%", _DRIVEN, partial(_anti, data.DRIVE_SHARE, lambda car: each(slope_of, car.wheel.end))),
}


# By the travel of the rack. When only the rack moves, the carrier turns with omega about an axis through
# W + omega x W' / omega^2, and moves along it by omega . W' / omega^2 per radian. The quotients are not
# finite if omega is zero or level.


def _from_screw(name: str, car: Car) -> Scalar:
    omega, centre = car.turning, car.wheel.end
    off = times(cross(omega, each(slope_of, centre)), 1 / dot(omega, omega))
    return value_of(_offset(name, car, plus(each(value_of, centre), off), omega))


def _screw_lean(name: str, car: Car) -> Scalar:
    """One of `LEANS` of the screw axis, omega (omega . up), which leads up."""
    return _lean(name, car, times(car.turning, dot(car.turning, car.up)))


def _screw_pitch(car: Car) -> Scalar:
    """omega . W' / omega^2."""
    return dot(car.turning, each(slope_of, car.wheel.end)) / dot(car.turning, car.turning)


_BY_RACK: dict[str, tuple[str, Callable[[Car], Scalar]]] = {
    **{name: ("rad", partial(_screw_lean, name)) for name in ("kingpin", "caster")},
    **{name: ("mm", partial(_from_screw, name)) for name in OFFSETS},
    "pitch": ("mm/rad", _screw_pitch),
}
OF_MOTION = (
    *(Effect(name, unit, needs, of, data.TRAVEL) for name, (unit, needs, of) in _BY_TRAVEL.items()),
    *(
        Effect(f"screw_{name}", unit, (*ON_GROUND, data.KNUCKLE, data.RACK), of, data.RACK)
        for name, (unit, of) in _BY_RACK.items()
    ),
)

PER = {data.TRAVEL: "mm", data.RACK: "mm", data.ROLL: "rad", data.TIME: "s"}


def _gradient(effect: Effect, along: str) -> Effect:
    """The derivative N' by a variable of `Effect.along`; by travel it is N' / travel'."""
    travels = along == data.TRAVEL
    needs = (*effect.needs, *([data.WHEEL] if travels else []), *([] if along == data.TIME else [along]))

    def evaluate(car: Car) -> Scalar:
        slope = slope_of(effect.evaluate(car))
        return slope / slope_of(_travel(car)) if travels else slope

    name, unit = f"{effect.name}_{along}", f"{effect.unit}/{PER[along]}"
    return replace(effect, name=name, unit=unit, needs=needs, evaluate=evaluate, along=along)


GRADIENTS = tuple(_gradient(effect, along) for effect in OF_POSITIONS for along in PER)
