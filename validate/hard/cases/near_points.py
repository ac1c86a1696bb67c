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

from validate.cars.input_limits import Linkage
from validate.cars.paper_car import PAPER
from validate.hard.cars import PAPER_CAR, paper_car
from validate.hard.case import Case, Expected, decades
from validate.hard.trial import try_scene
from validate.reference import solve_reference

Array = NDArray[np.float64]
Points = Mapping[str, Array]

GROUP = "5. Points nearly in line or nearly coincident"
SOLVERS = ("pointcoord", "pointcoord-newton", "absolute")
RIGHT_FROM = 1e-2  # a millimetre or so, as there may be in a car: it must be solved
SOLVED = Expected(("right", "refused"), right_from=RIGHT_FROM)
SLOW = decades()[::3]  # a refusal takes half a second here


@cache
def drawn_angle() -> float:
    """Arm angle of the paper's drawing, rad."""
    return Linkage.of(PAPER_CAR).drawn_angle


@cache
def assembled() -> dict[str, Array]:
    """The paper's car at its own inputs, each coordinate the nearest number to the true one, mm."""
    instant = solve_reference(PAPER, {"arm_angle": (drawn_angle(), 0, 0)}, closure="collinear")
    return {name: np.array(instant.position_as_float(name)) for name in PAPER}


def thin_knuckle(value: float) -> Points:
    """The tie rod's outer end nearly on the line through the knuckle's other two points."""
    p = assembled()
    line = p["strut_lower"] - p["lower_ball_joint"]
    foot = p["lower_ball_joint"] + line * _share(p["tie_rod_outer"] - p["lower_ball_joint"], line)
    return {**p, "tie_rod_outer": foot + value * (p["tie_rod_outer"] - foot)}


def _share(vector: Array, line: Array) -> float:
    return float(vector @ line) / float(line @ line)


def nearer(moved: str, onto: str) -> Callable[[float], Points]:
    """A point that comes near another along the line between them."""

    def points(value: float) -> Points:
        p = assembled()
        return {**p, moved: p[onto] + value * (p[moved] - p[onto])}

    return points


def short_tie_rod(value: float) -> Points:
    """The rack's end comes near the tie rod's outer end."""
    p = assembled()
    inner = p["tie_rod_outer"] + value * (p["tie_rod_inner"] - p["tie_rod_outer"])
    return {**p, "tie_rod_inner": inner, "rack_centre": inner}


def drawing(points: Points, arm: float, rack: float) -> dict[str, Any]:
    """A motion from the drawing: by `arm` rad and `rack` mm in a second, with accelerations as large."""
    return paper_car(
        (drawn_angle(), 0.5 * arm, 0.5 * arm),
        (0.0, 0.5 * rack, 0.5 * rack),
        points={name: place.tolist() for name, place in points.items()},
        stop=1.0,
    )


def _case(
    name: str, why: str, points: Callable[[float], Points], law: str, values: tuple[float, ...] = decades()
) -> Case:
    def scene(value: float) -> Mapping[str, Any]:
        # A short link follows no more than its own length: its inputs shrink with it.
        share = value if law == "shrinking" else 1.0
        return drawing(points(value), 0.1 * share, 20.0 * share)

    return Case(
        name=name,
        group=GROUP,
        why=why,
        parameter="distance, in parts of what it is in the paper's car",
        values=values,
        expected=dict.fromkeys(SOLVERS, SOLVED),
        behaviour=f"right within the bound, or refused with a reason; right from {RIGHT_FROM:g} up",
        examine=lambda value: try_scene(value, scene(value), SOLVERS),
    )


CASES: tuple[Case, ...] = (
    _case(
        "knuckle-in-line",
        "Three points that carry the knuckle lie nearly in line, so they hardly tell how it is turned.",
        thin_knuckle,
        "shrinking",
    ),
    _case(
        "strut-points-near",
        "The strut's direction comes from two points that nearly coincide.",
        nearer("strut_rod_end", "strut_top"),
        "whole",
        SLOW,
    ),
    _case(
        "knuckle-foot-short",
        "The strut's lower point nearly coincides with the ball joint, so the knuckle has no long side.",
        nearer("strut_lower", "lower_ball_joint"),
        "whole",
        SLOW,
    ),
    _case(
        "arm-axis-rear-near",
        "The arm turns about a line through two points that nearly coincide; the rear one is moved.",
        nearer("lower_arm_rear", "lower_arm_front"),
        "whole",
    ),
    _case(
        "arm-axis-front-near",
        "The arm turns about a line through two points that nearly coincide; the front one is moved.",
        nearer("lower_arm_front", "lower_arm_rear"),
        "whole",
    ),
    _case(
        "steering-arm-short",
        "The tie rod's outer end nearly coincides with the ball joint, and so the rack hardly moves it.",
        nearer("tie_rod_outer", "lower_ball_joint"),
        "shrinking",
    ),
    _case(
        "tie-rod-short",
        "The tie rod's ends nearly coincide, so its direction is made of rounding.",
        short_tie_rod,
        "shrinking",
    ),
)
