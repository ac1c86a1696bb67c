"""Points that nearly coincide or nearly lie in line, in a car that moves.

Links between such points lose digits when coordinates are subtracted, and directions through them turn by
rounding. The cars are drawn assembled, so that nothing but the two points is out of the ordinary.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache, partial

import numpy as np
from numpy.typing import NDArray

from validate.cars.car import Car, unit
from validate.hard.cars import CARS, drawn_angle, drawn_at, scene_content
from validate.hard.case import Case, Expected, decades
from validate.hard.family import NAMED, SOLVERS, Content
from validate.hard.trial import scene_case

Array = NDArray[np.float64]
Points = Mapping[str, Array]

GROUP = "Points nearly in line or nearly coincident"
RIGHT_FROM = 1e-2  # a millimetre or so, as there may be in a car: it must be solved
SOLVED = Expected(("right", "refused"), right_from=RIGHT_FROM)
SLOW = decades()[::3]  # a refusal takes half a second here
BALL, OUTER, INNER = "lower_ball_joint", "tie_rod_outer", "tie_rod_inner"
FRONT, REAR, LOWER = "lower_arm_front", "lower_arm_rear", "strut_lower"
UPPER_BALL, UPPER_FRONT, UPPER_REAR = "upper_ball_joint", "upper_arm_front", "upper_arm_rear"


@cache
def assembled(car: str = "paper") -> dict[str, Array]:
    """A car at its own inputs, each coordinate the nearest number to the true one, mm."""
    if CARS[car].closure == "drawn":
        return CARS[car].array
    return drawn_at(CARS[car], NAMED[car].drawn).array


def thin_knuckle(value: float, car: str = "paper", upper: str = "strut_lower") -> Points:
    """The tie rod's outer end nearly on the line through the knuckle's other two points."""
    p = assembled(car)
    line = unit(p[upper] - p[BALL])
    foot = p[BALL] + ((p[OUTER] - p[BALL]) @ line) * line
    return {**p, OUTER: foot + value * (p[OUTER] - foot)}


def flat_upper_arm(value: float) -> Points:
    """The upper ball joint near the plane of the upper pivots and the lower ball joint."""
    p = assembled("wishbone")
    normal = unit(np.cross(p[UPPER_REAR] - p[UPPER_FRONT], p[BALL] - p[UPPER_FRONT]))
    height = float((p[UPPER_BALL] - p[UPPER_FRONT]) @ normal)
    return {**p, UPPER_BALL: p[UPPER_BALL] - (1.0 - value) * height * normal}


def nearer(moved: str, onto: str, car: str = "paper") -> Callable[[float], Points]:
    """A point that comes near another along the line between them."""

    def points(value: float) -> Points:
        p = assembled(car)
        return {**p, moved: p[onto] + value * (p[moved] - p[onto])}

    return points


def short_tie_rod(value: float, car: str = "paper") -> Points:
    """The rack's end comes near the tie rod's outer end."""
    p = assembled(car)
    inner = p[OUTER] + value * (p[INNER] - p[OUTER])
    return {**p, INNER: inner, "rack_centre": inner}


def motion_from(angle: float, car: Car, arm: tuple[float, ...], rack: tuple[float, ...]) -> Content:
    """A motion of one second from an arm angle and no rack travel; rates in rad and mm over s, and half
    accelerations.
    """
    return scene_content(car, (angle, *arm), (0.0, *rack), stop=1.0)


def _content(points: Callable[[float], Points], shrinking: bool, car: str, value: float) -> Content:
    """By 0.1 rad and 20 mm in a second, with accelerations as large."""
    # A short link follows no more than its own length: its inputs shrink with it.
    share = value if shrinking else 1.0
    there = CARS[car].drawn_as(points(value))
    angle = NAMED[car].drawn["arm_angle"] if car == "paper" else drawn_angle(there)
    return motion_from(angle, there, (0.05 * share,) * 2, (10.0 * share,) * 2)


LINE = "The arm turns about a line through two points that nearly coincide; the {} one is moved."
# Name, why, what is drawn at a value, whether the motion shrinks with it.
Row = tuple[str, str, Callable[[float], Points], bool]


def _of_every_car(car: str, upper: str) -> tuple[Row, ...]:
    """The cases of what both suspensions have; `upper` is the knuckle's third point."""
    return (
        (
            "knuckle-in-line",
            "Three points that carry the knuckle lie nearly in line, so they hardly tell how it is turned.",
            partial(thin_knuckle, car=car, upper=upper),
            True,
        ),
        ("arm-axis-rear-near", LINE.format("rear"), nearer(REAR, FRONT, car), False),
        ("arm-axis-front-near", LINE.format("front"), nearer(FRONT, REAR, car), False),
        (
            "steering-arm-short",
            "The tie rod's outer end nearly coincides with the ball joint, and so the rack hardly moves it.",
            nearer(OUTER, BALL, car),
            True,
        ),
        (
            "tie-rod-short",
            "The tie rod's ends nearly coincide, so its direction is made of rounding.",
            partial(short_tie_rod, car=car),
            True,
        ),
    )


OF_STRUT: tuple[Row, ...] = (
    (
        "strut-points-near",
        "The strut's direction comes from two points that nearly coincide.",
        nearer("strut_rod_end", "strut_top"),
        False,
    ),
    (
        "knuckle-foot-short",
        "The strut's lower point nearly coincides with the ball joint, so the knuckle has no long side.",
        nearer(LOWER, BALL),
        False,
    ),
)
OF_WISHBONE: tuple[Row, ...] = (
    (
        "kingpin-short",
        "The ball joints of a double wishbone nearly coincide, so the knuckle has no long side.",
        nearer(UPPER_BALL, BALL, "wishbone"),
        True,
    ),
    (
        "upper-arm-flat",
        "The upper arm is drawn near where it locks: rounding may choose the side of its ball joint.",
        flat_upper_arm,
        True,
    ),
    (
        "upper-arm-axis-near",
        "The upper arm turns about a line through two points that nearly coincide.",
        nearer(UPPER_REAR, UPPER_FRONT, "wishbone"),
        False,
    ),
)


CASES: tuple[Case, ...] = tuple(
    scene_case(
        name=f"{name}{NAMED[car].suffix}",
        group=GROUP,
        why=why,
        parameter="distance, in parts of what it is in the car",
        values=values,
        expected=dict.fromkeys(SOLVERS, SOLVED),
        behaviour=f"right within the bound, or refused with a reason; right from {RIGHT_FROM:g} up",
        scene=partial(_content, points, shrinking, car),
    )
    for car, values, rows in (
        ("paper", decades(), _of_every_car("paper", LOWER)),
        ("paper", SLOW, OF_STRUT),
        ("wishbone", SLOW, (*_of_every_car("wishbone", UPPER_BALL), *OF_WISHBONE)),
    )
    for name, why, points, shrinking in rows
)
