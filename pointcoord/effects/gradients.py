r"""What every number of the car changes by as the wheel travels, or as the rack does: exact, at each pose.

Of the inputs that a scene drives, those that are the travel of a slide steer; the other one, b, moves the
wheel up and down. With points P, their derivatives P_q by one input q where the others and the chassis are
held (see `linkage.slopes`), and a number N(P),

    by_rack:    N_P P_s                               s the one input that steers, mm
    by_travel:  (N_P P_b) / (T_P P_b)                 T the travel of the wheel centre, mm

The formula of N gives its derivative with it where points are duals (see `arithmetic`).
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects.arithmetic import Dual, ratio
from pointcoord.effects.car_number import CarNumber, CarNumbers, corner_of_slopes, enclosed_corner_of_slopes
from pointcoord.effects.corner import Corner
from pointcoord.effects.effect import Effect, Point, Poses, Quantity
from pointcoord.effects.wheel_travel import TRAVEL
from pointcoord.linkage.topology import Topology

if TYPE_CHECKING:
    from pointcoord.bounds.enclosed_points import EnclosedPoses
    from pointcoord.bounds.proof import Numbers

Array = NDArray[np.float64]

BY_TRAVEL, BY_RACK = "by_travel", "by_rack"
WAYS = {BY_TRAVEL: "as the wheel centre goes up", BY_RACK: "as the rack travels"}
QUANTITIES = {
    "rad": Quantity("angle_gradient", "wheel angle per mm", "rad/mm", "car"),
    "mm": Quantity("dimension_gradient", "dimension per mm", "mm/mm", "car"),
}


@dataclass(frozen=True)
class Gradient:
    """What a number changes by.

    Attributes:
        number: which. way: `BY_TRAVEL` or `BY_RACK`.
    """

    number: CarNumber
    way: str

    @property
    def name(self) -> str:
        """In results and files."""
        return f"{self.number.name}_{self.way}"

    @property
    def words(self) -> str:
        """For people."""
        return f"{self.number.words} per mm {self.way.replace('_', ' ')}"

    @property
    def sign(self) -> str:
        """Where it is positive, in words."""
        return f"where {self.number.words} grows {WAYS[self.way]}"

    @property
    def quantity(self) -> Quantity:
        """Per mm."""
        return QUANTITIES[self.number.quantity.unit]

    def of(self, corner: Corner[Dual[Any]]) -> Any:
        """The derivative; lengths in the unit of the points, by mm of the rack."""
        slope = self.number.of(corner).slope
        return slope if self.way == BY_RACK else ratio(slope, TRAVEL.of(corner).slope)

    def unit(self, unit: float) -> float:
        """What it is multiplied by where lengths are in a unit, mm."""
        power = (self.number.quantity.unit == "mm") - (self.way == BY_TRAVEL)
        return unit**power


@dataclass(frozen=True)
class Gradients(Effect):
    """The gradients of an effect.

    Attributes:
        base: the effect. way: along which they are.
    """

    base: CarNumbers
    along: str

    @classmethod
    def of(cls, base: CarNumbers, way: str) -> Gradients:
        """The gradients of an effect along a way."""
        parts = [Gradient(number, way) for number in base.numbers]
        return cls(
            name=f"{base.name}_{way}",
            gives=f"what these change by per mm {WAYS[way]}: {base.gives}",
            sign="; ".join(f"{part.words}: positive {part.sign}" for part in parts),
            derivative=0,
            quantities=(parts[0].quantity,),
            base=base,
            along=way,
        )

    @property
    def numbers(self) -> tuple[Gradient, ...]:
        """What they are."""
        return tuple(Gradient(number, self.along) for number in self.base.numbers)

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the numbers."""
        return tuple(number.name for number in self.numbers)

    @property
    def lines(self) -> tuple[str, ...]:
        """Those of the numbers, and the wheel's where it travels."""
        return tuple(dict.fromkeys((*self.base.lines, *(TRAVEL.roles if self.along == BY_TRAVEL else ()))))

    @property
    def way(self) -> str:
        """The derivative of the points that it is made of."""
        return self.along

    @property
    def no_number(self) -> str:
        """Of a travel that stands still, or a number that is at its corner."""
        return "the wheel centre does not travel there" if self.along == BY_TRAVEL else ""

    def needs(self, topology: Topology) -> Collection[str]:
        """The points of the roles."""
        return {point for role in self.lines for point in topology.role(role)}

    def evaluate(self, poses: Poses) -> dict[str, dict[str, Array]]:
        """Each gradient, (..., N)."""
        corner = corner_of_slopes(poses, self.along)
        return {self.quantities[0].name: {number.name: number.of(corner) for number in self.numbers}}

    def errors(self, poses: EnclosedPoses, numbers: Numbers) -> dict[str, dict[str, Array]]:
        """Of each gradient by itself."""
        corner, unit = enclosed_corner_of_slopes(poses, self.along), float(poses.mechanism.unit)
        found = numbers[self.quantities[0].name]
        errors = {n.name: n.of(corner).scaled(n.unit(unit)).errors(found[n.name]) for n in self.numbers}
        return {self.quantities[0].name: errors}

    def refusal(self, topology: Topology, drawn: Mapping[str, Point], wheel_radius: float | None) -> str:
        """What the numbers lack, or the one input to go along."""
        problem = self.base.refusal(topology, drawn, wheel_radius)
        if problem:
            return problem.replace(repr(self.base.name), repr(self.name))
        if len(topology.driven_along(self.along)) == 1:
            return ""
        kind = "is no travel of a slide" if self.along == BY_TRAVEL else "is the travel of a slide"
        found = ", ".join(topology.driven_along(self.along)) or "none"
        return (
            f"{self.name!r} needs exactly one driven input that {kind}, and there is {found}; drive the "
            f"mechanism by one, such as wheel_travel and rack, or leave {self.name!r} out"
        )
