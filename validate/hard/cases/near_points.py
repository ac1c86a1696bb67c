"""Points that nearly coincide or nearly lie in line, in a car that moves.

Links between such points lose digits when coordinates are subtracted, and directions through them turn by
rounding. The cars are drawn assembled, so that nothing but the two points is out of the ordinary.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from validate.cars.car import unit
from validate.cars.closed_form import BALL, FRONT, INNER, OUTER, RACK, REAR
from validate.cars.double_wishbone import UPPER_BALL, UPPER_FRONT, UPPER_REAR
from validate.cars.input_limits import Linkage
from validate.cars.macpherson import LOWER, ROD_END, TOP
from validate.cars.scene_content import scene_content
from validate.hard.cars import CARS, PAPER_CAR, drawn_at
from validate.hard.case import Case, Expected, decades
from validate.hard.trial import scene_case

Array = NDArray[np.float64]
Points = Mapping[str, Array]

GROUP = "Points nearly in line or nearly coincident"
SOLVERS = ("pointcoord", "pointcoord-newton", "absolute", "relative")
RIGHT_FROM = 1e-2  # a millimetre or so, as there may be in a car: it must be solved
SOLVED = Expected(("right", "refused"), right_from=RIGHT_FROM)
SLOW = decades()[::3]  # a refusal takes half a second here


@cache
def drawn_angle(car: str = "paper") -> float:
    """Arm angle of a car's drawing, rad."""
    return Linkage.of(CARS[car]).drawn_angle


@cache
def assembled(car: str = "paper") -> dict[str, Array]:
    """A car at its own inputs, each coordinate the nearest number to the true one, mm."""
    if CARS[car].closure == "drawn":
        return CARS[car].array
    return drawn_at(PAPER_CAR, drawn_angle(), 0.0).array


def thin_knuckle(value: float, car: str = "paper", upper: str = LOWER) -> Points:
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
    return {**p, INNER: inner, RACK: inner}


def drawing(points: Points, arm: float, rack: float, car: str = "paper") -> dict[str, Any]:
    """A motion from the drawing: by `arm` rad and `rack` mm in a second, with accelerations as large."""
    there = CARS[car].drawn_as(points)
    angle = drawn_angle(car) if car == "paper" else Linkage.of(there).drawn_angle
    return scene_content(there, (angle, 0.5 * arm, 0.5 * arm), (0.0, 0.5 * rack, 0.5 * rack), stop=1.0)


def _case(
    name: str,
    why: str,
    points: Callable[[float], Points],
    law: str,
    values: tuple[float, ...] = decades(),
    car: str = "paper",
) -> Case:
    def scene(value: float) -> Mapping[str, Any]:
        # A short link follows no more than its own length: its inputs shrink with it.
        share = value if law == "shrinking" else 1.0
        return drawing(points(value), 0.1 * share, 20.0 * share, car)

    return scene_case(
        name=f"{name}-wishbone" if car == "wishbone" else name,
        group=GROUP,
        why=why,
        parameter="distance, in parts of what it is in the car",
        values=values[::3] if car == "wishbone" else values,
        expected=dict.fromkeys(SOLVERS, SOLVED),
        behaviour=f"right within the bound, or refused with a reason; right from {RIGHT_FROM:g} up",
        scene=scene,
    )


def _of_every_car(car: str, upper: str) -> tuple[Case, ...]:
    """The cases of what every suspension has; `upper` is the knuckle's third point."""
    return (
        _case(
            "knuckle-in-line",
            "Three points that carry the knuckle lie nearly in line, so they hardly tell how it is turned.",
            lambda value: thin_knuckle(value, car, upper),
            "shrinking",
            car=car,
        ),
        _case(
            "arm-axis-rear-near",
            "The arm turns about a line through two points that nearly coincide; the rear one is moved.",
            nearer(REAR, FRONT, car),
            "whole",
            car=car,
        ),
        _case(
            "arm-axis-front-near",
            "The arm turns about a line through two points that nearly coincide; the front one is moved.",
            nearer(FRONT, REAR, car),
            "whole",
            car=car,
        ),
        _case(
            "steering-arm-short",
            "The tie rod's outer end nearly coincides with the ball joint, and so the rack hardly moves it.",
            nearer(OUTER, BALL, car),
            "shrinking",
            car=car,
        ),
        _case(
            "tie-rod-short",
            "The tie rod's ends nearly coincide, so its direction is made of rounding.",
            lambda value: short_tie_rod(value, car),
            "shrinking",
            car=car,
        ),
    )


CASES: tuple[Case, ...] = (
    *_of_every_car("paper", LOWER),
    _case(
        "strut-points-near",
        "The strut's direction comes from two points that nearly coincide.",
        nearer(ROD_END, TOP),
        "whole",
        SLOW,
    ),
    _case(
        "knuckle-foot-short",
        "The strut's lower point nearly coincides with the ball joint, so the knuckle has no long side.",
        nearer(LOWER, BALL),
        "whole",
        SLOW,
    ),
    *_of_every_car("wishbone", UPPER_BALL),
    _case(
        "kingpin-short",
        "The ball joints of a double wishbone nearly coincide, so the knuckle has no long side.",
        nearer(UPPER_BALL, BALL, "wishbone"),
        "shrinking",
        car="wishbone",
    ),
    _case(
        "upper-arm-flat",
        "The upper arm is drawn near where it locks: rounding may choose the side of its ball joint.",
        flat_upper_arm,
        "shrinking",
        car="wishbone",
    ),
    _case(
        "upper-arm-axis-near",
        "The upper arm turns about a line through two points that nearly coincide.",
        nearer(UPPER_REAR, UPPER_FRONT, "wishbone"),
        "whole",
        car="wishbone",
    ),
)
