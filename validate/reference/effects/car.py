"""A wheel's corner of the car as its effects see it: lines through points that roles name, in any number."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from validate.reference.car_data import LENGTHS, RADIUS, car_data, corners
from validate.reference.vectors import Scalar, Vector, cross, dot, each, length, minus, times

WHEEL, STEERING, DAMPER = LINES = ("wheel_axis", "steering_axis", "damper")
KNUCKLE = "knuckle"


@dataclass(frozen=True)
class Line:
    """From one point to another.

    Attributes:
        along: end - start; whoever knows it more exactly than both points says it apart.
    """

    start: Vector
    end: Vector
    along: Vector


Lines = Mapping[str, Line]
Frame = tuple[Vector, Vector]


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
    lines: Lines
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
        number: Callable[[Any], Scalar],
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
    lines: Lines
    on_chassis: Lines
    knuckle: Frame | None = None

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
    def rearward(self) -> Vector:
        """Unit vector."""
        return times(self.forward, -1)

    @property
    def is_right(self) -> bool:
        """Whether outboard is the right of the car, which is forward x up."""
        return bool(dot(self.outboard, cross(self.forward, self.up)) > 0)

    @property
    def wheel(self) -> Line:
        """The wheel's spin axis; its end is the wheel centre."""
        return self.lines[WHEEL]

    @property
    def steering(self) -> Line:
        """The steering axis, from below."""
        return self.lines[STEERING]

    @property
    def contact(self) -> Vector:
        """The contact point, see `contact_of`."""
        return contact_of(self.drawn, self.wheel)


def lines_of(ends: Mapping[str, tuple[str, str]], points: Mapping[str, Vector]) -> dict[str, Line]:
    """The lines through these points."""
    both = {role: (points[start], points[end]) for role, (start, end) in ends.items()}
    return {role: Line(start, end, minus(end, start)) for role, (start, end) in both.items()}


def contact_of(drawn: DrawnCar, wheel: Line) -> Vector:
    """The lowest point of a thin disc about a spin axis a: c = W - R m / |m|, m = up (a . a) - a (a . up).

    That is the part of `up` in the disc's plane, times a . a.
    """
    a, up = wheel.along, drawn.up
    across = minus(times(up, dot(a, a)), times(a, dot(a, up)))
    return minus(wheel.end, times(across, drawn.data[RADIUS] / length(across)))
