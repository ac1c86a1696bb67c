"""The axes of a car as directions that have names: up, outboard and rearward, and their opposites."""

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
"""Of the outboard direction along right, by the side of the car."""
OPPOSITE: Mapping[Direction, Direction] = {"down": "up", "inboard": "outboard", "forward": "rearward"}


@dataclass(frozen=True, eq=False)
class CarAxes:
    """Unit vectors of one wheel's car, each of shape (..., 3), and what else its scene says of the wheel.

    Attributes:
        up, right: as the car's axes are given; rearward is right x up.
        outboard: away from the car's middle, on the side of the wheel. An outboard line that turns to the
            left goes `to_the_left`, up x outboard.
        wheel_radius: mm; None where the scene has none.
        car: what the scene says of the whole car, by name: lengths in mm, shares, and of its axle -1 at the
            front and +1 at the rear.
        loads: by part, or by an empty name, the force, N, and the moment, N mm, on the wheel at its contact
            point, along the user's axes, each (3,).
    """

    up: Array
    right: Array
    outboard: Array
    wheel_radius: float | None = None
    car: Mapping[str, float] = field(default_factory=dict)
    loads: Mapping[str, tuple[Array, Array]] = field(default_factory=dict)

    def on(self, side: str) -> CarAxes:
        """Those of a wheel on a side of the car; those of this wheel where it is not said."""
        return replace(self, outboard=SIGNS[side] * self.right) if side else self

    def component(self, vector: Array, direction: Direction) -> Array:
        """Component of vectors (..., 3) along a direction, shape (...,)."""
        if direction in OPPOSITE:
            return -self.component(vector, OPPOSITE[direction])
        return np.asarray(vector @ self._vectors[direction])

    def enclosed(self, vector: Enclosed, direction: Direction) -> Enclosed:
        """Where that component exactly is; a direction of the car's axes is exactly as it is given."""
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
