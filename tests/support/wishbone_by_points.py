"""Double wishbones: random cars, and their closed form in mpmath.

The arm angle gives the lower ball joint; the upper one lies where three spheres meet, and so does the outer
end of the tie rod. Written apart from the package, which solves all links together by Newton's method.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

import lotus_front
import mpmath
from closed_forms import (
    Points,
    angle,
    cross,
    dot,
    minus,
    number,
    numbers,
    plus,
    rational_turn,
    size,
    times,
    turned,
    unit,
)
from hypothesis import strategies as st
from mpmath import mpf

Vector = tuple[mpf, mpf, mpf]
Sides = tuple[int, int, int]

# A right wheel, mm; the rack passes through the car's middle.
BASE: Points = {**lotus_front.POINTS, "rack_centre": (-10, 0, 154)}
KNUCKLE = ("lower_ball_joint", "upper_ball_joint", "tie_rod_outer")
CARRIED = ("wheel_centre", "wheel_axis_inner")


@dataclass(frozen=True)
class WishbonePose:
    """An assembly by the closed form; mm. Sides of the lower arm, the upper arm and the tie rod, +1 or -1."""

    points: Points
    sides: Sides


@dataclass(frozen=True)
class WishboneCar:
    """A drawing that closes, and the car's directions; exact fractions."""

    points: Points
    up: Vector
    right: Vector

    @property
    def drawn(self) -> tuple[mpf, mpf]:
        """theta and S of the drawing."""
        p, arm = self.points, minus(self.points["lower_ball_joint"], self.points["lower_arm_front"])
        rise = number(dot(arm, self.up)) / mpmath.sqrt(number(dot(arm, arm)))
        return mpmath.acos(rise), number(dot(minus(p["rack_centre"], p["tie_rod_inner"]), self.right))

    def poses(self, theta: object, travel: object, heave: object = 0) -> Iterator[WishbonePose]:
        """Every assembly: the lower arm, the upper arm and the tie rod have two answers each, or none."""
        p = {name: numbers(place) for name, place in self.points.items()}
        up, right = numbers(self.up), numbers(self.right)
        for sides in itertools.product((1, -1), repeat=3):
            points = _assembled(p, up, right, sides, (mpf(theta), mpf(travel), mpf(heave)))
            if points is not None:
                yield WishbonePose(points, sides)

    def drawn_pose(self, theta: object, travel: object, heave: object = 0) -> WishbonePose | None:
        """The assembly on the sides of the drawing, or none."""
        wanted = self.drawn_sides
        return next((pose for pose in self.poses(theta, travel, heave) if pose.sides == wanted), None)

    @property
    def drawn_sides(self) -> Sides:
        """The sides on which the drawing lies."""
        p = {name: numbers(place) for name, place in self.points.items()}
        return _arm_side(p, numbers(self.up)), _upper_side(p), _tie_rod_side(p)


@st.composite
def wishbone_cars(draw: st.DrawFn) -> WishboneCar:
    """Cars with every point up to 20 mm from `BASE`, turned at will, left or right."""
    nudge = st.integers(-20 * 8, 20 * 8).map(lambda n: Fraction(n, 8))
    points = {name: tuple(Fraction(x) + draw(nudge) for x in place) for name, place in BASE.items()}
    up, right = (0, 0, 1), (0, 1, 0)
    travel = Fraction(draw(st.integers(-260 * 8, -100 * 8)), 8)
    points["rack_centre"] = plus(points["tie_rod_inner"], times(right, travel))
    if draw(st.booleans()):
        points = {name: (x, -y, z) for name, (x, y, z) in points.items()}
    turn = rational_turn(draw(st.tuples(*[st.integers(-9, 9)] * 4).filter(any)))
    return WishboneCar(
        {name: turned(turn, p) for name, p in points.items()}, turned(turn, up), turned(turn, right)
    )


def _arm_side(p: Points, up: Vector) -> int:
    arm, pivots = (minus(p[name], p["lower_arm_front"]) for name in ("lower_ball_joint", "lower_arm_rear"))
    return 1 if dot(cross(arm, pivots), up) > 0 else -1


def _upper_side(p: Points) -> int:
    front = p["upper_arm_front"]
    rear, lower, upper = (
        minus(p[name], front) for name in ("upper_arm_rear", "lower_ball_joint", "upper_ball_joint")
    )
    return 1 if dot(cross(rear, lower), upper) > 0 else -1


def _tie_rod_side(p: Points) -> int:
    ball = p["lower_ball_joint"]
    kingpin, inner, outer = (
        minus(p[name], ball) for name in ("upper_ball_joint", "tie_rod_inner", "tie_rod_outer")
    )
    return 1 if dot(cross(kingpin, inner), outer) > 0 else -1


def _assembled(
    p: Points, up: Vector, right: Vector, sides: Sides, inputs: tuple[mpf, mpf, mpf]
) -> Points | None:
    theta, travel, heave = inputs
    lift = times(up, heave)
    fixed = ("lower_arm_front", "lower_arm_rear", "upper_arm_front", "upper_arm_rear", "rack_centre")
    found = {name: plus(p[name], lift) for name in fixed}
    found["tie_rod_inner"] = minus(found["rack_centre"], times(right, travel))

    def length(one: str, other: str) -> mpf:
        return size(minus(p[one], p[other]))

    def held(point: str, centres: tuple[str, str, str], side: int) -> bool:
        place = three_spheres(
            [found[name] for name in centres], [length(point, name) for name in centres], side
        )
        if place is not None:
            found[point] = place
        return place is not None

    lower = _lower_ball_joint(p, found["lower_arm_front"], up, theta, sides[0])
    if lower is None:
        return None
    found["lower_ball_joint"] = lower
    pivots = ("upper_arm_front", "upper_arm_rear", "lower_ball_joint")
    if not held("upper_ball_joint", pivots, sides[1]):
        return None
    if not held("tie_rod_outer", ("lower_ball_joint", "upper_ball_joint", "tie_rod_inner"), sides[2]):
        return None
    was, now = ([minus(place[name], place[KNUCKLE[0]]) for name in KNUCKLE[1:]] for place in (p, found))
    frame = [*was, cross(*was)]
    for name in CARRIED:
        weights = components(minus(p[name], p[KNUCKLE[0]]), frame)
        place = found[KNUCKLE[0]]
        for weight, edge in zip(weights, [*now, cross(*now)], strict=True):
            place = plus(place, times(edge, weight))
        found[name] = place
    return found


def _lower_ball_joint(p: Points, front: Vector, up: Vector, theta: mpf, side: int) -> Vector | None:
    """On its circle about the arm's axis, at the height that the arm angle says."""
    arm = minus(p["lower_ball_joint"], p["lower_arm_front"])
    pivot = unit(minus(p["lower_arm_rear"], p["lower_arm_front"]))
    foot = times(pivot, dot(arm, pivot))
    e = minus(arm, foot)
    f = cross(pivot, e)
    goal = size(arm) * mpmath.cos(theta) - dot(foot, up)
    for answer in (1, -1):
        phi = angle(dot(e, up), dot(f, up), goal, answer)
        if phi is not None:
            turned_arm = plus(foot, plus(times(e, mpmath.cos(phi)), times(f, mpmath.sin(phi))))
            if (dot(cross(turned_arm, pivot), up) > 0) == (side > 0):
                return plus(front, turned_arm)
    return None


def three_spheres(centres: list[Vector], radii: list[mpf], side: int) -> Vector | None:
    """Where three spheres meet, on one side of the plane of their centres, or nothing.

    With e_x from the first centre to the second, at d, and the third at (i, j) in the plane of e_x and e_y:
    x = (r1^2 - r2^2 + d^2) / 2d,  y = (r1^2 - r3^2 + i^2 + j^2 - 2 i x) / 2j,  z = +-sqrt(r1^2 - x^2 - y^2).
    """
    first, second, third = centres
    across, along = minus(third, first), unit(minus(second, first))
    d, i = size(minus(second, first)), dot(along, across)
    beside = minus(across, times(along, i))
    j = size(beside)
    beside = times(beside, 1 / j)
    x = (radii[0] ** 2 - radii[1] ** 2 + d * d) / (2 * d)
    y = (radii[0] ** 2 - radii[2] ** 2 + i * i + j * j - 2 * i * x) / (2 * j)
    under = radii[0] ** 2 - x * x - y * y
    if under < 0:
        return None
    out = times(cross(along, beside), side * mpmath.sqrt(under))
    return plus(first, plus(plus(times(along, x), times(beside, y)), out))


def components(vector: Vector, frame: list[Vector]) -> list[mpf]:
    """The weights of three vectors that give a fourth, by Cramer's rule."""

    def volume(a: Vector, b: Vector, c: Vector) -> mpf:
        return dot(cross(a, b), c)

    whole = volume(*frame)
    return [volume(*(vector if i == j else frame[j] for j in range(3))) / whole for i in range(3)]
