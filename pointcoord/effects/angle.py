r"""Angle effects: the inclination of a line of the car in a plane of two of the car's axes.

An angle is atan2(p, q) of the line's components p and q along two directions of the car, measured in the
plane of the two. It is positive where the line has a positive component along the first.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects.arithmetic import S, angle
from pointcoord.effects.car_number import Number
from pointcoord.effects.corner import Corner, Wheel
from pointcoord.effects.effect import Doubt, Quantity
from pointcoord.linkage.car_axes import CarAxes, Direction

Array = NDArray[np.float64]

WHEEL = Quantity("wheel", "wheel angle", "rad", "car")
# Symbols of the axes, as in the README.
LETTERS = {"wheel_axis": "n", "steering_axis": "k"}


@dataclass(frozen=True, eq=False, kw_only=True)
class Angle(Number):
    """An angle of a line of the car, in a plane of the car's axes; rad.

    Attributes:
        line: the axis by its role in the topology, from its first point to its second.
        sine, cosine: the directions along which the line has the angle's sine and cosine.
        steepest: degrees; a drawing with a larger angle gets a warning.
    """

    line: Literal["wheel_axis", "steering_axis"]
    sine: Direction
    cosine: Direction
    steepest: float = 180.0
    quantity: Quantity = WHEEL
    needs_radius: bool = False
    power: int = 0
    formula: Callable[..., Any] = field(init=False)

    def __post_init__(self) -> None:
        letter, seen = LETTERS[self.line], (d.replace("_", " ") for d in (self.sine, self.cosine))
        components = ", ".join(f"{letter} . {direction}" for direction in seen)
        made = {"formula": self._of_corner, "roles": (self.line,), "definition": f"atan2({components})"}
        for name, value in made.items():
            object.__setattr__(self, name, value)

    def _of_corner(self, corner: Corner[S]) -> S:
        view = corner.seen
        line = view.line(*self.ends(view.of))
        return angle(view.along(line, self.sine), view.along(line, self.cosine))

    def ends(self, wheel: Wheel) -> tuple[str, str]:
        start, end = wheel.role(self.line)
        return start, end

    def doubt(self, wheel: Wheel, drawn: Mapping[str, Array], axes: CarAxes) -> Doubt:
        """A warning for drawings with a larger angle than any car has.

        Args:
            drawn: the points, each (..., 3), mm.
        """
        start, end = self.ends(wheel)
        line = drawn[end] - drawn[start]
        degrees = np.degrees(angle(axes.component(line, self.sine), axes.component(line, self.cosine)))

        def words(member: tuple[int, ...]) -> str:
            steepness = float(degrees[member])
            return (
                f"the drawn {self.words} is {steepness:.4g} deg, by the line from {start} to {end}: "
                f"{'are they swapped, or is side wrong' if abs(steepness) > 90.0 else 'is one misdrawn'}?"
            )

        return Doubt(np.abs(degrees) > self.steepest, words)
