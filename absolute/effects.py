"""Effects: numbers of the car that a solved motion has at each instant, by name.

A number is written once, as a function of points. Its derivatives by inputs come of the same function (see
`Dual`). With a from the inner point of the spin axis to the wheel centre W, and k from the lower to the upper
point of the steering axis, the contact point of a wheel of radius r is the lowest of a thin disc,

    c = W - r unit(up - (up . n) n),    n = a / |a|,

and is measured against the point of the line along k that is as high. To add a number, add its function to
`ANGLES` or to `LENGTHS`.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from absolute.description import Model
from absolute.dual import Dual, arctan2, constant, hypot
from absolute.errors import DescriptionError, InputError
from absolute.results import Motion
from absolute.solution import Array

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
    centre, contact = _centre(motion), _contact(motion)
    velocity = motion.components(motion.moved(centre) + motion.riding(centre, contact))
    place = motion.components(motion.drawn(centre) + motion.moved(centre) + contact)
    return place[0].value * _ratio(*(_slope(motion, velocity[along], "travel") for along in (0, 2)))


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
    yield "roll_centre_height", Effect("mm", roll_centre_height, "travel")


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
