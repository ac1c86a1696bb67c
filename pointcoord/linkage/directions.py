"""Named directions of a car: computed from its axes `up` and `right`, and seen from one of its wheels."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Literal, TypeVar

import numpy as np

from pointcoord.numerics import enclosure, vectors
from pointcoord.numerics.arrays import Array
from pointcoord.numerics.double_double import Pair, pair_cross, pair_dot, pair_quotient, pair_root
from pointcoord.numerics.enclosure import Enclosed

V = TypeVar("V", Array, Enclosed)

DIRECTIONS = ("up", "right", "down", "left", "forward", "rearward")
AXIS = "axis "

Direction = Literal["up", "down", "outboard", "inboard", "rearward", "forward", "to_the_left"]
SIGNS = {"left": -1.0, "right": 1.0}
"""Side of the car -> sign of the outboard direction along right."""
OPPOSITE: Mapping[Direction, Direction] = {"down": "up", "inboard": "outboard", "forward": "rearward"}


def axis_along(direction: str) -> str:
    """Name of a rotation axis along a direction, which has unit length to twice the working precision.

    Direction vectors in doubles have unit length to one rounding only, and rotations would change lengths.
    """
    return f"{AXIS}{direction}"


def car_directions(up: Array, right: Array) -> dict[str, Pair]:
    """Each direction as high and low part, shape (..., 3); forward is up x right, to twice the precision."""
    none = np.zeros_like(up), np.zeros_like(right)
    high, low = pair_cross((up, none[0]), (right, none[1]))
    return {
        "up": (up, none[0]),
        "right": (right, none[1]),
        "down": (-up, none[0]),
        "left": (-right, none[1]),
        "forward": (high, low),
        "rearward": (-high, -low),
    }


def direction_of(car: Mapping[str, Pair], name: str) -> Pair:
    """A direction of the car, or the axis along one (see `axis_along`)."""
    return car[name] if name in car else unit_pair(car[name.removeprefix(AXIS)])


def unit_pair(vector: Pair) -> Pair:
    """A vector divided by its length, (..., 3), to twice the precision."""
    high, low = pair_root(pair_dot(vector, vector))
    return pair_quotient(vector, (high[..., None], low[..., None]))


@dataclass(frozen=True, eq=False)
class CarAxes:
    """Directions of the car for one wheel, as unit vectors (..., 3), with the scene's wheel and car data.

    Attributes:
        up, right: the scene's axes; rearward is right x up.
        outboard: away from the car's middle, on the side of the wheel. An outboard line that turns to the
            left goes `to_the_left`, up x outboard.
        wheel_radius: mm; None where the scene has none.
        car: data of the whole car by name: lengths in mm, shares, and `axle` as -1 at the front and +1 at
            the rear.
        loads: part, or "" without parts -> force, N, and moment, N mm, on the wheel at its contact point,
            along the user's axes, each (3,).
    """

    up: Array
    right: Array
    outboard: Array
    wheel_radius: float | None = None
    car: Mapping[str, float] = field(default_factory=dict)
    loads: Mapping[str, tuple[Array, Array]] = field(default_factory=dict)

    def on(self, side: str) -> CarAxes:
        """The axes for a wheel on a side of the car; these axes where no side is given."""
        return replace(self, outboard=SIGNS[side] * self.right) if side else self

    def component(self, vector: V, direction: Direction) -> V:
        """Component of vectors (..., 3) along a direction, shape (...,).

        Of an enclosed vector it is the exact component, enclosed; the car's axes count as exact as given.
        """
        if direction in OPPOSITE:
            return -self.component(vector, OPPOSITE[direction])
        if isinstance(vector, Enclosed):
            return enclosure.dot(vector, self._enclosed[direction])
        return np.asarray(vector @ self._vectors[direction])

    @cached_property
    def _vectors(self) -> Mapping[Direction, Array]:
        return _directions(self.up, self.right, self.outboard, vectors.cross)

    @cached_property
    def _enclosed(self) -> Mapping[Direction, Enclosed]:
        up, right, outboard = map(Enclosed.of, (self.up, self.right, self.outboard))
        return _directions(up, right, outboard, enclosure.cross)


def _directions(up: V, right: V, outboard: V, cross: Callable[[V, V], V]) -> Mapping[Direction, V]:
    left = cross(up, outboard)
    return {"up": up, "outboard": outboard, "rearward": cross(right, up), "to_the_left": left}
