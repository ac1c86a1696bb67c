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
# (motion, direction of an axis, upward, vector from a point of the axis to the wheel centre) -> number.
OfAxis = Callable[[Motion, Dual, Dual], Dual]
Values = Callable[[Motion], Array]

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


def _along(motion: Motion, role: str) -> Dual:
    """Components of the line of a role, (3, N)."""
    return motion.components(motion.line(*motion.corner.ends(role)))


def _centre(motion: Motion) -> str:
    return motion.corner.ends("wheel_axis")[1]


def _drawn_axis(motion: Motion) -> Dual:
    """The line from the inner point of the spin axis to the wheel centre in the drawing, (3, 1)."""
    inner, centre = motion.corner.ends("wheel_axis")
    return motion.drawn(centre) - motion.drawn(inner)


def contact(motion: Motion, drawn: bool = False) -> Dual:
    """From the wheel centre to the contact point, (3, N)."""
    spin = _drawn_axis(motion) if drawn else motion.line(*motion.corner.ends("wheel_axis"))
    normal = spin / hypot(*spin)
    up = constant(motion.corner.axes[UP][:, None])
    down = normal * motion.components(normal)[UP] - up
    return down * (constant(motion.corner.radius) / hypot(*down))


def _contact_moved(motion: Motion) -> Dual:
    """Components of the contact point's displacement from the drawing, (3, N)."""
    return motion.components(motion.moved(_centre(motion)) + (contact(motion) - contact(motion, drawn=True)))


def _contact_place(motion: Motion) -> Array:
    """Components of the contact point's place, from the origin, (3, N)."""
    centre = _centre(motion)
    return motion.components(motion.drawn(centre) + motion.moved(centre) + contact(motion)).value


def _of_line(role: str, number: Callable[..., Dual]) -> Number:
    """A number from the components of the line of a role."""
    return lambda motion: number(*_along(motion, role))


def _caster(outboard: Dual, rearward: Dual, up: Dual) -> Dual:
    return arctan2(rearward, up)


def _kingpin(outboard: Dual, rearward: Dual, up: Dual) -> Dual:
    return arctan2(-outboard, up)


def _toe_by_arcsine(outboard: Dual, rearward: Dual, up: Dual) -> Dual:
    """Arcsine of the forward component of the unit spin axis, as the arctangent of its two parts."""
    return arctan2(-rearward, hypot(outboard, up))


def toe_change_by_arcsine(motion: Motion) -> Dual:
    """Toe by arcsine minus its drawn value, the static setting."""
    return ANGLES["toe_by_arcsine"](motion) - _toe_by_arcsine(*motion.components(_drawn_axis(motion)))


def steer_angle(motion: Motion) -> Dual:
    """Steer angle of the wheel plane in plan view, positive to the left."""
    toe = ANGLES["toe"](motion)
    return toe if motion.corner.side == "right" else -toe


ANGLES: Mapping[str, Number] = {
    "camber": _of_line("wheel_axis", lambda outboard, rearward, up: arctan2(-up, outboard)),
    "kingpin": _of_line("steering_axis", _kingpin),
    "toe": _of_line("wheel_axis", lambda outboard, rearward, up: arctan2(-rearward, outboard)),
    "caster": _of_line("steering_axis", _caster),
    "steer_angle": steer_angle,
    "camber_by_arcsine": _of_line("wheel_axis", lambda o, rearward, up: arctan2(-up, hypot(o, rearward))),
    "toe_by_arcsine": _of_line("wheel_axis", _toe_by_arcsine),
    "toe_change_by_arcsine": toe_change_by_arcsine,
}


def _level_with(axis: Dual, point: Dual) -> Dual:
    """Vector to a point from the axis at the same height; `point` counts from any point of the axis."""
    return point - axis * (point[UP] / axis[UP])


def _at_ground(motion: Motion, axis: Dual, centre: Dual) -> Dual:
    return _level_with(axis, centre + motion.components(contact(motion)))


def mechanical_trail(motion: Motion, axis: Dual, centre: Dual) -> Dual:
    """From the contact point to the axis at the ground, along the tyre's own forward direction."""
    outboard, rearward, _ = _at_ground(motion, axis, centre)
    spin_outboard, spin_rearward, _ = _along(motion, "wheel_axis")
    return (rearward * spin_outboard - outboard * spin_rearward) / hypot(spin_outboard, spin_rearward)


AXIS_LENGTHS: Mapping[str, OfAxis] = {
    "kingpin_offset": lambda *of: _at_ground(*of)[OUTBOARD],
    # Never negative.
    "scrub_radius": lambda *of: hypot(_at_ground(*of)[OUTBOARD], _at_ground(*of)[REARWARD]),
    "mechanical_trail": mechanical_trail,
    "castor_offset": lambda *of: _at_ground(*of)[REARWARD],
    "kingpin_offset_at_wheel": lambda motion, *of: _level_with(*of)[OUTBOARD],
    "hub_trail": lambda motion, *of: -_level_with(*of)[REARWARD],
}


def _of_steering(number: OfAxis) -> Number:
    """A number of the steering axis."""

    def of(motion: Motion) -> Dual:
        lower, _ = motion.corner.ends("steering_axis")
        centre = motion.components(motion.line(lower, _centre(motion)))
        return number(motion, _along(motion, "steering_axis"), centre)

    return of


def travel(motion: Motion) -> Dual:
    """Displacement of the wheel centre along up in the chassis' frame."""
    return motion.components(motion.in_the_car.moved(_centre(motion)))[UP]


LENGTHS: Mapping[str, Number] = {
    "travel": travel,
    "contact_travel": lambda motion: _contact_moved(motion.in_the_car)[UP],
    "half_track_change": lambda motion: _contact_moved(motion)[OUTBOARD],
    "recession": lambda motion: _contact_moved(motion)[REARWARD],
    **{name: _of_steering(number) for name, number in AXIS_LENGTHS.items()},
    "damper_length": lambda motion: hypot(*motion.line(*motion.corner.ends("damper"))),
}


def _slope(motion: Motion, number: Dual, by: str) -> Array:
    return number.slopes[..., -1 if by == TIME else motion.by.index((motion.part, by))]


def _ratio(rise: Array | float, run: Array) -> Array:
    """The quotient; NaN where run is zero."""
    return np.where(run == 0.0, np.nan, rise / run)


def _rising(velocity: Array) -> Array:
    """The upward component of a velocity, from components (3, N); zero where it may be rounding."""
    up = velocity[UP]
    return np.where(np.abs(up) <= LEAST * np.linalg.norm(velocity, axis=0), 0.0, up)


def _travelled(motion: Motion) -> Array:
    """Upward velocity of the wheel centre in the chassis' frame, per unit of the wheel's input, (N,)."""
    return _rising(_centre_velocity(motion.in_the_car))


def _spin(motion: Motion, by: str) -> Array:
    """Angular velocity w of the knuckle, (3, N)."""
    return motion.spin(motion.corner.carrier)[..., motion.by.index((motion.part, by))]


def _contact_velocity(motion: Motion) -> Array:
    """Components of the contact point's velocity v, (3, N)."""
    velocity = motion.moved(_centre(motion)) + motion.riding(motion.corner.carrier, contact(motion))
    return _slope(motion, motion.components(velocity), "travel")


def _over_the_contact(motion: Motion, velocity: Array) -> Array:
    """Height above the contact point where the normal to a velocity meets the middle plane, in the front
    view.

    The middle plane goes through the origin. NaN where the velocity is level.
    """
    return np.asarray(_contact_place(motion)[OUTBOARD] * _ratio(velocity[OUTBOARD], _rising(velocity)))


def arm_roll_centre_height(motion: Motion) -> Array:
    """Roll centre height by the arms: the knuckle also turns about its steering axis so that its motion is a
    pure rotation.

    With u the velocity of the axis' lower point and w the angular velocity of the knuckle, (w + f k) . u = 0.
    NaN where u is normal to the axis k, or zero.
    """
    (lower, upper), centre = motion.corner.ends("steering_axis"), _centre(motion)
    k, to_centre = motion.line(lower, upper).value, motion.line(lower, centre)
    # The lower point moves with the wheel centre, minus the rotation of the arm from there.
    moving = motion.moved(centre) - motion.riding(motion.corner.carrier, to_centre)
    u, w = _slope(motion, moving, "travel"), _spin(motion, "travel")
    arm = to_centre.value + contact(motion).value
    speed, turning, far = (np.linalg.norm(vector, axis=0) for vector in (u, w, arm))
    along = np.where(speed <= LEAST * turning * far, 0.0, (k * u).sum(axis=0))
    turn = w - k * _ratio((w * u).sum(axis=0), along)
    return _over_the_contact(motion, motion.corner.axes @ (u + np.cross(turn, arm, axis=0)))


def instant_centre(h: int, component: int, sense: float = 1.0) -> Values:
    """Distance of the instant centre in the plane of h and up from c, along h or up; NaN at infinity."""

    def of(motion: Motion) -> Array:
        velocity, axes = _contact_velocity(motion), motion.corner.axes
        turn = np.cross(axes[h], axes[UP]) @ _spin(motion, "travel")
        far = np.abs(velocity[UP]) > FARTHEST * motion.corner.radius * np.abs(turn)
        turn = np.where(far, 0.0, turn)
        return sense * (_ratio(velocity[h], turn) if component == UP else -_ratio(velocity[UP], turn))

    return of


def _centre_velocity(motion: Motion) -> Array:
    """Components of the wheel centre's velocity with travel, (3, N)."""
    return _slope(motion, motion.components(motion.moved(_centre(motion))), "travel")


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
        sign, wheelbase, drawn_height, part = motion.corner.numbers(*names)
        height = drawn_height - LENGTHS["contact_travel"](motion).value
        velocity = velocity_of(motion)
        ratio = _ratio(velocity[REARWARD] * wheelbase, _rising(velocity) * height)
        return np.asarray(100.0 * part * sign * ratio)

    return of


def damper_per_wheel(motion: Motion) -> Array:
    """Shortening of the damper per mm of travel; NaN where the wheel does not travel."""
    return -_ratio(_slope(motion, LENGTHS["damper_length"](motion), "travel"), _travelled(motion))


def wheel_per_damper(motion: Motion) -> Array:
    """Travel per mm that the damper is shortened; NaN where its length does not change."""
    line = _slope(motion, motion.line(*motion.corner.ends("damper")), "travel")
    grown = _slope(motion, LENGTHS["damper_length"](motion), "travel")
    grown = np.where(np.abs(grown) <= LEAST * np.linalg.norm(line, axis=0), 0.0, grown)
    return -_ratio(_slope(motion, travel(motion), "travel"), grown)


def spring_force(motion: Motion) -> Array:
    """Rate times the shortening from the free length, N; positive where the spring pushes its ends apart."""
    rate, free = motion.corner.numbers("spring_rate", "spring_free_length")
    return np.asarray(rate * (free - LENGTHS["damper_length"](motion).value))


def wheel_rate(motion: Motion) -> Array:
    """The wheel rate for a constant motion ratio, N/mm."""
    rate, _ = motion.corner.numbers("spring_rate", "spring_free_length")
    return np.asarray(rate * damper_per_wheel(motion) ** 2)


def _screw(motion: Motion) -> tuple[Array, Array]:
    """Angular velocity of the knuckle and velocity of the wheel centre with the rack, (3, N); NaN where the
    knuckle does not turn as the rack moves, or about a level line only."""
    w, v = _spin(motion, "rack"), _slope(motion, motion.moved(_centre(motion)), "rack")
    turns = np.abs(motion.corner.axes[UP] @ w) * motion.corner.radius > LEAST
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
        square = (w * w).sum(axis=0)
        axis, off = (motion.corner.axes @ of for of in (w, np.cross(v, w, axis=0) / square))
        return number(motion, constant(axis * np.sign(axis[UP])), constant(off)).value

    return of


OF_RACK: Mapping[str, tuple[str, Values]] = {
    "screw_kingpin": ("rad", _of_screw(lambda motion, axis, centre: _kingpin(*axis))),
    "screw_caster": ("rad", _of_screw(lambda motion, axis, centre: _caster(*axis))),
    **{f"screw_{name}": ("mm", _of_screw(number)) for name, number in AXIS_LENGTHS.items()},
    "screw_pitch": ("mm/rad", screw_pitch),
}
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


def _values(number: Number, by: str) -> Values:
    """A number, or its derivative: per mm of travel, per mm of the slide or per rad of roll while all else is
    held; or per second, while everything moves."""

    def of(motion: Motion) -> Array:
        found = number(motion)
        if not by:
            return found.value
        slope = _slope(motion, found, by)
        return _ratio(slope, _travelled(motion)) if by == "travel" else slope

    return of


def _with_gradients(unit: str, numbers: Mapping[str, Number]) -> dict[str, Effect]:
    ways = [("", "", unit), *((f"_by_{by}", by, f"{unit}/{per}") for by, per in GRADIENTS.items())]
    return {
        name + suffix: Effect(per, _values(number, by), by)
        for name, number in numbers.items()
        for suffix, by, per in ways
    }


def _drawn_apart(left: Motion, right: Motion) -> Array:
    """Components at the right wheel of the vector from the left to the right drawn wheel centre, (3, 1)."""
    return right.components(right.drawn(_centre(right)) - left.drawn(_centre(left))).value


def _apart(left: Motion, right: Motion) -> Array:
    """Components along right and up of the vector from the left to the right contact point, (2, N).

    The drawn places are subtracted first, since places far from the origin have fewer digits.
    """
    drawn = _drawn_apart(left, right)
    one, other = (of.components(of.moved(_centre(of)) + contact(of)).value for of in (left, right))
    return np.array([drawn[OUTBOARD] + one[OUTBOARD] + other[OUTBOARD], drawn[UP] - one[UP] + other[UP]])


def _front_view(motion: Motion) -> tuple[Array, Array]:
    """The contact point and its velocity with travel, along right and up, (2, N) each; the velocity is zero
    where it may be rounding."""
    velocity, size = _contact_velocity(motion), motion.mechanism.drawing.size
    out = np.array([[1.0 if motion.corner.side == "right" else -1.0], [1.0]])
    place, seen = (out * of[[OUTBOARD, UP]] for of in (_contact_place(motion), velocity))
    speed = size * np.linalg.norm(_spin(motion, "travel"), axis=0) + np.linalg.norm(velocity, axis=0)
    return place, np.where(np.hypot(*seen) <= ROUNDING * speed, 0.0, seen)


def _axle_roll_centre(left: Motion, right: Motion) -> tuple[Array, Array]:
    """Intersection of the normals of both contact points in the front view, offset and height, (N,) each.

    With c, d the contact points and v, w their velocities, it is c + x with v . x = 0 and
    w . x = w . (d - c). NaN where the normals are parallel or a velocity is zero.
    """
    (c, v), (_, w) = _front_view(left), _front_view(right)
    turn, apart = v[0] * w[1] - v[1] * w[0], _apart(left, right)
    speeds = np.hypot(*v) * np.hypot(*w)
    turn = np.where(np.abs(turn) <= ROUNDING * speeds, 0.0, turn)
    x = _ratio((w * apart).sum(axis=0), turn) * np.array([-v[1], v[0]])
    return c[0] + x[0], x[1] - x[0] * apart[1] / apart[0]


def _steered(left: Motion, right: Motion) -> tuple[Array, Array, float, Array]:
    """Steer angles of the inner and the outer wheel, NaN unless both are steered to one side; the wheelbase,
    and the track as drawn.
    """
    (wheelbase,) = left.corner.numbers("wheelbase")
    one, other = (steer_angle(of).value for of in (left, right))
    sizes = np.where(one * other > 0.0, np.abs((one, other)), np.nan)
    inner, outer = np.where(one > 0.0, sizes, sizes[::-1])
    width = _drawn_apart(left, right)[OUTBOARD]
    for wheel in (left, right):
        width = width + wheel.components(contact(wheel, drawn=True))[OUTBOARD].value
    return inner, outer, wheelbase, np.asarray(width)


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
    **_with_gradients("rad", ANGLES),
    **_with_gradients("mm", LENGTHS),
    **{name: Effect(unit, value, "travel") for name, (unit, value) in OF_VELOCITIES.items()},
    **{name: Effect(unit, value, "rack") for name, (unit, value) in OF_RACK.items()},
}
# The axle's roll centre height is measured along up from the line through both contact points, its offset
# along right from the middle plane, which goes through the origin. The track is the distance of both contact
# points along right.
AXLE_EFFECTS: Mapping[str, Effect] = {
    "track": Effect("mm", lambda *wheels: _apart(*wheels)[0]),
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


def effects_of(names: Sequence[str], model: Model) -> dict[str, Asked]:
    """The effects with these names.

    Raises:
        InputError: an effect does not exist; the message names all that do.
    """
    known = effects_in(model) if names else {}
    for name in names:
        if name not in known:
            raise InputError(f"there is no effect {name!r}; it must be one of {list(known)}", name, name)
    return {name: known[name] for name in names}


def inputs_of(effects: Mapping[str, Asked], model: Model) -> dict[tuple[str, str], str]:
    """(part, "travel", "rack" or "roll") -> the value of the input by which effects take derivatives.

    Raises:
        DescriptionError: there is not exactly one such input.
    """
    return {
        (part, asked.effect.by): model.input_of(part, asked.effect.by, f"effect {name!r}")
        for name, asked in effects.items()
        for part in asked.parts
        if asked.effect.by not in ("", TIME)
    }


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
