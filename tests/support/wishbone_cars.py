"""Double wishbones: random cars, and their closed form in mpmath.

Written apart from the package: three angles, of the lower arm, of the upper arm and about the kingpin, where
the package solves all links together.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import ClassVar

import lotus_front
import mpmath
from closed_forms import (
    ClosedFormCar,
    Points,
    Pose,
    Sides,
    angle,
    lower_ball_joint,
    rational_turn,
    steered,
    tie_rod,
    turned,
    unit,
)
from hypothesis import strategies as st
from mpmath import mpf

from validate.reference.vectors import Vector, cross, dot, minus, plus, times

KNUCKLE = ("lower_ball_joint", "upper_ball_joint", "tie_rod_outer", "wheel_centre", "wheel_axis_inner")


@dataclass(frozen=True)
class WishboneCar(ClosedFormCar):
    """A double wishbone."""

    suspension = "double_wishbone"
    bodies: ClassVar[Mapping[str, tuple[str, ...]]] = {
        "knuckle": KNUCKLE,
        "lower_arm": ("lower_arm_front", "lower_arm_rear", "lower_ball_joint"),
        "upper_arm": ("upper_arm_front", "upper_arm_rear", "upper_ball_joint"),
    }

    def assembled(self, p: Points, up: Vector, right: Vector, sides: Sides, inputs: Vector) -> Pose | None:
        return _pose(p, up, right, sides, inputs)


RACK_CENTRE = (-10, 0, 154)
RIGHT: Vector = (0, 1, 0)
LOTUS = WishboneCar({**lotus_front.POINTS, "rack_centre": RACK_CENTRE}, (0, 0, 1), RIGHT)


@st.composite
def wishbone_cars(draw: st.DrawFn) -> WishboneCar:
    """Cars with every point up to 20 mm from the Lotus, turned at will, right or left."""
    nudge = st.integers(-20 * 8, 20 * 8).map(lambda n: Fraction(n, 8))
    points = {name: tuple(Fraction(x) + draw(nudge) for x in place) for name, place in LOTUS.points.items()}
    travel = Fraction(draw(st.integers(-200 * 8, -150 * 8)), 8)
    points["tie_rod_inner"] = minus(points["rack_centre"], times(RIGHT, travel))
    if draw(st.booleans()):
        points = {name: (x, -y, z) for name, (x, y, z) in points.items()}
    turn = rational_turn(draw(st.tuples(*[st.integers(-9, 9)] * 4).filter(any)))
    return WishboneCar(
        {name: turned(turn, p) for name, p in points.items()}, turned(turn, LOTUS.up), turned(turn, RIGHT)
    )


def _pose(
    p: Points, up: Vector, right: Vector, sides: tuple[int, int, int], inputs: tuple[mpf, mpf, mpf]
) -> Pose | None:
    lower = lower_ball_joint(p, up, right, sides[0], *inputs)
    if lower is None:
        return None
    lift, ball = times(up, inputs[2]), lower["lower_ball_joint"]
    front, rear = (plus(p[name], lift) for name in ("upper_arm_front", "upper_arm_rear"))
    arm, axis = minus(p["upper_ball_joint"], p["upper_arm_front"]), unit(minus(rear, front))
    foot = times(axis, dot(arm, axis))
    e = minus(arm, foot)
    f, middle = cross(axis, e), minus(plus(front, foot), ball)
    k_top = minus(p["upper_ball_joint"], p["lower_ball_joint"])
    goal = (dot(k_top, k_top) - dot(middle, middle) - dot(e, e)) / 2
    psi = angle(dot(middle, e), dot(middle, f), goal, sides[1])
    if psi is None:
        return None
    upper = plus(plus(front, foot), plus(times(e, mpmath.cos(psi)), times(f, mpmath.sin(psi))))

    k = {name: minus(p[name], p["lower_ball_joint"]) for name in KNUCKLE}
    inner = minus(lower["tie_rod_inner"], ball)
    place = steered(k_top, minus(upper, ball), k["tie_rod_outer"], inner, tie_rod(p), sides[2])
    if place is None:
        return None
    points = {name: plus(ball, place(v)) for name, v in k.items()}
    points |= lower | {"upper_arm_front": front, "upper_arm_rear": rear}
    return Pose(points, sides)
