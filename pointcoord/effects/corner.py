"""One wheel of a car for the effects: its roles, lines and contact point, and the motion of its knuckle.

Let p_0, p_1, p_2 be three points of the knuckle, e1 = p_1 - p_0, e2 = p_2 - p_0 and n = e1 x e2. A vector
fixed in the knuckle is a e1 + b e2 + c n with constant a, b, c, so its derivative is a e1' + b e2' + c n'. It
is also w x the vector, with the angular velocity w, so that

    |n|^2 w = (e1' . e2) n - (e1' . n) e2 + (e2' . n) e1.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Generic

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
from pointcoord.effects.effect import Poses
from pointcoord.linkage.directions import CarAxes, Direction
from pointcoord.linkage.slopes import ByInput
from pointcoord.linkage.topology import Topology

if TYPE_CHECKING:
    from pointcoord.bounds.enclosed_points import EnclosedPoses

LENGTHS = ("wheelbase", "centre_of_gravity_height", "spring_free_length")
"""The car data that are lengths."""
# Share of a velocity. Rates of solved points have relative errors of some 1e-14, and far larger ones near a
# singular pose, so a component as small as this may be zero.
LEAST_PART = 1e-9


@dataclass(frozen=True)
class Wheel:
    """One wheel of a mechanism without parts, or of a part, whose names begin with the part and a dot.

    Attributes:
        part: name of the part; empty for a mechanism without parts.
    """

    topology: Topology
    part: str = ""

    @classmethod
    def of(cls, topology: Topology, number: str) -> Wheel:
        """The wheel that a number of the car belongs to, from the number's name."""
        return cls(topology, number.rpartition(".")[0])

    @property
    def prefix(self) -> str:
        """The prefix of the wheel's names."""
        return f"{self.part}." if self.part else ""

    @property
    def side(self) -> str:
        """The part's side of the car; empty for a mechanism without parts, whose scene gives the side."""
        return self.topology.sides.get(self.part, "")

    @property
    def centre(self) -> str:
        return self.role("wheel_axis")[1]

    def role(self, name: str) -> tuple[str, ...]:
        return self.topology.role(self.prefix + name)

    def driven(self, way: str) -> tuple[str, ...]:
        return self.topology.driven_along(way, self.part)

    def way(self, way: str) -> ByInput:
        """The way by the one driven input of a kind; by no input if the part to be solved has none."""
        return ByInput("".join(self.driven(way)[:1]))


def wheels_of(topology: Topology, roles: Iterable[str]) -> tuple[Wheel, ...]:
    """The wheels of a mechanism that have all of these roles."""
    wheels = (Wheel(topology, part) for part in ("", *topology.sides))
    return tuple(wheel for wheel in wheels if all(map(wheel.role, roles)))


@dataclass(frozen=True, eq=False)
class View(Generic[S]):
    """The points of a wheel, seen along the car's directions.

    Attributes:
        of: the wheel, whose roles name the points.
        points: places, as vectors.
        axes: the car's axes, for its components.
        up, outboard: these directions as vectors.
        radius: radius of the wheel.
    """

    of: Wheel
    points: Mapping[str, S]
    axes: CarAxes
    up: S
    outboard: S
    radius: S

    def along(self, vector: P, direction: Direction) -> P:
        """The component of a vector along a direction; for a dual, with its derivative."""
        return linear(self.axes.component, vector, direction)

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

        -r d / |d| with d = up - (up . a) a / (a . a), the part of up that lies in the disc.
        """
        a = self.spin
        in_disc = self.up - times(ratio(dot(self.up, a), dot(a, a)), a)
        return times(-ratio(self.radius, root(dot(in_disc, in_disc))), in_disc)


@dataclass(frozen=True, eq=False)
class Corner(Generic[S]):
    """One wheel in a pose.

    Attributes:
        seen: its points after the rotations of the chassis, from any origin.
        chassis: its points in the chassis' frame.
        drawn: its points as drawn.
        origin: from the user's origin to the points' origin.
        car: the scene's data of the whole car by name; lengths in the points' unit.
    """

    seen: View[S]
    chassis: View[S]
    drawn: View[S]
    origin: S
    car: Mapping[str, S]

    def moved(self, view: View[S]) -> S:
        """Displacement of the contact point from its drawn place, in one of the views."""
        return self._moved(view) + (view.contact() - self.drawn.contact())

    def risen(self) -> S:
        """Displacement of the wheel centre along up in the chassis' frame."""
        return self.chassis.along(self._moved(self.chassis), "up")

    def _moved(self, view: View[S]) -> S:
        return view.points[view.of.centre] - self.drawn.points[view.of.centre]


def corner_of(
    poses: Poses | EnclosedPoses,
    wheel: Wheel,
    slopes: tuple[Mapping[str, Any], Mapping[str, Any]] | None = None,
) -> Corner[Any]:
    """One wheel of poses, in their unit of length.

    Args:
        slopes: derivatives of the points after and before the rotations of the chassis, which make the
            corner one of duals; those of directions, drawing, radius and data are zero.
    """
    axes, unit = poses.axes.on(wheel.side), poses.unit

    def fixed(number: Any) -> Any:
        return number if slopes is None else Dual(number, still(number))

    def constant(number: Any) -> Any:
        return fixed(poses.constant(np.asarray(number)))

    def moving(points: Mapping[str, Any], which: int) -> Mapping[str, Any]:
        if slopes is None:
            return points
        return {n: Dual(place, slopes[which][n]) for n, place in points.items() if n in slopes[which]}

    radius = constant(np.nan if axes.wheel_radius is None else axes.wheel_radius / unit)
    up, outboard = constant(axes.up), constant(axes.outboard)
    # A part of a mechanism may be solved without the wheel's axis, such as for the damper's length.
    drawn = {name: fixed(poses.drawn[name]) for name in wheel.role("wheel_axis") if name in poses.drawn}
    seen, chassis, drawn_view = (
        View(wheel, points, axes, up, outboard, radius)
        for points in (moving(poses.points[0], 0), moving(poses.in_chassis[0], 1), drawn)
    )
    car = {n: constant(number / unit if n in LENGTHS else number) for n, number in axes.car.items()}
    return Corner(seen, chassis, drawn_view, fixed(poses.origin), car)


def contact_place(corner: Corner[Dual[Any]]) -> Any:
    """The place of the contact point."""
    return corner.seen.contact_place().value


def velocity_at(corner: Corner[Dual[Any]], place: Any) -> Any:
    """The derivative of the knuckle's point at a place."""
    base = corner.seen.points[corner.seen.of.role("knuckle")[0]]
    return base.slope + turning_of(corner, place - base.value)


def turning_of(corner: Corner[Dual[Any]], vector: Any) -> Any:
    """The derivative of a vector fixed in the knuckle."""
    e1, e2, normal = _frame(corner)
    n = normal.value
    square = dot(n, n)
    a = ratio(dot(cross(vector, e2.value), n), square)
    b = ratio(dot(cross(e1.value, vector), n), square)
    c = ratio(dot(vector, n), square)
    return times(a, e1.slope) + times(b, e2.slope) + times(c, normal.slope)


def above_rounding(part: Any, *of: Any) -> Any:
    """A component of a velocity; NaN where rounding may hide that it is zero.

    Args:
        of: the velocity, and vectors of the size of the terms that it is computed from.
    """
    if not isinstance(part, np.ndarray):
        return part
    whole = sum(np.linalg.norm(vector, axis=-1) for vector in of)
    return np.where(np.abs(part) > LEAST_PART * whole, part, np.nan)


def rising(corner: Corner[Dual[Any]]) -> Any:
    """The derivative of the wheel centre's travel; NaN where the wheel does not travel."""
    view = corner.chassis
    return above_rounding(corner.risen().slope, view.points[view.of.centre].slope)


def angular_velocity(corner: Corner[Dual[Any]]) -> Any:
    """Angular velocity of the knuckle along the way, rad per unit of the input."""
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
    """A view without derivatives."""
    points = {name: place.value for name, place in view.points.items()}
    return View(view.of, points, view.axes, view.up.value, view.outboard.value, view.radius.value)
