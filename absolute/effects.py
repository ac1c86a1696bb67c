"""Effects: numbers of the car at each instant of a solved motion, by name.

A number is a function of points, which also gives its derivatives by inputs (see `Dual`). With n the
direction from the inner point of the spin axis to the wheel centre W, and k the line from the lower to the
upper point of the steering axis, the contact point of a wheel of radius r is the lowest point of a thin disc,

    c = W - r unit(up - (up . n) n),

and is measured from the point at the same height on the line along k. Components are along outboard, rearward
and up as drawn.

As the wheel travels, c as a point of the knuckle has the velocity v, and the knuckle the angular velocity w.
In the plane through c of a horizontal h and up, the knuckle's points move about the instant centre

    c - (v . up / w . a) h + (v . h / w . a) up,    a = h x up.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from absolute.dual import Dual, arctan2, constant, hypot
from absolute.errors import DescriptionError, InputError
from absolute.model import Model
from absolute.newton import SMALLEST_RCOND
from absolute.results import Motion
from absolute.vectors import EPS, Array

Number = Callable[[Motion], Dual]
Values = Callable[[Motion], Array]
# (motion, components of an axis, vector from a point of the axis to the wheel centre) -> number.
OfAxis = Callable[[Motion, Dual, Number], Dual]

OUTBOARD, REARWARD, UP = 0, 1, 2
TIME = "time"
GRADIENTS = {"travel": "mm", "rack": "mm", "roll": "rad", TIME: "s"}
# Share of a velocity that may be rounding at the largest condition number that is accepted.
ROUNDING = EPS / SMALLEST_RCOND
# Below this a number may be rounding: as a share of a velocity; for the knuckle's rotation, in rad for a rack
# travel of one wheel radius.
LEAST = 1e-9
# In wheel radii: an instant centre that is farther away has no number.
FARTHEST = 1e9


@dataclass(frozen=True)
class Effect:
    """A number at each instant.

    Attributes:
        unit: unit of the value.
        value: motion at a wheel -> (N,); for an axle, motions at the left and the right wheel -> (N,).
        by: the input of each wheel by which it takes derivatives: "rack", the travel of a slide; "travel",
            the other input; "roll", the one that rolls the chassis; "time", all as they move; "" for none.
    """

    unit: str
    value: Callable[..., Array]
    by: str = ""


def _of_line(role: str, number: Callable[..., Dual]) -> Number:
    """A number from the components of the line of a role."""
    return lambda motion: number(*motion.components(motion.line(*motion.corner.need(role))))


def centre(motion: Motion) -> Dual:
    """Place of the wheel centre, (3, N)."""
    return motion.place(motion.corner.need("wheel_axis")[1])


def contact(motion: Motion) -> Dual:
    """From the wheel centre to the contact point, (3, N)."""
    spin = motion.line(*motion.corner.need("wheel_axis"))
    normal = spin / hypot(*spin)
    up = constant(motion.corner.axes[UP][:, None])
    down = normal * motion.components(normal)[UP] - up
    return down * (constant(motion.corner.need("wheel_radius")) / hypot(*down))


def ground(motion: Motion) -> Dual:
    """Place of the contact point, (3, N)."""
    return centre(motion) + contact(motion)


def _moved(motion: Motion, place: Number) -> Dual:
    """Components of the displacement of a place from the drawing, (3, N)."""
    return motion.components(place(motion) - place(motion.drawn))


toe = _of_line("wheel_axis", lambda outboard, rearward, up: arctan2(-rearward, outboard))
# Arcsine of the forward component of the unit spin axis, as the arctangent of its two parts.
toe_by_arcsine = _of_line("wheel_axis", lambda o, rearward, up: arctan2(-rearward, hypot(o, up)))


def steer_angle(motion: Motion) -> Dual:
    """Steer angle of the wheel plane in plan view, positive to the left."""
    return toe(motion) if motion.corner.side == "right" else -toe(motion)


def travel(motion: Motion) -> Dual:
    """Displacement of the wheel centre along up in the chassis' frame."""
    return _moved(motion.in_the_car, centre)[UP]


def contact_travel(motion: Motion) -> Dual:
    """Displacement of the contact point along up in the chassis' frame."""
    return _moved(motion.in_the_car, ground)[UP]


def damper_length(motion: Motion) -> Dual:
    """Distance of the ends of the damper."""
    return hypot(*motion.line(*motion.corner.need("damper")))


def _level_with(axis: Dual, point: Dual) -> Dual:
    """Vector to a point from the axis at the same height; `point` counts from any point of the axis."""
    return point - axis * (point[UP] / axis[UP])


def _at_wheel(motion: Motion, axis: Dual, to_centre: Number) -> Dual:
    return _level_with(axis, motion.components(to_centre(motion)))


def _at_ground(motion: Motion, axis: Dual, to_centre: Number) -> Dual:
    return _level_with(axis, motion.components(to_centre(motion) + contact(motion)))


def mechanical_trail(motion: Motion, axis: Dual, to_centre: Number) -> Dual:
    """From the contact point to the axis at the ground, along the tyre's own forward direction."""
    outboard, rearward, _ = _at_ground(motion, axis, to_centre)
    spin_outboard, spin_rearward, _ = motion.components(motion.line(*motion.corner.need("wheel_axis")))
    return (rearward * spin_outboard - outboard * spin_rearward) / hypot(spin_outboard, spin_rearward)


OF_AXIS: Mapping[str, tuple[str, OfAxis]] = {
    "kingpin": ("rad", lambda motion, axis, _: arctan2(-axis[OUTBOARD], axis[UP])),
    "caster": ("rad", lambda motion, axis, _: arctan2(axis[REARWARD], axis[UP])),
    "kingpin_offset": ("mm", lambda *of: _at_ground(*of)[OUTBOARD]),
    # Never negative.
    "scrub_radius": ("mm", lambda *of: hypot(_at_ground(*of)[OUTBOARD], _at_ground(*of)[REARWARD])),
    "mechanical_trail": ("mm", mechanical_trail),
    "castor_offset": ("mm", lambda *of: _at_ground(*of)[REARWARD]),
    "kingpin_offset_at_wheel": ("mm", lambda *of: _at_wheel(*of)[OUTBOARD]),
    "hub_trail": ("mm", lambda *of: -_at_wheel(*of)[REARWARD]),
}


def steering_axis(motion: Motion) -> Dual:
    """From the lower to the upper point of the steering axis, (3, N)."""
    return motion.line(*motion.corner.need("steering_axis"))


def from_lower_point(motion: Motion) -> Dual:
    """From the lower point of the steering axis to the wheel centre, (3, N)."""
    (lower, _), (_, wheel_centre) = motion.corner.needs("steering_axis", "wheel_axis")
    return motion.line(lower, wheel_centre)


def _of_steering(number: OfAxis) -> Number:
    """A number of the steering axis."""
    return lambda motion: number(motion, motion.components(steering_axis(motion)), from_lower_point)


# Numbers that have derivatives.
NUMBERS: Mapping[str, tuple[str, Number]] = {
    "camber": ("rad", _of_line("wheel_axis", lambda outboard, rearward, up: arctan2(-up, outboard))),
    "toe": ("rad", toe),
    "steer_angle": ("rad", steer_angle),
    "camber_by_arcsine": (
        "rad",
        _of_line("wheel_axis", lambda outboard, rearward, up: arctan2(-up, hypot(outboard, rearward))),
    ),
    "toe_by_arcsine": ("rad", toe_by_arcsine),
    # Without the static setting.
    "toe_change_by_arcsine": ("rad", lambda motion: toe_by_arcsine(motion) - toe_by_arcsine(motion.drawn)),
    **{name: (unit, _of_steering(number)) for name, (unit, number) in OF_AXIS.items()},
    "travel": ("mm", travel),
    "contact_travel": ("mm", contact_travel),
    "half_track_change": ("mm", lambda motion: _moved(motion, ground)[OUTBOARD]),
    "recession": ("mm", lambda motion: _moved(motion, ground)[REARWARD]),
    "damper_length": ("mm", damper_length),
}


def _slope(motion: Motion, number: Dual, by: str) -> Array:
    return number.slopes[..., -1 if by == TIME else motion.by.index((motion.part, by))]


def _ratio(rise: Array | float, run: Array, least: Array | float = 0.0) -> Array:
    """The quotient; NaN where run is not larger than `least`, below which it may be rounding."""
    return np.where(np.abs(run) <= least, np.nan, rise / run)


def _per_rise(number: Array, velocity: Array) -> Array:
    """A number per upward component of a velocity, from components (3, N)."""
    return _ratio(number, velocity[UP], LEAST * np.linalg.norm(velocity, axis=0))


def _per_travel(motion: Motion, number: Array) -> Array:
    """A number per upward velocity of the wheel centre in the chassis' frame; NaN where it does not rise."""
    return _per_rise(number, _centre_velocity(motion.in_the_car))


def _centre_velocity(motion: Motion) -> Array:
    """Components of the wheel centre's velocity with travel, (3, N)."""
    return _slope(motion, motion.components(centre(motion)), "travel")


def _contact_velocity(motion: Motion) -> Array:
    """Components of the contact point's velocity v, (3, N)."""
    carried = np.cross(motion.spin("travel"), contact(motion).value, axis=0)
    return np.asarray(_centre_velocity(motion) + motion.corner.axes @ carried)


def _over_the_contact(motion: Motion, velocity: Array) -> Array:
    """Height above the contact point where the normal to a velocity meets the middle plane, in the front
    view.

    The middle plane goes through the origin. NaN where the velocity is level.
    """
    return np.asarray(_from_origin(motion)[OUTBOARD] * _per_rise(velocity[OUTBOARD], velocity))


def _from_origin(motion: Motion) -> Array:
    """Components of the contact point's place, from the origin, (3, N)."""
    middle = constant(motion.model.middle[:, None])
    return motion.components(middle + ground(motion)).value


def arm_roll_centre_height(motion: Motion) -> Array:
    """Roll centre height by the arms: the knuckle also turns about its steering axis so that its motion is a
    pure rotation.

    With u the velocity of the axis' lower point and w the angular velocity of the knuckle, (w + f k) . u = 0.
    NaN where u is normal to the axis k, or zero.
    """
    k, to_centre = steering_axis(motion).value, from_lower_point(motion).value
    w, arm = motion.spin("travel"), to_centre + contact(motion).value
    # The lower point moves with the wheel centre, minus the rotation of the arm from there.
    u = _slope(motion, centre(motion), "travel") - np.cross(w, to_centre, axis=0)
    speed, turning, far = (np.linalg.norm(vector, axis=0) for vector in (u, w, arm))
    along = np.where(speed <= LEAST * turning * far, 0.0, (k * u).sum(axis=0))
    turn = w - k * _ratio((w * u).sum(axis=0), along)
    return _over_the_contact(motion, motion.corner.axes @ (u + np.cross(turn, arm, axis=0)))


def instant_centre(h: int, component: int, sense: float = 1.0) -> Values:
    """Distance of the instant centre in the plane of h and up from c, along h or up; NaN at infinity."""

    def of(motion: Motion) -> Array:
        velocity, axes = _contact_velocity(motion), motion.corner.axes
        turn = np.cross(axes[h], axes[UP]) @ motion.spin("travel")
        least = np.abs(velocity[UP]) / (FARTHEST * motion.corner.need("wheel_radius"))
        return sense * _ratio(velocity[h] if component == UP else -velocity[UP], turn, least)

    return of


def _anti(share: str, velocity_of: Callable[[Motion], Array]) -> Values:
    """Share of the load transfer in braking or driving that the linkage carries, %: anti-dive, anti-lift,
    anti-squat.

    100 share s (v . rearward / v . up) wheelbase / (height of the centre of gravity - contact travel) with s
    = -1 at the front and 1 at the rear; v is the velocity of the point of the knuckle on which the force
    acts. A brake fixes the contact point in the knuckle. A shaft from the chassis drives the wheel, so a
    driving force acts at the wheel centre. NaN where the point does not rise with travel.
    """
    names = ("axle", "wheelbase", "centre_of_gravity_height", share)

    def of(motion: Motion) -> Array:
        sign, wheelbase, drawn_height, part = motion.corner.needs(*names)
        height, velocity = drawn_height - contact_travel(motion).value, velocity_of(motion)
        ratio = _ratio(_per_rise(velocity[REARWARD] * wheelbase, velocity), height)
        return np.asarray(100.0 * part * sign * ratio)

    return of


def damper_per_wheel(motion: Motion) -> Array:
    """Shortening of the damper per mm of travel; NaN where the wheel does not travel."""
    return -_per_travel(motion, _slope(motion, damper_length(motion), "travel"))


def wheel_per_damper(motion: Motion) -> Array:
    """Travel per mm that the damper is shortened; NaN where its length does not change."""
    line = _slope(motion, motion.line(*motion.corner.need("damper")), "travel")
    grown, risen = (_slope(motion, number(motion), "travel") for number in (damper_length, travel))
    return -_ratio(risen, grown, LEAST * np.linalg.norm(line, axis=0))


def spring_force(motion: Motion) -> Array:
    """Rate times the shortening from the free length, N; positive where the spring pushes its ends apart."""
    rate, free = motion.corner.needs("spring_rate", "spring_free_length")
    return np.asarray(rate * (free - damper_length(motion).value))


def wheel_rate(motion: Motion) -> Array:
    """The wheel rate for a constant motion ratio, N/mm."""
    rate, _ = motion.corner.needs("spring_rate", "spring_free_length")
    return np.asarray(rate * damper_per_wheel(motion) ** 2)


def _screw(motion: Motion) -> tuple[Array, Array]:
    """Angular velocity of the knuckle and velocity of the wheel centre with the rack, (3, N); NaN where the
    knuckle does not turn as the rack moves, or about a level line only."""
    w, v = motion.spin("rack"), _slope(motion, centre(motion), "rack")
    turns = np.abs(motion.corner.axes[UP] @ w) * motion.corner.need("wheel_radius") > LEAST
    return np.where(turns, w, np.nan), v


def screw_pitch(motion: Motion) -> Array:
    """Advance of the knuckle along its screw axis per radian as the rack moves, mm."""
    w, v = _screw(motion)
    return np.asarray((w * v).sum(axis=0) / (w * w).sum(axis=0))


def _of_screw(number: OfAxis) -> Values:
    """A number of the screw axis.

    The vector from the axis to the wheel centre, with velocity v, is v x w / w^2, up to a part along the
    axis.
    """

    def of(motion: Motion) -> Array:
        w, v = _screw(motion)
        axis, off = motion.corner.axes @ w, constant(np.cross(v, w, axis=0) / (w * w).sum(axis=0))
        return number(motion, constant(axis * np.sign(axis[UP])), lambda _: off).value

    return of


OF_VELOCITIES: Mapping[str, tuple[str, Values]] = {
    "roll_centre_height": ("mm", lambda motion: _over_the_contact(motion, _contact_velocity(motion))),
    "arm_roll_centre_height": ("mm", arm_roll_centre_height),
    "damper_per_wheel": ("mm/mm", damper_per_wheel),
    "wheel_per_damper": ("mm/mm", wheel_per_damper),
    "spring_force": ("N", spring_force),
    "wheel_force": ("N", lambda motion: spring_force(motion) * damper_per_wheel(motion)),
    "wheel_rate": ("N/mm", wheel_rate),
    "front_view_swing_arm": ("mm", instant_centre(OUTBOARD, OUTBOARD, -1.0)),
    "front_view_centre_height": ("mm", instant_centre(OUTBOARD, UP)),
    "side_view_swing_arm": ("mm", instant_centre(REARWARD, REARWARD)),
    "side_view_centre_height": ("mm", instant_centre(REARWARD, UP)),
    "anti_brake": ("%", _anti("brake_share", _contact_velocity)),
    "anti_drive": ("%", _anti("drive_share", _centre_velocity)),
}


OF_RACK: Mapping[str, tuple[str, Values]] = {
    **{f"screw_{name}": (unit, _of_screw(number)) for name, (unit, number) in OF_AXIS.items()},
    "screw_pitch": ("mm/rad", screw_pitch),
}


def _values(number: Number, by: str) -> Values:
    """A number, or its derivative: per mm of travel, per mm of the slide or per rad of roll while all else is
    held; or per second, while everything moves."""

    def of(motion: Motion) -> Array:
        found = number(motion)
        if not by:
            return found.value
        slope = _slope(motion, found, by)
        return _per_travel(motion, slope) if by == "travel" else slope

    return of


def _with_gradients(name: str, unit: str, number: Number) -> dict[str, Effect]:
    gradients = {
        f"{name}_by_{by}": Effect(f"{unit}/{of}", _values(number, by), by) for by, of in GRADIENTS.items()
    }
    return {name: Effect(unit, _values(number, ""))} | gradients


def _apart(left: Motion, right: Motion) -> Array:
    """From the left to the right contact point, along right, rearward and up, (3, N)."""
    return right.components(ground(right) - ground(left)).value


def _axle_roll_centre(left: Motion, right: Motion) -> tuple[Array, Array]:
    """Intersection of the normals of both contact points in the front view, offset and height, (N,) each.

    With c, d the contact points and v, w their velocities, it is c + x with v . x = 0 and
    w . x = w . (d - c). NaN where the normals are parallel or a velocity is zero.
    """
    (c, v), (_, w) = _front_view(left, -1.0), _front_view(right, 1.0)
    turn, apart = v[0] * w[1] - v[1] * w[0], _apart(left, right)[[OUTBOARD, UP]]
    along = _ratio((w * apart).sum(axis=0), turn, ROUNDING * np.hypot(*v) * np.hypot(*w))
    x = along * np.array([-v[1], v[0]])
    return c[0] + x[0], x[1] - x[0] * apart[1] / apart[0]


def _front_view(motion: Motion, side: float) -> tuple[Array, Array]:
    """The contact point and its velocity with travel, along right and up, (2, N) each; the velocity is zero
    where it may be rounding."""
    velocity, size = _contact_velocity(motion), motion.model.size
    place, seen = (of[[OUTBOARD, UP]] * [[side], [1.0]] for of in (_from_origin(motion), velocity))
    speed = size * np.linalg.norm(motion.spin("travel"), axis=0) + np.linalg.norm(velocity, axis=0)
    return place, np.where(np.hypot(*seen) <= ROUNDING * speed, 0.0, seen)


def _steered(left: Motion, right: Motion) -> tuple[Array, Array, float, Array]:
    """Steer angles of the inner and the outer wheel, NaN unless both are steered to one side; the wheelbase,
    and the track as drawn.
    """
    wheelbase = left.corner.need("wheelbase")
    one, other = (steer_angle(of).value for of in (left, right))
    sizes = np.where(one * other > 0.0, np.abs((one, other)), np.nan)
    inner, outer = np.where(one > 0.0, sizes, sizes[::-1])
    return inner, outer, wheelbase, _apart(left.drawn, right.drawn)[OUTBOARD]


def turning_radius(left: Motion, right: Motion) -> Array:
    """L |cot d_l + cot d_r| / 2: turning radius of the axle's middle for a car of wheelbase L."""
    inner, outer, wheelbase, _ = _steered(left, right)
    return np.asarray(np.abs(_cot(inner) + _cot(outer)) * wheelbase / 2.0)


def ackermann(left: Motion, right: Motion) -> Array:
    """100 (d_i - d_o) / (arccot((R - t/2) / L) - arccot((R + t/2) / L)), %, R the turning radius (Lotus)."""
    inner, outer, wheelbase, width = _steered(left, right)
    radius = turning_radius(left, right)
    wanted = (np.arctan2(wheelbase, radius + half) for half in (-width / 2.0, width / 2.0))
    return np.asarray(100.0 * _ratio(inner - outer, np.subtract(*wanted)))


def ackermann_error(left: Motion, right: Motion) -> Array:
    """d_o - arccot(cot d_i + t / L): steer angle of the outer wheel minus the ideal one."""
    inner, outer, wheelbase, width = _steered(left, right)
    return outer - np.arctan2(1.0, _cot(inner) + width / wheelbase)


def _cot(angle: Array) -> Array:
    return np.asarray(np.cos(angle) / np.sin(angle))


EFFECTS: Mapping[str, Effect] = {
    **{n: effect for name, of in NUMBERS.items() for n, effect in _with_gradients(name, *of).items()},
    **{name: Effect(unit, value, "travel") for name, (unit, value) in OF_VELOCITIES.items()},
    **{name: Effect(unit, value, "rack") for name, (unit, value) in OF_RACK.items()},
}
# The axle's roll centre height is measured along up from the line through both contact points, its offset
# along right from the middle plane, which goes through the origin. The track is the distance of both contact
# points along right.
AXLE_EFFECTS: Mapping[str, Effect] = {
    "track": Effect("mm", lambda *wheels: _apart(*wheels)[OUTBOARD]),
    "axle_roll_centre_height": Effect("mm", lambda *wheels: _axle_roll_centre(*wheels)[1], "travel"),
    "axle_roll_centre_offset": Effect("mm", lambda *wheels: _axle_roll_centre(*wheels)[0], "travel"),
    "turning_radius": Effect("mm", turning_radius),
    "ackermann": Effect("%", ackermann),
    "ackermann_error": Effect("rad", ackermann_error),
}


class Asked(NamedTuple):
    """An effect, and the parts of the mechanism whose wheels it needs."""

    effect: Effect
    parts: tuple[str, ...]


def effects_in(model: Model) -> dict[str, Asked]:
    """All effects of a model by name: `NAME` of EFFECTS, or `PART.NAME` in a mechanism with parts; and those
    of AXLE_EFFECTS if it has two parts on opposite sides. Some may need roles or car data that it has not.
    """
    found = {
        f"{part}.{name}" if part else name: Asked(effect, (part,))
        for part in model.corners
        for name, effect in EFFECTS.items()
    }
    sides = {corner.side: part for part, corner in model.corners.items()}
    if len(sides) == len(model.corners) == 2:
        parts = (sides["left"], sides["right"])
        found |= {name: Asked(effect, parts) for name, effect in AXLE_EFFECTS.items()}
    return found


def effects_of(names: Sequence[str], model: Model) -> tuple[dict[str, Asked], dict[tuple[str, str], str]]:
    """The effects with these names; and (part, "travel", "rack" or "roll") -> the value of the input by which
    they take derivatives.

    Raises:
        InputError: an effect does not exist; the message names all that do.
        DescriptionError: there is not exactly one such input.
    """
    known = effects_in(model) if names else {}
    for name in names:
        if name not in known:
            raise InputError(f"there is no effect {name!r}; it must be one of {list(known)}", name, name)
    found = {name: known[name] for name in names}
    inputs = {
        (part, of.effect.by): model.input_of(part, of.effect.by, f"effect {name!r}")
        for name, of in found.items()
        for part in of.parts
        if of.effect.by not in ("", TIME)
    }
    return found, inputs


def numbers_of(effects: Mapping[str, Asked], motion: Motion) -> dict[str, Array]:
    """name -> (N,) for a motion.

    Raises:
        DescriptionError: an effect needs a role, a wheel radius or car data that the mechanism has not.
    """
    numbers: dict[str, Array] = {}
    for name, asked in effects.items():
        try:
            with np.errstate(all="ignore"):
                numbers[name] = asked.effect.value(*(replace(motion, part=part) for part in asked.parts))
        except DescriptionError as error:
            raise DescriptionError(f"effect {name!r} {error}", error.name) from None
    return numbers
