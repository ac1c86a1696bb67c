"""Cars whose poses are known in closed form, in mpmath: what the linkages have in common.

Written apart from the package: from angles about two axes, where the package solves equations or intersects
spheres.
"""

from __future__ import annotations

import itertools
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, ClassVar

import mpmath
from hypothesis import Phase
from mpmath import mpf
from plain_mechanisms import close_car, count_car, solve_car

from validate.reference import Instant
from validate.reference.vectors import Vector, cross, dot, minus, plus, times

Points = dict[str, Vector]
Sides = tuple[int, ...]

# Without shrinking: a failure is told in seconds, and a car of round numbers explains no more.
PHASES = (Phase.explicit, Phase.reuse, Phase.generate)


@dataclass(frozen=True)
class Pose:
    """An assembly by the closed form; mm.

    Attributes:
        points: by name.
        sides: of each step that has two answers, +1 or -1.
    """

    points: Points
    sides: tuple[int, ...]


@dataclass(frozen=True)
class ClosedFormCar(ABC):
    """A drawing that closes, and the car's directions; exact fractions.

    Attributes:
        suspension: its type.
        bodies: points of each body, the first three not on one line.
    """

    points: Points
    up: Vector
    right: Vector

    suspension: ClassVar[str]
    bodies: ClassVar[Mapping[str, tuple[str, ...]]]

    def poses(self, theta: object, travel: object, heave: object = 0) -> Iterator[Pose]:
        """Every assembly: each of the three steps of the closed form has two answers, or none."""
        p = {name: numbers(place) for name, place in self.points.items()}
        up, right = numbers(self.up), numbers(self.right)
        for sides in itertools.product((1, -1), repeat=3):
            pose = self.assembled(p, up, right, sides, (mpf(theta), mpf(travel), mpf(heave)))
            if pose is not None:
                yield pose

    @abstractmethod
    def assembled(self, p: Points, up: Vector, right: Vector, sides: Sides, inputs: Vector) -> Pose | None:
        """The assembly whose steps take these answers; None where one of them has none."""

    @property
    def frame(self) -> dict[str, Vector]:
        return {"up": self.up, "right": self.right}

    @property
    def kind(self) -> dict[str, Any]:
        """What every function of the reference is told beside points and inputs."""
        return {**self.frame, "suspension": self.suspension}

    @property
    def drawn(self) -> tuple[mpf, mpf]:
        """theta and S of the drawing."""
        p, arm = self.points, minus(self.points["lower_ball_joint"], self.points["lower_arm_front"])
        angle = mpmath.acos(number(dot(arm, self.up)) / mpmath.sqrt(number(dot(arm, arm))))
        return angle, number(dot(minus(p["rack_centre"], p["tie_rod_inner"]), self.right))

    def drawn_pose(self, theta: object, travel: object, heave: object = 0) -> Pose | None:
        """The assembly on the sides of the drawing, or none."""
        wanted = self.drawn_sides
        return next((pose for pose in self.poses(theta, travel, heave) if pose.sides == wanted), None)

    @property
    def drawn_sides(self) -> tuple[int, ...]:
        """The sides on which the drawing lies: of its own assemblies it is the one that moves nothing."""

        def moved(pose: Pose) -> mpf:
            return max(abs(x) for n, q in pose.points.items() for x in minus(q, numbers(self.points[n])))

        return min(self.poses(*self.drawn), key=moved).sides

    def solve(self, inputs: Mapping[str, tuple[Any, ...]], **settings: Any) -> Instant:
        return solve_car(self.points, inputs, **{**self.kind, **settings})

    def count(self, inputs: Mapping[str, tuple[Any, ...]], **settings: Any) -> Any:
        return count_car(self.points, inputs, **self.kind, **settings)

    def close(self) -> Any:
        return close_car(self.points, **self.kind)


def lower_ball_joint(
    p: Points, up: Vector, right: Vector, side: int, theta: mpf, travel: mpf, heave: mpf
) -> Points | None:
    """The points of the chassis, lifted, with the lower ball joint and the rack's end; None out of reach."""
    lift = times(up, heave)
    arm = minus(p["lower_ball_joint"], p["lower_arm_front"])
    pivot = unit(minus(p["lower_arm_rear"], p["lower_arm_front"]))
    foot = times(pivot, dot(arm, pivot))
    e = minus(arm, foot)
    f = cross(pivot, e)
    phi = angle(dot(e, up), dot(f, up), size(arm) * mpmath.cos(theta) - dot(foot, up), side)
    if phi is None:
        return None
    front, rack = plus(p["lower_arm_front"], lift), plus(p["rack_centre"], lift)
    return {
        "lower_arm_front": front,
        "lower_arm_rear": plus(p["lower_arm_rear"], lift),
        "rack_centre": rack,
        "lower_ball_joint": plus(
            plus(front, foot), plus(times(e, mpmath.cos(phi)), times(f, mpmath.sin(phi)))
        ),
        "tie_rod_inner": minus(rack, times(right, travel)),
    }


def tie_rod(p: Points) -> mpf:
    """The squared length of the tie rod as drawn."""
    tie = minus(p["tie_rod_outer"], p["tie_rod_inner"])
    return dot(tie, tie)


def steered(
    k_top: Vector, top: Vector, k_outer: Vector, inner: Vector, tie2: mpf, side: int
) -> Callable[[Vector], Vector] | None:
    """How the knuckle stands: a vector of it from the ball joint, as drawn -> as it stands; or none.

    Args:
        k_top: upper end of the steering axis in the knuckle as drawn.
        top: where that is.
        k_outer: the tie rod's outer end in the knuckle as drawn.
        inner: where its inner end is.
        tie2: its length squared.
        side: of the two answers.
    """
    # First the shortest turn that lays the knuckle's steering axis on the car's, then one about it.
    was, now = unit(k_top), unit(top)
    w = shortest_turn(was, now, k_outer)
    along = times(now, dot(w, now))
    goal = (dot(w, w) + dot(inner, inner) - tie2) / 2 - dot(along, inner)
    psi = angle(dot(minus(w, along), inner), dot(cross(now, w), inner), goal, side)
    if psi is None:
        return None

    def place(v: Vector) -> Vector:
        v = shortest_turn(was, now, v)
        on = times(now, dot(v, now))
        return plus(on, plus(times(minus(v, on), mpmath.cos(psi)), times(cross(now, v), mpmath.sin(psi))))

    return place


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


def angle(a: mpf, b: mpf, c: mpf, side: int) -> mpf | None:
    """An angle with a cos + b sin = c, or none."""
    reach = mpmath.sqrt(a * a + b * b)
    return None if abs(c) > reach else mpmath.atan2(b, a) + side * mpmath.acos(c / reach)


def shortest_turn(was: Vector, now: Vector, v: Vector) -> Vector:
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
