"""Effects: numbers of the car that a solved motion has at each instant, by name.

A number is written once, as a function of points. Its derivatives by inputs come of the same function (see
`Dual`). With a from the inner point of the spin axis to the wheel centre W, and k from the lower to the upper
point of the steering axis, the contact point of a wheel of radius r is the lowest of a thin disc,

    c = W - r unit(up - (up . n) n),    n = a / |a|,

and is measured against the point of the line along k that is as high.

Where travel changes, c as a point of the knuckle has a velocity v, and the knuckle an angular velocity w. In
the plane of a horizontal h and up through c, its points move about the instant centre

    c - (v . up / w . a) h + (v . h / w . a) up,    a = h x up.

To add a number, add its function to `ANGLES` or to `LENGTHS`; one of velocities, which has no gradients, to
`OF_VELOCITIES`.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from absolute.car import needed
from absolute.description import Model
from absolute.dual import Dual, arctan2, constant, hypot
from absolute.errors import DescriptionError, InputError
from absolute.newton import SMALLEST_RCOND
from absolute.results import Motion
from absolute.solution import Array
from absolute.vectors import EPS

Number = Callable[[Motion], Dual]


def camber(motion: Motion) -> Dual:
    """Spin axis against outboard, seen from the front: + where the wheel leans out at its top (eq. 17)."""
    outboard, _, up = _along(motion, "wheel_axis")
    return arctan2(-up, outboard)


def toe(motion: Motion) -> Dual:
    """Spin axis against outboard, seen from above: + where the wheel's front edge is turned in."""
    outboard, rearward, _ = _along(motion, "wheel_axis")
    return arctan2(-rearward, outboard)


def kingpin(motion: Motion) -> Dual:
    """Steering axis against up, seen from the front: + where it leans in at its top (eq. 16)."""
    outboard, _, up = _along(motion, "steering_axis")
    return arctan2(-outboard, up)


def caster(motion: Motion) -> Dual:
    """Steering axis against up, seen from the side: + where it leans rearward at its top."""
    _, rearward, up = _along(motion, "steering_axis")
    return arctan2(rearward, up)


def travel(motion: Motion) -> Dual:
    """How far the wheel centre has gone up in the chassis' frame."""
    still = replace(motion, turns=())
    return still.components(still.moved(_centre(still)))[2]


def contact_travel(motion: Motion) -> Dual:
    """How far the contact point has gone up in the chassis' frame, of a disc that hangs along its up."""
    return _contact_moved(replace(motion, turns=()))[2]


def half_track_change(motion: Motion) -> Dual:
    """How far the contact point has gone outboard."""
    return _contact_moved(motion)[0]


def recession(motion: Motion) -> Dual:
    """How far the contact point has gone rearward."""
    return _contact_moved(motion)[1]


def kingpin_offset(motion: Motion) -> Dual:
    """Contact point from the steering axis at the ground, outboard (ISO 8855, 7.2.6, along the car's y)."""
    return _off_axis(motion, _contact(motion))[0]


def scrub_radius(motion: Motion) -> Dual:
    """Distance of contact point and steering axis at the ground (ISO 8855, 7.2.10), never negative."""
    outboard, rearward, _ = _off_axis(motion, _contact(motion))
    return hypot(outboard, rearward)


def mechanical_trail(motion: Motion) -> Dual:
    """Steering axis at the ground from the contact point, along the tyre's own forward (ISO 8855, 7.2.3)."""
    outboard, rearward, _ = _off_axis(motion, _contact(motion))
    spin_outboard, spin_rearward, _ = _along(motion, "wheel_axis")
    return (rearward * spin_outboard - outboard * spin_rearward) / hypot(spin_outboard, spin_rearward)


def castor_offset(motion: Motion) -> Dual:
    """Steering axis at the ground from the contact point, along the car's forward."""
    return _off_axis(motion, _contact(motion))[1]


def kingpin_offset_at_wheel(motion: Motion) -> Dual:
    """Wheel centre from the steering axis at its height, outboard."""
    return _off_axis(motion)[0]


def hub_trail(motion: Motion) -> Dual:
    """Steering axis from the wheel centre at its height, rearward."""
    return -_off_axis(motion)[1]


def damper_length(motion: Motion) -> Dual:
    """Distance of the damper's two ends."""
    return hypot(*motion.line(*motion.corner.ends("damper")))


def roll_centre_height(motion: Motion) -> Array:
    """Height above the contact point at which its normal meets the car's middle plane, front view.

    The normal is at a right angle to the velocity of the contact point, as one of the knuckle, where travel
    changes; the plane goes through the origin. Not a number where that velocity is level.
    """
    centre, (outboard, _, up) = _centre(motion), _contact_velocity(motion)
    place = motion.components(motion.drawn(centre) + motion.moved(centre) + _contact(motion))
    return place[0].value * _ratio(outboard, up)


def front_view_swing_arm(motion: Motion) -> Array:
    """How far inboard of the contact point the instant centre is, front view. Not a number at infinity."""
    return -_instant_centre(motion, 0)[0]


def front_view_centre_height(motion: Motion) -> Array:
    """How far above the contact point the instant centre is, front view. Not a number at infinity."""
    return _instant_centre(motion, 0)[1]


def side_view_swing_arm(motion: Motion) -> Array:
    """How far rearward of the contact point the instant centre is, side view. Not a number at infinity."""
    return _instant_centre(motion, 1)[0]


def side_view_centre_height(motion: Motion) -> Array:
    """How far above the contact point the instant centre is, side view. Not a number at infinity."""
    return _instant_centre(motion, 1)[1]


def anti_brake(motion: Motion) -> Array:
    """How much of the load transfer of braking the linkage carries, %: anti-dive, at the rear anti-lift.

    The brake holds the contact point in the knuckle. Not a number where that does not rise with travel.
    """
    return _anti(motion, _contact_velocity(motion), "brake_share")


def anti_drive(motion: Motion) -> Array:
    """How much of the load transfer of driving the linkage carries, %: anti-squat, at the front anti-lift.

    A shaft from the chassis turns the wheel in the knuckle, so that the knuckle takes the force at the wheel
    centre. Not a number where that does not rise with travel.
    """
    velocity = motion.components(motion.moved(_centre(motion)))
    return _anti(motion, _slope(motion, velocity, "travel"), "drive_share")


ANGLES: tuple[Number, ...] = camber, kingpin, toe, caster
LENGTHS: tuple[Number, ...] = (
    travel,
    contact_travel,
    half_track_change,
    recession,
    kingpin_offset,
    scrub_radius,
    mechanical_trail,
    castor_offset,
    kingpin_offset_at_wheel,
    hub_trail,
    damper_length,
)
OF_VELOCITIES: Mapping[Callable[[Motion], Array], str] = {
    roll_centre_height: "mm",
    front_view_swing_arm: "mm",
    front_view_centre_height: "mm",
    side_view_swing_arm: "mm",
    side_view_centre_height: "mm",
    anti_brake: "%",
    anti_drive: "%",
}


@dataclass(frozen=True)
class Effect:
    """A number at each instant.

    Attributes:
        unit: of the value.
        value: (N,) at the instants of a solved motion.
        by: the input that it takes derivatives by: "rack", the one that is the travel of a slide, "travel",
            the one that is not, or "" for none.
    """

    unit: str
    value: Callable[[Motion], Array]
    by: str = ""


def _effects() -> Iterator[tuple[str, Effect]]:
    for unit, numbers in (("rad", ANGLES), ("mm", LENGTHS)):
        for number in numbers:
            name = number.__name__
            yield name, Effect(unit, _value(number))
            yield f"{name}_by_travel", Effect(f"{unit}/mm", _by_travel(number), "travel")
            yield f"{name}_by_rack", Effect(f"{unit}/mm", _by_rack(number), "rack")
    for along, unit in OF_VELOCITIES.items():
        yield along.__name__, Effect(unit, along, "travel")


def _value(number: Number) -> Callable[[Motion], Array]:
    return lambda motion: number(motion).value


def _by_travel(number: Number) -> Callable[[Motion], Array]:
    """Its change for each mm of travel, all other inputs and the chassis held."""
    return lambda motion: _ratio(*(_slope(motion, of(motion), "travel") for of in (number, travel)))


def _by_rack(number: Number) -> Callable[[Motion], Array]:
    """Its change for each mm of the slide, all other inputs and the chassis held."""
    return lambda motion: _slope(motion, number(motion), "rack")


def _slope(motion: Motion, number: Dual, by: str) -> Array:
    return number.slopes[..., motion.by.index(by)]


def _ratio(rise: Array, run: Array) -> Array:
    """Not a number where run is zero."""
    return np.where(run == 0.0, np.nan, rise / run)


def _along(motion: Motion, role: str) -> Dual:
    """The line of a role along outboard, rearward and up, (3, N)."""
    return motion.components(motion.line(*motion.corner.ends(role)))


def _centre(motion: Motion) -> str:
    return motion.corner.ends("wheel_axis")[1]


def _contact(motion: Motion, drawn: bool = False) -> Dual:
    """From the wheel centre to the contact point, (3, N)."""
    inner, centre = motion.corner.ends("wheel_axis")
    spin = motion.drawn(centre) - motion.drawn(inner) if drawn else motion.line(inner, centre)
    normal = spin / hypot(*spin)
    up = constant(np.array(motion.corner.up)[:, None])
    down = normal * motion.components(normal)[2] - up
    return down * (constant(motion.corner.radius) / hypot(*down))


def _contact_moved(motion: Motion) -> Dual:
    """From the drawn contact point to the contact point, along outboard, rearward and up, (3, N)."""
    return motion.components(
        motion.moved(_centre(motion)) + (_contact(motion) - _contact(motion, drawn=True))
    )


def _contact_velocity(motion: Motion) -> Array:
    """v along outboard, rearward and up, (3, N)."""
    centre = _centre(motion)
    velocity = motion.moved(centre) + motion.riding(centre, _contact(motion))
    return _slope(motion, motion.components(velocity), "travel")


def _instant_centre(motion: Motion, along: int) -> tuple[Array, Array]:
    """From the contact point along h, which is outboard (0) or rearward (1), and up, (N,) each."""
    velocity, spin = _contact_velocity(motion), motion.spin(_centre(motion))[..., motion.by.index("travel")]
    axes = motion.corner.axes
    turn = np.cross(axes[along], axes[2]) @ spin
    # Of a velocity, so much may be rounding at the largest condition number that is not refused.
    rounding = EPS / SMALLEST_RCOND
    speed = np.linalg.norm(spin, axis=0) + np.linalg.norm(velocity, axis=0) / motion.mechanism.drawing.size
    turn = np.where(np.abs(turn) <= rounding * speed, 0.0, turn)
    return -_ratio(velocity[2], turn), _ratio(velocity[along], turn)


def _anti(motion: Motion, velocity: Array, share: str) -> Array:
    """100 share s (v . rearward / v . up) wheelbase / (height of the centre of gravity - contact travel) with
    s = -1 at the front and 1 at the rear, (N,)."""
    names = ("axle", "wheelbase", "centre_of_gravity_height", share)
    sign, wheelbase, drawn_height, part = needed(motion.corner.car, *names)
    height = drawn_height - contact_travel(motion).value
    return 100.0 * part * sign * _ratio(velocity[1] * wheelbase, velocity[2] * height)


def _off_axis(motion: Motion, beside: Dual | None = None) -> Dual:
    """To the wheel centre, or a point beside it, from the point of the steering axis that is as high: along
    outboard, rearward and up, (3, N)."""
    lower, _ = motion.corner.ends("steering_axis")
    point = motion.line(lower, _centre(motion))
    point = motion.components(point if beside is None else point + beside)
    axis = _along(motion, "steering_axis")
    return point - axis * (point[2] / axis[2])


EFFECTS: Mapping[str, Effect] = dict(_effects())


def effects_of(names: Sequence[str]) -> dict[str, Effect]:
    """The effects of some names.

    Raises:
        InputError: there is no such effect; it names those there are.
    """
    for name in names:
        if name not in EFFECTS:
            raise InputError(
                f"there is no effect {name!r}; it must be one of {list(EFFECTS)}", name, None, name
            )
    return {name: EFFECTS[name] for name in names}


def inputs_of(effects: Mapping[str, Effect], model: Model) -> dict[str, str]:
    """ "travel", "rack" -> the value of the input that effects take their derivatives by, where they do.

    Raises:
        DescriptionError: there is not exactly one such input.
    """
    inputs: dict[str, str] = {}
    for name, effect in effects.items():
        if not effect.by:
            continue
        found = [value for value in model.values if (value in model.steering) == (effect.by == "rack")]
        if len(found) != 1:
            kind = "is the travel of a slide" if effect.by == "rack" else "is not the travel of a slide"
            raise DescriptionError(
                f"effect {name!r} needs exactly one driven input that {kind}, and there are {len(found)}: "
                f"{found} of {list(model.values)}; drive other inputs, or ask for other effects",
                name,
                found,
            )
        inputs[effect.by] = found[0]
    return inputs


def numbers_of(effects: Mapping[str, Effect], motion: Motion) -> dict[str, Array]:
    """name -> (N,) of a motion.

    Raises:
        DescriptionError: the mechanism lacks a role or a wheel's radius that one needs.
    """
    numbers: dict[str, Array] = {}
    for name, effect in effects.items():
        try:
            with np.errstate(all="ignore"):
                numbers[name] = effect.value(motion)
        except DescriptionError as error:
            raise DescriptionError(f"effect {name!r} {error}", error.name) from None
    return numbers
