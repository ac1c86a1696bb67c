"""A corner of the car in any kind of number, and the definition of an effect, a number of a pose."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from validate.reference.car_data import LENGTHS, LINES, RADIUS, WHEEL, car_data, corners
from validate.reference.chassis import ChassisMotion
from validate.reference.jet import slope_of, value_of
from validate.reference.kinematics import body_rates
from validate.reference.vectors import Exact, Scalar, Vector, cross, dot, each, length, minus, plus, times


@dataclass(frozen=True)
class Effect:
    """A number of a pose.

    Attributes:
        name: its name in results, without the prefix of a part.
        unit: unit of the number, a unit or a quotient of two.
        needs: what the car must have: lines by their roles, a moving knuckle, an entry of `car_data`, exactly
            one driven input of the kind `along`; with `PAIR` two parts on opposite sides, each with all this.
        evaluate: computes the number from a `Car`, or with `PAIR` from the left and the right one, in their
            kind of scalar and unit of length; not a finite ball if the number is undefined.
        along: None, or the variable of the derivatives, if the numbers of the car are duals. `TRAVEL`: the
            one driven input that is not the travel of a slide, in any unit. `RACK`: the one that is, in the
            car's unit of length. `ROLL`: the one that rolls the chassis, rad. The other inputs are constant.
            `TIME`: time; all inputs move.
    """

    name: str
    unit: str
    needs: tuple[str, ...]
    evaluate: Callable[..., Scalar]
    along: str | None = None

    @property
    def power(self) -> int:
        """Power of the car's unit of length in the number."""
        # A force is the rate of a spring, N/mm, times a length.
        above, below = (int(part in ("mm", "N")) for part in f"{self.unit}/".split("/")[:2])
        return above - below


@dataclass(frozen=True)
class Line:
    """A line from one point to another."""

    start: Vector
    end: Vector

    @property
    def along(self) -> Vector:
        """The end minus the start."""
        return minus(self.end, self.start)


@dataclass(frozen=True)
class Car:
    """A corner of the car, as drawn or at a pose; all lengths in one unit, without the chassis' displacement.

    Attributes:
        ends: the two points of each of `LINES` that a role names: inner point and centre of the wheel, lower
            and upper point of the steering axis, ends of the damper.
        lines: these lines, after the turns of the chassis.
        on_chassis: the lines before the turns of the chassis.
        up, forward, outboard: unit vectors, which do not turn with the chassis; forward is up x right,
            outboard leads away from the car's middle.
        side: 1 for a right wheel, -1 for a left one.
        origin: origin of the user's coordinates, a point of the car's middle plane.
        data: data of the whole car, see `car_data`.
        knuckle: two vectors fixed in the wheel's carrier, after the turns of the chassis; None if not given.
        drawing: the corner as drawn, before closing; None if this is it.
    """

    ends: Mapping[str, tuple[str, str]]
    lines: Mapping[str, Line]
    on_chassis: Mapping[str, Line]
    up: Vector
    forward: Vector
    outboard: Vector
    side: int
    origin: Vector
    data: Mapping[str, Scalar]
    knuckle: tuple[Vector, Vector] | None = None
    drawing: Car | None = None

    @classmethod
    def of(
        cls,
        plain: Mapping[str, Any],
        prefix: str,
        points: Mapping[str, Vector],
        origin: Vector,
        unit: Any,
        number: Exact,
    ) -> Car:
        """The corner of a description whose names have a prefix, as drawn.

        Args:
            points: as drawn, (p - origin) / unit.
            number: converts a fraction or float to the kind of number of the poses.
        """
        named = {role: plain["roles"].get(prefix + role) for role in LINES}
        ends = {role: (points[0], points[1]) for role, points in named.items() if points is not None}
        lines = {role: Line(*(each(number, points[name]) for name in both)) for role, both in ends.items()}
        up, right, side = plain["up"], plain["right"], corners(plain)[prefix]
        return cls(
            ends=ends,
            lines=lines,
            on_chassis=lines,
            up=each(number, up),
            forward=each(number, cross(up, right)),
            outboard=each(number, times(right, side)),
            side=side,
            origin=each(number, times(origin, -1 / unit)),
            data={key: number(x / unit if key in LENGTHS else x) for key, x in car_data(plain).items()},
        )

    def at(
        self,
        chassis: ChassisMotion,
        places: Mapping[str, Vector],
        knuckle: tuple[Vector, Vector] | None = None,
    ) -> Car:
        """The drawn corner at a pose.

        Args:
            chassis: its motion, with derivatives if the places have a derivative.
            places: positions of the lines' points, relative to the chassis.
            knuckle: two vectors fixed in the wheel's carrier, relative to the chassis.
        """
        car = chassis.turns
        lines = {role: Line(places[start], places[end]) for role, (start, end) in self.ends.items()}
        turned = {role: Line(car.place(one.start), car.place(one.end)) for role, one in lines.items()}
        frame = None if knuckle is None else (car.turned(knuckle[0]), car.turned(knuckle[1]))
        return replace(self, lines=turned, on_chassis=lines, knuckle=frame, drawing=self)

    @property
    def drawn(self) -> Car:
        """The corner as drawn."""
        return self.drawing or self

    @property
    def points(self) -> tuple[str, ...]:
        """The points of its lines."""
        return tuple(dict.fromkeys(point for ends in self.ends.values() for point in ends))

    @property
    def wheel(self) -> Line:
        """The wheel's spin axis; its end is the wheel centre."""
        return self.lines[WHEEL]

    @property
    def contact(self) -> Vector:
        """The contact point."""
        return self.contact_of(self.wheel)

    def contact_of(self, wheel: Line) -> Vector:
        """The lowest point of the wheel as a thin disc about a spin axis a: c = W - R m / |m| with
        m = up (a . a) - a (a . up).

        m is the component of `up` in the disc's plane, times a . a.
        """
        a, up = wheel.along, self.up
        across = minus(times(up, dot(a, a)), times(a, dot(a, up)))
        return minus(wheel.end, times(across, self.data[RADIUS] / length(across)))

    @property
    def turning(self) -> Vector:
        """omega, the angular velocity of the wheel's carrier, from the slopes of `knuckle`."""
        assert self.knuckle is not None
        return body_rates(*self.knuckle, 1)[0]

    def velocity(self, place: Vector) -> Vector:
        """Of the carrier's point at a place p: W' + omega x (p - W)."""
        arm = minus(each(value_of, place), each(value_of, self.wheel.end))
        return plus(each(slope_of, self.wheel.end), cross(self.turning, arm))
