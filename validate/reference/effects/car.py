"""A wheel's corner of the car in any kind of number, and what an effect is: one number that a pose has."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from typing import Any

from validate.reference.car_data import LENGTHS, LINES, RADIUS, WHEEL, car_data, corners
from validate.reference.vectors import Exact, Scalar, Vector, cross, dot, each, length, minus, times


@dataclass(frozen=True)
class Effect:
    """A number of a pose.

    Attributes:
        name: what results call it, behind the prefix of its part if there are parts.
        unit: of the number, a unit or a quotient of two.
        needs: what the car must have: lines by their roles, a knuckle that moves, an entry of `car_data`,
            exactly one driven input that goes along; with `PAIR` two parts on opposite sides, which each do.
        evaluate: the number of a `Car`, or with `PAIR` of the left and the right one, in their kind of scalar
            and their lengths; not a finite ball where it is undefined.
        along: None, or `TRAVEL`, `RACK`, `ROLL` or `TIME`: the numbers of the car are duals, whose slopes are
            by the one driven input that is not the travel of a slide, in any unit, by the one that is, in the
            car's own lengths, or by the one that rolls the chassis, rad, while the others rest; or by time,
            as all of them move.
    """

    name: str
    unit: str
    needs: tuple[str, ...]
    evaluate: Callable[..., Scalar]
    along: str | None = None

    @property
    def power(self) -> int:
        """Of a unit of length, which the number in the car's own lengths is multiplied by."""
        # A force is the rate of a spring, N/mm, times a length.
        above, below = (int(part in ("mm", "N")) for part in f"{self.unit}/".split("/")[:2])
        return above - below

    def of(self, has: Collection[str]) -> bool:
        """Whether a car that has these has the number."""
        return {*self.needs} <= {*has}


@dataclass(frozen=True)
class Line:
    """From one point to another."""

    start: Vector
    end: Vector

    @property
    def along(self) -> Vector:
        """The one less the other."""
        return minus(self.end, self.start)


@dataclass(frozen=True)
class DrawnCar:
    """What effects know of a corner beside its pose; lengths in any unit, the same in all.

    Attributes:
        ends: of each of `LINES` that a role names its points: of the wheel's spin axis its inner point and
            the wheel centre, of the steering axis its lower and its upper point, of the damper its ends.
        lines: as drawn, neither closed nor turned.
        up: unit vector.
        forward: unit vector, up x right.
        outboard: unit vector, away from the car's middle.
        origin: where the user's coordinates have theirs, a point of the car's middle plane.
        data: what is given of the car as a whole, see `car_data`.
    """

    ends: Mapping[str, tuple[str, str]]
    lines: Mapping[str, Line]
    up: Vector
    forward: Vector
    outboard: Vector
    origin: Vector
    data: Mapping[str, Scalar]

    @classmethod
    def of(
        cls,
        plain: Mapping[str, Any],
        prefix: str,
        points: Mapping[str, Vector],
        origin: Vector,
        unit: Any,
        number: Exact,
    ) -> DrawnCar:
        """A description's corner.

        Args:
            prefix: of its names.
            points: as drawn, (p - origin) / unit.
            number: what is given in the kind of number of the poses.
        """
        named = {role: plain["roles"].get(prefix + role) for role in LINES}
        ends = {role: (points[0], points[1]) for role, points in named.items() if points is not None}
        drawn = {name: each(number, points[name]) for both in ends.values() for name in both}
        up, right = plain["up"], plain["right"]
        return cls(
            ends=ends,
            lines=lines_of(ends, drawn),
            up=each(number, up),
            forward=each(number, cross(up, right)),
            outboard=each(number, times(right, corners(plain)[prefix])),
            origin=each(number, times(origin, -1 / unit)),
            data={k: number(x / unit if k in LENGTHS else x) for k, x in car_data(plain).items()},
        )

    @property
    def points(self) -> tuple[str, ...]:
        """The points of its lines."""
        return tuple(dict.fromkeys(point for ends in self.ends.values() for point in ends))

    @property
    def contact(self) -> Vector:
        """The contact point as drawn."""
        return contact_of(self, self.lines[WHEEL])


@dataclass(frozen=True)
class Car:
    """A pose of a corner. A displacement of the chassis is in none of its lines.

    Attributes:
        drawn: what it is a pose of; its unit vectors do not turn with the chassis.
        lines: with the chassis turned.
        on_chassis: before its turns.
        knuckle: two vectors fixed in the wheel's carrier, with the chassis turned; None where nobody says it.
    """

    drawn: DrawnCar
    lines: Mapping[str, Line]
    on_chassis: Mapping[str, Line]
    knuckle: tuple[Vector, Vector] | None = None

    @property
    def up(self) -> Vector:
        """Unit vector."""
        return self.drawn.up

    @property
    def forward(self) -> Vector:
        """Unit vector."""
        return self.drawn.forward

    @property
    def outboard(self) -> Vector:
        """Unit vector."""
        return self.drawn.outboard

    @property
    def is_right(self) -> bool:
        """Whether outboard is the right of the car, which is forward x up."""
        return bool(dot(self.outboard, cross(self.forward, self.up)) > 0)

    @property
    def wheel(self) -> Line:
        """The wheel's spin axis; its end is the wheel centre."""
        return self.lines[WHEEL]

    @property
    def contact(self) -> Vector:
        """The contact point, see `contact_of`."""
        return contact_of(self.drawn, self.wheel)


def lines_of(ends: Mapping[str, tuple[str, str]], points: Mapping[str, Vector]) -> dict[str, Line]:
    """The lines through these points."""
    return {role: Line(points[start], points[end]) for role, (start, end) in ends.items()}


def contact_of(drawn: DrawnCar, wheel: Line) -> Vector:
    """The lowest point of a thin disc about a spin axis a: c = W - R m / |m|, m = up (a . a) - a (a . up).

    That is the part of `up` in the disc's plane, times a . a.
    """
    a, up = wheel.along, drawn.up
    across = minus(times(up, dot(a, a)), times(a, dot(a, up)))
    return minus(wheel.end, times(across, drawn.data[RADIUS] / length(across)))
