"""One wheel of a car as effects see it: its roles, lines and contact point, and how its knuckle moves.

Of three points p_0, p_1, p_2 of the knuckle with e1 = p_1 - p_0 and e2 = p_2 - p_0, a vector that is fixed in
it is a e1 + b e2 + c n, n = e1 x e2, with constant a, b, c; so its derivative is a e1' + b e2' + c n'. Of
the angular velocity w it is w x the vector, so that

    |n|^2 w = (e1' . e2) n - (e1' . n) e2 + (e2' . n) e1.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Generic

import numpy as np

from pointcoord.effects.arithmetic import (
    Dual,
    P,
    S,
    cross,
    dot,
    linear,
    ratio,
    reciprocal,
    root,
    still,
    times,
)
from pointcoord.linkage.car_axes import Direction
from pointcoord.linkage.slopes import ByInput
from pointcoord.linkage.topology import Topology

# Of a velocity: rates of solved points are off by some 1e-14 of themselves, and by far more near a singular
# pose, so that a part as small as this may be none.
LEAST_PART = 1e-9


@dataclass(frozen=True)
class Wheel:
    """One wheel of a mechanism: of all of it, or of a part, whose names begin with the part's and a dot.

    Attributes:
        part: its name; empty for the whole mechanism.
    """

    topology: Topology
    part: str = ""

    @classmethod
    def of(cls, topology: Topology, number: str) -> Wheel:
        """The wheel that a number is of, by the number's name."""
        return cls(topology, number.rpartition(".")[0])

    @property
    def prefix(self) -> str:
        """What its names begin with."""
        return f"{self.part}." if self.part else ""

    @property
    def side(self) -> str:
        """The side of the car that the part is on; empty for the whole mechanism, whose scene says it."""
        return self.topology.sides.get(self.part, "")

    @property
    def centre(self) -> str:
        return self.role("wheel_axis")[1]

    def role(self, name: str) -> tuple[str, ...]:
        return self.topology.role(self.prefix + name)

    def driven(self, way: str) -> tuple[str, ...]:
        return self.topology.driven_along(way, self.part)

    def way(self, way: str) -> ByInput:
        """The way by the one input of these; by none where the part that is solved for has none."""
        return ByInput("".join(self.driven(way)[:1]))


def wheels_of(topology: Topology, roles: Iterable[str]) -> tuple[Wheel, ...]:
    """The wheels of a mechanism that have all of some roles."""
    wheels = (Wheel(topology, part) for part in ("", *topology.sides))
    return tuple(wheel for wheel in wheels if all(map(wheel.role, roles)))


@dataclass(frozen=True, eq=False)
class View(Generic[S]):
    """The points of a wheel, seen along the car's directions.

    Attributes:
        of: the wheel, whose roles name the points.
        points: places, as vectors.
        component: of a vector without slopes, along a direction.
        up, outboard: these directions, as vectors.
        radius: of the wheel.
    """

    of: Wheel
    points: Mapping[str, S]
    component: Callable[..., Any]
    up: S
    outboard: S
    radius: S

    def along(self, vector: P, direction: Direction) -> P:
        """The component of a vector along a direction, of a dual with its slope."""
        return linear(self.component, vector, direction)

    def role(self, name: str) -> S:
        """The vector from the first point of a role to its second."""
        return self.line(*self.of.role(name)[:2])

    def line(self, start: str, end: str) -> S:
        return self.points[end] - self.points[start]

    @property
    def spin(self) -> S:
        """The wheel's spin axis a, from its inner point to the wheel centre."""
        return self.role("wheel_axis")

    def contact_place(self) -> S:
        return self.points[self.of.centre] + self.contact()

    def contact(self) -> S:
        """From the wheel centre to the lowest point of a thin disc about the spin axis.

        -r d / |d| with d = up - (up . a) a / (a . a), what of up lies in the disc.
        """
        a = self.spin
        in_disc = self.up - times(ratio(dot(self.up, a), dot(a, a)), a)
        return times(-ratio(self.radius, root(dot(in_disc, in_disc))), in_disc)


@dataclass(frozen=True, eq=False)
class Corner(Generic[S]):
    """One wheel of a pose.

    Attributes:
        seen: its points after the turns of the chassis, from anywhere.
        chassis: the same in the chassis' frame.
        drawn: the same as drawn.
        origin: from the user's origin to that of the points.
        car: what the scene says of the whole car, by name; lengths in the unit of the points.
    """

    seen: View[S]
    chassis: View[S]
    drawn: View[S]
    origin: S
    car: Mapping[str, S]

    def moved(self) -> S:
        """How far the contact point has gone from its drawn place."""
        return _moved(self.seen, self.drawn) + (self.seen.contact() - self.drawn.contact())

    def moved_in_chassis(self) -> S:
        """The same in the chassis' frame, of a disc that hangs along the chassis' up."""
        return _moved(self.chassis, self.drawn) + (self.chassis.contact() - self.drawn.contact())

    def risen(self) -> S:
        """How far the wheel centre has gone up in the chassis' frame."""
        return self.chassis.along(_moved(self.chassis, self.drawn), "up")

    def moving(self, slopes: tuple[Mapping[str, Any], Mapping[str, Any]]) -> Corner[Dual[Any]]:
        """The same with derivatives of its points; directions, the drawing and the radius have none.

        Args:
            slopes: of the points seen and in the chassis' frame.
        """

        def held(part: Any) -> Dual[Any]:
            return Dual(part, still(part))

        def dual(view: View[Any], points: Mapping[str, Dual[Any]]) -> View[Dual[Any]]:
            up, outboard, radius = (held(part) for part in (view.up, view.outboard, view.radius))
            return View(view.of, points, view.component, up, outboard, radius)

        def moved(view: View[Any], slope: Mapping[str, Any]) -> View[Dual[Any]]:
            return dual(view, {n: Dual(p, slope[n]) for n, p in view.points.items() if n in slope})

        drawn = dual(self.drawn, {name: held(place) for name, place in self.drawn.points.items()})
        car = {name: held(number) for name, number in self.car.items()}
        seen, chassis = moved(self.seen, slopes[0]), moved(self.chassis, slopes[1])
        return Corner(seen, chassis, drawn, held(self.origin), car)


def _moved(view: View[S], drawn: View[S]) -> S:
    centre = view.of.centre
    return view.points[centre] - drawn.points[centre]


def contact_place(corner: Corner[Dual[Any]]) -> Any:
    """Where the contact point is."""
    return corner.seen.contact_place().value


def velocity_at(corner: Corner[Dual[Any]], place: Any) -> Any:
    """The derivative of the point of the knuckle that is at a place."""
    base = corner.seen.points[corner.seen.of.role("knuckle")[0]]
    return base.slope + turning_of(corner, place - base.value)


def turning_of(corner: Corner[Dual[Any]], vector: Any) -> Any:
    """The derivative of a vector that is fixed in the knuckle."""
    e1, e2, normal = _frame(corner)
    n = normal.value
    square = dot(n, n)
    a = ratio(dot(cross(vector, e2.value), n), square)
    b = ratio(dot(cross(e1.value, vector), n), square)
    c = ratio(dot(vector, n), square)
    return times(a, e1.slope) + times(b, e2.slope) + times(c, normal.slope)


def told_from_none(part: Any, *of: Any) -> Any:
    """A part of a velocity; no number where rounding does not tell it from none.

    Args:
        of: the velocity, and vectors as long as what it is made of.
    """
    if not isinstance(part, np.ndarray):
        return part
    whole = sum(np.linalg.norm(vector, axis=-1) for vector in of)
    return np.where(np.abs(part) > LEAST_PART * whole, part, np.nan)


def rising(corner: Corner[Dual[Any]]) -> Any:
    """The derivative of the travel of the wheel centre; no number where the wheel does not travel."""
    view = corner.chassis
    return told_from_none(corner.risen().slope, view.points[view.of.centre].slope)


def angular_velocity(corner: Corner[Dual[Any]]) -> Any:
    """The turn of the knuckle along the way, rad per unit of the input."""
    e1, e2, _ = _frame(corner)
    return turn_of_edges(e1.value, e2.value, e1.slope, e2.slope)


def turn_of_edges(e1: P, e2: P, v1: P, v2: P) -> P:
    """The angular velocity of two edges of a body, from their derivatives."""
    n = cross(e1, e2)
    along = times(dot(v1, e2), n)
    across = times(dot(v2, n), e1) - times(dot(v1, n), e2)
    return times(reciprocal(dot(n, n)), along + across)


def _frame(corner: Corner[Dual[Any]]) -> tuple[Dual[Any], Dual[Any], Dual[Any]]:
    view = corner.seen
    base, first, second = (view.points[name] for name in view.of.role("knuckle")[:3])
    e1, e2 = first - base, second - base
    return e1, e2, cross(e1, e2)


def at_rest(view: View[Dual[Any]]) -> View[Any]:
    """What is seen, without derivatives."""
    points = {name: place.value for name, place in view.points.items()}
    return View(view.of, points, view.component, view.up.value, view.outboard.value, view.radius.value)
