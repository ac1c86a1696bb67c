"""A type of suspension: what may be said of it, and how its drawing becomes a linkage."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from absolute.description import Corner, Model, Vector, plain, point_of, unit_of, vector_of
from absolute.errors import DescriptionError
from absolute.solution import Array

# `up` and `right` are axes of one car. 1e-6 rad lets rounded directions pass and stops wrong ones.
LARGEST_SKEW = 1e-6

# Where outboard is, along right.
SIDES = {"left": -1.0, "right": 1.0}


@dataclass(frozen=True)
class Drawn:
    """A drawing, checked.

    Attributes:
        place: point name -> (3,) coordinates, mm.
        bodies: body name -> names of its points, without those that are not drawn.
        up, right, outboard: (3,) unit vectors.
        closure: one of those that the type knows.
    """

    place: Mapping[str, Array]
    bodies: Mapping[str, tuple[str, ...]]
    up: Array
    right: Array
    outboard: Array
    closure: str

    @property
    def points(self) -> dict[str, Vector]:
        """Coordinates as plain numbers."""
        return {name: plain(place) for name, place in self.place.items()}

    def corner(self, wheel_axis: tuple[str, str], steering_axis: tuple[str, str]) -> Corner:
        """The corner of the car whose wheel the body `knuckle` carries."""
        directions = (plain(direction) for direction in (self.up, self.right, self.outboard))
        return Corner("knuckle", wheel_axis, steering_axis, *directions)

    def line(self, start: str, end: str) -> Array:
        """Unit vector from one drawn point to another."""
        line = self.place[end] - self.place[start]
        if not np.any(line):
            where = plain(self.place[start])
            raise DescriptionError(
                f"points {start!r} and {end!r} coincide at {where}; move one of them", start, where
            )
        return unit_of(start, plain(line))


@dataclass(frozen=True)
class Suspension:
    """A type of suspension; called with a drawing it gives the linkage.

    Attributes:
        title: with its article, for messages.
        bodies: body name -> names of its points; the first is the chassis.
        optional: point that need not be drawn -> point that stands in for it. Where both belong to one
            body, the stand-in does its work and there is no such point; otherwise it is put there.
        closures: ways to close a drawing that does not close.
        inputs: names of the driven coordinates.
        linkage: gives the model of a checked drawing.
    """

    title: str
    bodies: Mapping[str, tuple[str, ...]]
    optional: Mapping[str, str]
    closures: tuple[str, ...]
    inputs: tuple[str, ...]
    linkage: Callable[[Drawn], Model]

    @property
    def points(self) -> tuple[str, ...]:
        """Names of all points, those that may be left out last.

        The middle of a car is a sum over its points: their order is that of the sum, and so of the digits.
        """
        every = tuple(dict.fromkeys(point for names in self.bodies.values() for point in names))
        return tuple(sorted(every, key=self._may_be_left_out))

    def __call__(
        self,
        points: Mapping[str, Sequence[float]],
        *,
        up: Sequence[float] = (0.0, 0.0, 1.0),
        right: Sequence[float] = (0.0, 1.0, 0.0),
        side: str = "left",
        closure: str = "drawn",
    ) -> Model:
        """The linkage of a drawing.

        Args:
            points: all those of the type, mm; those named in `optional` if wanted.
            up, right: where the car's up and right point in the frame of the points; any length.
            side: "left" or "right", the side of the car whose wheel it is; it decides the signs of effects.
            closure: one of `closures`.
        Raises:
            DescriptionError: a point is missing, unknown, not finite or beyond LARGEST_COORDINATE; the
                side or the closure is unknown; up and right are no directions at a right angle; points that
                make an axis coincide.
        """
        if closure not in self.closures:
            raise DescriptionError(
                f"closure is {closure!r}; it must be one of {list(self.closures)}", "closure", closure
            )
        if side not in SIDES:
            raise DescriptionError(f"side is {side!r}; it must be one of {list(SIDES)}", "side", side)
        place = self._places(points)
        upward, rightward = (
            unit_of("up", vector_of("up", "up", up)),
            unit_of("right", vector_of("right", "right", right)),
        )
        skew = float(upward @ rightward)
        if abs(skew) > LARGEST_SKEW:
            raise DescriptionError(
                f"up and right are {np.degrees(np.arccos(skew)):.6g} degrees apart; a right angle is needed",
                "right",
                skew,
            )
        bodies = {
            body: tuple(point for point in names if point in place) for body, names in self.bodies.items()
        }
        return self.linkage(Drawn(place, bodies, upward, rightward, SIDES[side] * rightward, closure))

    def _places(self, points: Mapping[str, Sequence[float]]) -> dict[str, Array]:
        needed = [name for name in self.points if name not in self.optional]
        missing = sorted(set(needed) - set(points))
        unknown = sorted(set(points) - set(self.points))
        if missing or unknown:
            raise DescriptionError(
                f"{self.title} has the points {needed} and, if wanted, {list(self.optional)}; "
                f"missing: {missing}, unknown: {unknown}",
                (missing or unknown)[0],
            )
        put = {
            name: points[other] for name, other in self.optional.items() if not self._may_be_left_out(name)
        }
        given = {**put, **points}
        return {name: np.array(point_of(name, given[name])) for name in self.points if name in given}

    def _may_be_left_out(self, point: str) -> bool:
        pair = {point, self.optional.get(point)}
        return any(pair <= set(names) for names in self.bodies.values()) and point in self.optional
