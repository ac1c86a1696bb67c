"""Struts whose axis passes beside the ball joint: random cars, and their closed form in mpmath.

Written apart from the package: from angles about two axes and one quadratic, where the package solves
equations for direction cosines.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import ClassVar

import mpmath
from closed_forms import (
    ClosedFormCar,
    Points,
    Pose,
    Sides,
    lower_ball_joint,
    rational_turn,
    size,
    steered,
    tie_rod,
    turned,
    unit,
)
from hypothesis import strategies as st
from mpmath import mpf

from validate.reference.vectors import Vector, dot, minus, plus, times

# A strut of a real car's size, mm; the ball joint is a few centimetres beside the strut's axis.
BASE: Points = {
    "lower_arm_front": (1200, -350, 200),
    "lower_arm_rear": (1500, -340, 210),
    "rack_centre": (1450, -100, 250),
    "strut_top": (1330, -560, 820),
    "lower_ball_joint": (1310, -720, 190),
    "tie_rod_outer": (1440, -690, 230),
    "strut_lower": (1318, -640, 330),
    "strut_rod_end": (1324, -600, 575),
    "tie_rod_inner": (1450, -330, 250),
    "wheel_centre": (1312, -770, 300),
    "wheel_axis_inner": (1312, -660, 302),
}


@dataclass(frozen=True)
class OffAxisCar(ClosedFormCar):
    """A strut as drawn."""

    suspension = "macpherson"
    bodies: ClassVar[Mapping[str, tuple[str, ...]]] = {
        "knuckle": (
            "lower_ball_joint",
            "tie_rod_outer",
            "strut_lower",
            "wheel_centre",
            "wheel_axis_inner",
        ),
        "lower_arm": ("lower_arm_front", "lower_arm_rear", "lower_ball_joint"),
    }

    def assembled(self, p: Points, up: Vector, right: Vector, sides: Sides, inputs: Vector) -> Pose | None:
        return _pose(p, up, right, sides, inputs)


def closing(points: Points, rod: Fraction, travel: Fraction, right: Vector) -> Points:
    """The points with the rod's end on the strut's axis and the tie rod's on the rack's line."""
    top = points["strut_top"]
    return points | {
        "strut_rod_end": plus(top, times(minus(points["strut_lower"], top), rod)),
        "tie_rod_inner": minus(points["rack_centre"], times(right, travel)),
    }


@st.composite
def off_axis_cars(draw: st.DrawFn) -> OffAxisCar:
    """Cars with every point up to 30 mm from `BASE`, turned at will, left or right."""
    nudge = st.integers(-30 * 8, 30 * 8).map(lambda n: Fraction(n, 8))
    points = {name: tuple(Fraction(x) + draw(nudge) for x in place) for name, place in BASE.items()}
    points = closing(
        points,
        draw(st.sampled_from([-1, 1])) * Fraction(draw(st.integers(5, 60)), 64),
        *draw(st.integers(-260 * 8, -200 * 8).map(lambda n: (-Fraction(n, 8), (0, -1, 0)))),
    )
    up, right = (0, 0, 1), (0, 1, 0)
    if draw(st.booleans()):
        points = {name: (x, -y, z) for name, (x, y, z) in points.items()}
    turn = rational_turn(draw(st.tuples(*[st.integers(-9, 9)] * 4).filter(any)))
    return OffAxisCar(
        {name: turned(turn, p) for name, p in points.items()}, turned(turn, up), turned(turn, right)
    )


def _pose(
    p: Points, up: Vector, right: Vector, sides: tuple[int, int, int], inputs: tuple[mpf, mpf, mpf]
) -> Pose | None:
    lower = lower_ball_joint(p, up, right, sides[0], *inputs)
    if lower is None:
        return None
    ball, p5, p9 = p["lower_ball_joint"], lower["lower_ball_joint"], lower["tie_rod_inner"]
    p4 = plus(p["strut_top"], times(up, inputs[2]))

    k = {name: minus(place, ball) for name, place in p.items()}
    u, strut = minus(k["strut_top"], k["strut_lower"]), minus(p4, p5)
    half, constant = dot(k["strut_lower"], u), dot(k["strut_lower"], k["strut_lower"]) - dot(strut, strut)
    under = half * half - dot(u, u) * constant
    if under < 0:
        return None
    slide = (-half + sides[1] * mpmath.sqrt(under)) / dot(u, u)

    top = plus(k["strut_lower"], times(u, slide))
    place = steered(top, strut, k["tie_rod_outer"], minus(p9, p5), tie_rod(p), sides[2])
    if place is None:
        return None

    carried = ("tie_rod_outer", "strut_lower", "wheel_centre", "wheel_axis_inner")
    points = {name: plus(p5, place(k[name])) for name in carried if name in k}
    rod = minus(p["strut_rod_end"], p["strut_top"])
    axis = unit(place(u))
    side = 1 if dot(rod, u) > 0 else -1
    points |= lower | {"strut_top": p4, "strut_rod_end": plus(p4, times(axis, side * size(rod)))}
    return Pose(points, sides)
