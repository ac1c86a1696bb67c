"""Struts whose axis passes beside the ball joint: random cars, and their closed form in mpmath.

Written apart from the package: from angles about two axes and one quadratic, where the package solves
equations for direction cosines.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

import mpmath
from hypothesis import Phase
from hypothesis import strategies as st
from mpmath import mpf

from validate.reference.vectors import Vector, cross, dot, minus, plus, times

Points = dict[str, Vector]

# Without shrinking: a failure is told in seconds, and a car of round numbers explains no more.
PHASES = (Phase.explicit, Phase.reuse, Phase.generate)

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
class OffAxisCar:
    """A drawing that closes, and the car's directions; exact fractions."""

    points: Points
    up: Vector
    right: Vector

    @property
    def frame(self) -> dict[str, Vector]:
        return {"up": self.up, "right": self.right}

    @property
    def drawn(self) -> tuple[mpf, mpf]:
        """theta and S of the drawing."""
        p, arm = self.points, minus(self.points["lower_ball_joint"], self.points["lower_arm_front"])
        angle = mpmath.acos(number(dot(arm, self.up)) / mpmath.sqrt(number(dot(arm, arm))))
        return angle, number(dot(minus(p["rack_centre"], p["tie_rod_inner"]), self.right))


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


def rational_turn(quaternion: tuple[int, int, int, int]) -> tuple[Vector, Vector, Vector]:
    """The columns of a turn, exact, from a quaternion of whole numbers."""
    w, *v = (Fraction(n) for n in quaternion)
    axis, size = (v[0], v[1], v[2]), sum(Fraction(n) ** 2 for n in quaternion)
    units = ((1, 0, 0), (0, 1, 0), (0, 0, 1))

    def column(e: Vector) -> Vector:
        across = cross(axis, e)
        return times(
            plus(
                times(e, w * w - dot(axis, axis)), plus(times(axis, 2 * dot(axis, e)), times(across, 2 * w))
            ),
            1 / size,
        )

    return column(units[0]), column(units[1]), column(units[2])


def turned(columns: tuple[Vector, Vector, Vector], p: Vector) -> Vector:
    return plus(plus(times(columns[0], p[0]), times(columns[1], p[1])), times(columns[2], p[2]))


@dataclass(frozen=True)
class Pose:
    """An assembly by the closed form; mm.

    Attributes:
        points: by name.
        columns: of the knuckle's turn from the drawing.
        slide: the strut top's place on the axis, as a share of 7-4 as drawn.
        sides: of the arm, the slide and the tie rod, each +1 or -1.
    """

    points: Points
    columns: tuple[Vector, Vector, Vector]
    slide: mpf
    sides: tuple[int, int, int]


def poses(car: OffAxisCar, theta: object, travel: object, heave: object = 0) -> Iterator[Pose]:
    """Every assembly, by the closed form: arm, slide and tie rod have two answers each, or none."""
    p = {name: numbers(place) for name, place in car.points.items()}
    up, right = numbers(car.up), numbers(car.right)
    for sides in itertools.product((1, -1), repeat=3):
        pose = _pose(p, up, right, sides, (mpf(theta), mpf(travel), mpf(heave)))
        if pose is not None:
            yield pose


def drawn_pose(car: OffAxisCar, theta: object, travel: object, heave: object = 0) -> Pose | None:
    """The assembly on the sides of the drawing, or none."""
    wanted = drawn_sides(car)
    return next((pose for pose in poses(car, theta, travel, heave) if pose.sides == wanted), None)


def drawn_sides(car: OffAxisCar) -> tuple[int, int, int]:
    """The sides on which the drawing itself lies: of its own assemblies it is the one that moves nothing."""

    def moved(pose: Pose) -> mpf:
        return max(abs(x) for n, q in pose.points.items() for x in minus(q, numbers(car.points[n])))

    return min(poses(car, *car.drawn), key=moved).sides


def _pose(
    p: Points, up: Vector, right: Vector, sides: tuple[int, int, int], inputs: tuple[mpf, mpf, mpf]
) -> Pose | None:
    theta, travel, heave = inputs
    lift = times(up, heave)
    p1, p2, p3, p4 = (
        plus(p[name], lift) for name in ("lower_arm_front", "lower_arm_rear", "rack_centre", "strut_top")
    )
    ball = p["lower_ball_joint"]
    arm = minus(ball, p["lower_arm_front"])
    pivot = unit(minus(p2, p1))
    foot = times(pivot, dot(arm, pivot))
    e = minus(arm, foot)
    f = cross(pivot, e)
    goal = size(arm) * mpmath.cos(theta) - dot(foot, up)
    phi = angle(dot(e, up), dot(f, up), goal, sides[0])
    if phi is None:
        return None
    p5 = plus(plus(p1, foot), plus(times(e, mpmath.cos(phi)), times(f, mpmath.sin(phi))))

    k = {name: minus(place, ball) for name, place in p.items()}
    u, strut = minus(k["strut_top"], k["strut_lower"]), minus(p4, p5)
    half, constant = dot(k["strut_lower"], u), dot(k["strut_lower"], k["strut_lower"]) - dot(strut, strut)
    under = half * half - dot(u, u) * constant
    if under < 0:
        return None
    slide = (-half + sides[1] * mpmath.sqrt(under)) / dot(u, u)

    # First the shortest turn that lays the knuckle's line to the strut top on the car's, then one about it.
    was, now = unit(plus(k["strut_lower"], times(u, slide))), unit(strut)
    p9 = minus(p3, times(right, travel))
    w, r9 = _shortest(was, now, k["tie_rod_outer"]), minus(p9, p5)
    along = times(now, dot(w, now))
    tie = minus(p["tie_rod_outer"], p["tie_rod_inner"])
    goal = (dot(w, w) + dot(r9, r9) - dot(tie, tie)) / 2 - dot(along, r9)
    psi = angle(dot(minus(w, along), r9), dot(cross(now, w), r9), goal, sides[2])
    if psi is None:
        return None

    def place(v: Vector) -> Vector:
        v = _shortest(was, now, v)
        on = times(now, dot(v, now))
        return plus(on, plus(times(minus(v, on), mpmath.cos(psi)), times(cross(now, v), mpmath.sin(psi))))

    carried = ("tie_rod_outer", "strut_lower", "wheel_centre", "wheel_axis_inner")
    points = {name: plus(p5, place(k[name])) for name in carried if name in k}
    rod = minus(p["strut_rod_end"], p["strut_top"])
    axis = unit(place(u))
    side = 1 if dot(rod, u) > 0 else -1
    points |= {
        "lower_arm_front": p1,
        "lower_arm_rear": p2,
        "rack_centre": p3,
        "strut_top": p4,
        "lower_ball_joint": p5,
        "tie_rod_inner": p9,
        "strut_rod_end": plus(p4, times(axis, side * size(rod))),
    }
    columns = (
        place((mpf(1), mpf(0), mpf(0))),
        place((mpf(0), mpf(1), mpf(0))),
        place((mpf(0), mpf(0), mpf(1))),
    )
    return Pose(points, columns, slide, sides)


def angle(a: mpf, b: mpf, c: mpf, side: int) -> mpf | None:
    """An angle with a cos + b sin = c, or none."""
    reach = mpmath.sqrt(a * a + b * b)
    return None if abs(c) > reach else mpmath.atan2(b, a) + side * mpmath.acos(c / reach)


def _shortest(was: Vector, now: Vector, v: Vector) -> Vector:
    """v turned as the unit vector `was` turns to `now`, about the normal of both (Rodrigues)."""
    normal = cross(was, now)
    return plus(plus(v, cross(normal, v)), times(cross(normal, cross(normal, v)), 1 / (1 + dot(was, now))))


def unit(v: Vector) -> Vector:
    return times(v, 1 / size(v))


def size(v: Vector) -> mpf:
    return mpmath.sqrt(dot(v, v))


def number(value: object) -> mpf:
    if isinstance(value, mpf):
        return value
    fraction = Fraction(value)
    return mpf(fraction.numerator) / fraction.denominator


def numbers(vector: Vector) -> Vector:
    return number(vector[0]), number(vector[1]), number(vector[2])
