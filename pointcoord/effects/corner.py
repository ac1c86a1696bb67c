"""One wheel of a car as effects see it: its roles, its lines, and its contact point."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Generic

from pointcoord.effects.arithmetic import Dual, P, S, dot, linear, ratio, root, still, times
from pointcoord.linkage.car_axes import Direction
from pointcoord.linkage.slopes import ByInput
from pointcoord.linkage.topology import Topology


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
