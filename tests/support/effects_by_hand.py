"""Every number of a wheel on the arm of `one_arm`, by the words of its definition and in 50 digits.

Nothing of a model is used: places are closed forms, and what changes by an input or in time is a difference
of two poses. Whoever adds an effect adds its numbers here; a test finds them missing.
"""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from many_digits import Array, size, unit, vector
from mpmath import acos, asin, mp, mpc, mpf, pi
from one_arm import CAR, DRAWN, RADIUS, place

DIGITS = 50
STEP = mpf(10) ** -16  # of central differences: what they leave out is its square
UP, OUT, FORWARD, REARWARD = (vector(v) for v in ((0, 0, 1), (0, -1, 0), (-1, 0, 0), (1, 0, 0)))
START = vector(DRAWN["centre"])
Values = Mapping[str, Any]
Numbers = dict[str, Any]


def angle(along: Any, across: Any) -> Any:
    return mp.arg(mpc(along, across))


def contact_of(inner: Array, centre: Array) -> Array:
    """The point of a thin disc about the spin axis that lies farthest down."""
    spin = unit(centre - inner)
    return centre - RADIUS * unit(UP - spin * (spin @ UP))


def of_places(values: Values) -> Numbers:
    """Numbers that are made of where points are."""
    inner, centre, lower, upper, top, foot = (
        place(n, values) for n in ("inner", "centre", "lower", "upper", "damper_top", "damper_foot")
    )
    in_chassis = place("centre", values, ())
    spin, kingpin, contact = unit(centre - inner), upper - lower, contact_of(inner, centre)
    drawn_inner = vector(DRAWN["inner"])
    stood, drawn_spin = contact_of(drawn_inner, START), unit(START - drawn_inner)
    moved, travelled = contact - stood, contact_of(place("inner", values, ()), in_chassis) - stood

    def beside(there: Array) -> Array:
        """From the steering axis to a place as high as its point."""
        return there - lower - kingpin * ((there - lower) @ UP) / (kingpin @ UP)

    ground, hub = beside(contact), beside(centre)
    # Level, at right angles to the spin axis, and forward where that points outboard.
    ahead = unit(np.cross(UP, spin)) * (1 if np.cross(UP, OUT) @ FORWARD > 0 else -1)
    return {
        # A wheel that leans out at the top has a spin axis that falls on its way outboard.
        "camber": -angle(spin @ OUT, spin @ UP),
        "kingpin": -angle(kingpin @ UP, kingpin @ OUT),
        # A wheel whose front edge is nearer the middle has a spin axis that goes forward on its way out.
        "toe": angle(spin @ OUT, spin @ FORWARD),
        # Where the outward end of the spin axis goes as the wheel is turned to the left about up.
        "steer_angle": angle(spin @ OUT, spin @ np.cross(UP, OUT)),
        # A steering axis that leans rearward at the top goes rearward on its way up.
        "caster": angle(kingpin @ UP, kingpin @ REARWARD),
        "camber_by_arcsine": -asin(spin @ UP),
        "toe_by_arcsine": asin(spin @ FORWARD),
        "toe_change_by_arcsine": (pi / 2 - acos(spin @ FORWARD)) - (pi / 2 - acos(drawn_spin @ FORWARD)),
        "travel": (in_chassis - START) @ UP,
        "contact_travel": travelled @ UP,
        "half_track_change": moved @ OUT,
        "recession": moved @ REARWARD,
        "kingpin_offset": ground @ OUT,
        "scrub_radius": size(ground),
        "mechanical_trail": -(ground @ ahead),
        "castor_offset": ground @ REARWARD,
        "kingpin_offset_at_wheel": hub @ OUT,
        "hub_trail": -(hub @ REARWARD),
        "damper_length": size(foot - top),
    }


def slopes(of: Callable[[Any], Numbers], at: Any) -> Numbers:
    """What numbers change by."""
    ahead, behind = of(at + STEP), of(at - STEP)
    return {name: (ahead[name] - behind[name]) / (2 * STEP) for name in ahead}


def of_a_motion(values: Values, here: Numbers, by_turn: Numbers) -> Numbers:
    """Numbers that are made of how the arm moves as it turns."""
    inner, centre, lower, upper = (place(n, values) for n in ("inner", "centre", "lower", "upper"))
    hinge, contact = unit(place("pivot_end", values) - place("pivot", values)), contact_of(inner, centre)
    moving = slopes(lambda turn: {"way": place("centre", {**values, "turn": turn})}, values["turn"])["way"]

    def going(there: Array) -> Array:
        """How the point of the arm that is at a place moves."""
        return moving + np.cross(hinge, there - centre)

    def rising(way: Array) -> Any:
        """How high over the ground the normal of the contact point's way meets the middle plane."""
        return (contact @ OUT) * (way @ OUT) / (way @ UP)

    def instant_centre(level: Array) -> tuple[Any, Any]:
        """On the normals of the ways of the contact point and of one 100 above it, in a plane of up."""
        (a, b), (c, d) = ((way @ level, way @ UP) for way in (going(contact), going(contact + 100 * UP)))
        # a x + b y = 0 and c x + d (y - 100) = 0
        return -b * d * 100 / (a * d - b * c), a * d * 100 / (a * d - b * c)

    # The planes of the arms, through the ball joints and square to their ways, meet in a line. About it the
    # contact point turns, if both ball joints do.
    one, two = going(lower), going(upper)
    along = np.cross(one, two)
    rows = mp.matrix([[*one], [*two], [*along]])
    middle = np.array(mp.lu_solve(rows, mp.matrix([one @ lower, two @ upper, mpf(0)])).T.tolist()[0])
    (outward, front), (rearward, side) = instant_centre(OUT), instant_centre(REARWARD)
    lever = CAR["wheelbase"] / (CAR["centre_of_gravity_height"] - here["contact_travel"])
    steep = [(way @ REARWARD) / (way @ UP) for way in (going(contact), going(centre))]
    ratio = -by_turn["damper_length"] / by_turn["travel"]
    force = CAR["spring_rate"] * (CAR["spring_free_length"] - here["damper_length"])
    return {
        "roll_centre_height": rising(going(contact)),
        "arm_roll_centre_height": rising(np.cross(along, contact - middle)),
        "front_view_swing_arm": -outward,
        "front_view_centre_height": front,
        "side_view_swing_arm": rearward,
        "side_view_centre_height": side,
        # Of a front axle.
        "anti_brake": -100 * mpf(CAR["brake_share"]) * steep[0] * lever,
        "anti_drive": -100 * mpf(CAR["drive_share"]) * steep[1] * lever,
        "damper_per_wheel": ratio,
        "wheel_per_damper": 1 / ratio,
        "spring_force": force,
        "wheel_force": force * ratio,
        "wheel_rate": CAR["spring_rate"] * ratio**2,
    }


def numbers(given: Mapping[str, list[float]], time: float) -> Numbers:
    """All of them, the inputs being polynomials of time, rad and mm."""

    def law(t: Any) -> dict[str, Any]:
        return {n: sum(mpf(c) * t**k for k, c in enumerate(terms)) for n, terms in given.items()}

    with mp.workdps(DIGITS):
        values = law(mpf(time))
        here = of_places(values)
        by = {
            name: slopes(lambda x, name=name: of_places({**values, name: x}), values[name])
            for name in ("turn", "steer", "roll")
        }
        travel = by["turn"]["travel"]
        ways = {"travel": {n: slope / travel for n, slope in by["turn"].items()}, "rack": by["steer"]}
        ways |= {"roll": by["roll"], "time": slopes(lambda t: of_places(law(t)), mpf(time))}
        gradients = {f"{n}_by_{way}": slope for way, of in ways.items() for n, slope in of.items()}
        return here | gradients | of_a_motion(values, here, by["turn"])
