"""Effects that are made of how the points move by one input: as the wheel travels, or as the rack does.

Of the inputs that a scene drives, those that are the travel of a slide steer; the other one moves the wheel
up and down. The other inputs and the chassis are held (see `linkage.slopes`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects.arithmetic import Dual
from pointcoord.effects.car_number import OfTheCar, corner_of, enclosed_corner, signs_of
from pointcoord.effects.corner import Corner, View
from pointcoord.effects.effect import Point, Poses, Quantity
from pointcoord.linkage.car_axes import Direction
from pointcoord.linkage.topology import Topology
from pointcoord.numerics.enclosure import Enclosed

if TYPE_CHECKING:
    from pointcoord.bounds.enclosed_points import EnclosedPoses
    from pointcoord.bounds.proof import Numbers

Array = NDArray[np.float64]

BY_TRAVEL, BY_RACK = "by_travel", "by_rack"
KINDS = {BY_TRAVEL: "is no travel of a slide", BY_RACK: "is the travel of a slide"}


@dataclass(frozen=True)
class NumberAlong:
    """A number that is made of a pose and its derivative along a way.

    Attributes:
        name: in results and files. words: for people.
        sign: where it is positive, in words.
        quantity: the kind of number that it is. roles: the roles whose points it is made of.
        needs_radius: whether it is made of the wheel's radius. way: along which it is.
        formula: the number at points with their derivatives; lengths in the unit of the points.
        power: of that unit, mm, that it is multiplied by.
    """

    name: str
    words: str
    sign: str
    quantity: Quantity
    roles: tuple[str, ...]
    needs_radius: bool
    way: str
    formula: Callable[[Corner[Dual[Any]]], Any]
    power: int


@dataclass(frozen=True)
class NumbersAlong(OfTheCar):
    """Some numbers along one way.

    Attributes:
        base: the effect whose numbers' gradients they are; empty if they are none.
    """

    numbers: tuple[NumberAlong, ...]
    base: str = ""

    @classmethod
    def of(cls, name: str, gives: str, *numbers: NumberAlong, base: str = "") -> NumbersAlong:
        """The effect that gives some numbers of one quantity.

        Args:
            base: the effect whose numbers' gradients they are, if they are such.
        """
        return cls(name, gives, signs_of(numbers), 0, (numbers[0].quantity,), numbers=numbers, base=base)

    @property
    def way(self) -> str:
        """That of the numbers."""
        return self.numbers[0].way

    @property
    def no_number(self) -> str:
        """Where nothing can be divided by."""
        return "the wheel does not travel there" if self.way == BY_TRAVEL else ""

    def evaluate(self, poses: Poses) -> dict[str, dict[str, Array]]:
        """Each number, (..., N)."""
        corner = _with_slopes(corner_of(poses), poses.slopes[self.way], np.zeros_like)
        return {self.quantities[0].name: {number.name: number.formula(corner) for number in self.numbers}}

    def errors(self, poses: EnclosedPoses, numbers: Numbers) -> dict[str, dict[str, Array]]:
        """Of each number by itself."""
        corner = _with_slopes(enclosed_corner(poses), poses.slopes[self.way], _no_slope)
        unit, (quantity,) = float(poses.mechanism.unit), self.quantities
        found = numbers[quantity.name]
        exact = {n.name: n.formula(corner).scaled(unit**n.power) for n in self.numbers}
        errors = {name: number.errors(found[name]) for name, number in exact.items()}
        return {quantity.name: errors}

    def refusal(self, topology: Topology, drawn: Mapping[str, Point], wheel_radius: float | None) -> str:
        """A role, the wheel's radius or the one input is missing."""
        problem = super().refusal(topology, drawn, wheel_radius)
        driven = topology.driven_along(self.way)
        if problem or len(driven) == 1:
            return problem
        return (
            f"{self.name!r} needs exactly one driven input that {KINDS[self.way]}, and there is "
            f"{', '.join(driven) or 'none'}; drive the mechanism by one, such as wheel travel and rack, or "
            f"leave {self.name!r} out"
        )


def _with_slopes(
    corner: Corner[Any], slopes: tuple[Mapping[str, Any], Mapping[str, Any]], zero: Callable[[Any], Any]
) -> Corner[Dual[Any]]:
    """A corner whose points have derivatives; directions, the drawing and the radius have none."""

    def still(part: Any) -> Dual[Any]:
        return Dual(part, zero(part))

    def along(view: View[Any]) -> Any:
        def component(vector: Dual[Any], direction: Direction) -> Dual[Any]:
            return Dual(view.along(vector.value, direction), view.along(vector.slope, direction))

        return component

    def dual(view: View[Any], moving: Mapping[str, Any] | None) -> View[Dual[Any]]:
        points = {
            name: still(place) if moving is None else Dual(place, moving[name])
            for name, place in view.points.items()
            if moving is None or name in moving
        }
        up, outboard, radius = (still(part) for part in (view.up, view.outboard, view.radius))
        return View(view.topology, points, along(view), up, outboard, radius)

    return Corner(
        dual(corner.seen, slopes[0]),
        dual(corner.chassis, slopes[1]),
        dual(corner.drawn, None),
        still(corner.origin),
    )


def _no_slope(part: Enclosed) -> Enclosed:
    return Enclosed.of(np.zeros_like(part.middle))
