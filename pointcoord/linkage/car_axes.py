"""Named directions of a car: up, outboard and rearward, and their opposites."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.enclosure import Enclosed, cross, dot
from pointcoord.numerics.vectors import cross as vector_product

Array = NDArray[np.float64]

Direction = Literal["up", "down", "outboard", "inboard", "rearward", "forward", "to_the_left"]
SIGNS = {"left": -1.0, "right": 1.0}
"""Side of the car -> sign of the outboard direction along right."""
OPPOSITE: Mapping[Direction, Direction] = {"down": "up", "inboard": "outboard", "forward": "rearward"}


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

    def component(self, vector: Array, direction: Direction) -> Array:
        """Component of vectors (..., 3) along a direction, shape (...,)."""
        if direction in OPPOSITE:
            return -self.component(vector, OPPOSITE[direction])
        return np.asarray(vector @ self._vectors[direction])

    def enclosed(self, vector: Enclosed, direction: Direction) -> Enclosed:
        """The exact component, enclosed; directions of the car's axes count as exact as given."""
        if direction in OPPOSITE:
            return -self.enclosed(vector, OPPOSITE[direction])
        if direction == "rearward":
            return dot(vector, cross(Enclosed.of(self.right), Enclosed.of(self.up)))
        if direction == "to_the_left":
            return dot(vector, cross(Enclosed.of(self.up), Enclosed.of(self.outboard)))
        return dot(vector, Enclosed.of(self._vectors[direction]))

    @cached_property
    def _vectors(self) -> Mapping[Direction, Array]:
        rearward = vector_product(self.right, self.up)
        left = vector_product(self.up, self.outboard)
        return {"up": self.up, "outboard": self.outboard, "rearward": rearward, "to_the_left": left}
