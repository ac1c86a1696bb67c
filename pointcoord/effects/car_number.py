"""Effects that are numbers of the car, each a formula of its points that is written once.

The formula gives the value at places in floats, and where it exactly is at places that are enclosed; so its
error bound needs no derivation of its own. What is made of how the points move by one input, as the wheel
travels or as the rack does, takes points as duals. Of the inputs that a scene drives, those that are the
travel of a slide steer; the other one moves the wheel up and down. The other inputs and the chassis are held
(see `linkage.slopes`).
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects.corner import Corner, View, Wheel, wheels_of
from pointcoord.effects.effect import Effect, Point, Poses, Quantity, lacks, no_radius, no_role, not_one_input
from pointcoord.linkage.car_axes import CarAxes
from pointcoord.linkage.slopes import Way
from pointcoord.linkage.topology import Topology
from pointcoord.numerics.enclosure import Enclosed

if TYPE_CHECKING:
    from pointcoord.bounds.enclosed_points import EnclosedPoses, Numbers

Array = NDArray[np.float64]

BY_TRAVEL, BY_RACK, BY_ROLL = "by_travel", "by_rack", "by_roll"
# What a scene may say of the car, and how, for those who did not.
SUCH_AS = {
    "axle": '"front"',
    "wheelbase": "2500.0",
    "centre_of_gravity_height": "500.0",
    "brake_share": "0.6",
    "drive_share": "1.0",
    "spring_rate": "30.0",
    "spring_free_length": "350.0",
}
LENGTHS = ("wheelbase", "centre_of_gravity_height", "spring_free_length")
KINDS = {
    BY_TRAVEL: "is no travel of a slide, such as wheel travel",
    BY_RACK: "is the travel of a slide or a steering wheel, such as a rack",
    BY_ROLL: "rolls the chassis",
}


@dataclass(frozen=True, eq=False, kw_only=True)
class Number:
    """A number by its formula, as `numbers.toml` has it.

    Attributes:
        name: in results and files. words: for people.
        sign: where it is positive, in words; empty of what is never negative.
        definition: the formula in words, as the page of effects has it, in the page's letters.
        formula: what it is of a corner, or of the left and the right one; lengths in the unit of the points.
        roles: of the mechanism, whose points it is made of. needs_radius: whether of the wheel's radius too.
        quantity: the kind of number that it is.
        data: what it is made of beside, of what the scene says of the car.
        way: along which it takes the points' derivatives; empty if it takes none.
        power: of the unit of the points, mm, that it is multiplied by.
        source: who else has it so.
    """

    name: str
    words: str
    sign: str = ""
    definition: str = ""
    formula: Callable[..., Any]
    roles: tuple[str, ...] = ("wheel_axis",)
    needs_radius: bool = True
    quantity: Quantity
    data: tuple[str, ...] = ()
    way: str = ""
    power: int = 1
    source: str = ""


@dataclass(frozen=True, eq=False)
class CarNumbers(Effect):
    """Some numbers of the car, along one way if any: of each wheel, or of the two of an axle together.

    Attributes:
        numbers: what they are.
        base: the effect whose numbers' gradients they are; empty if they are none.
        nowhere: where else than where the wheel does not travel there is no number, in words.
        of_axle: whether their formulas take two wheels, the left one and the right one.
    """

    numbers: tuple[Number, ...]
    base: str = ""
    nowhere: str = ""
    of_axle: bool = False

    @classmethod
    def of(
        cls,
        name: str,
        gives: str,
        *numbers: Number,
        base: str = "",
        nowhere: str = "",
        of_axle: bool = False,
        derivative: int = 0,
    ) -> CarNumbers:
        """The effect that gives some numbers.

        Args:
            derivative: 1 of what takes the points' derivatives by time.
        """
        signs = "; ".join(f"{number.words}: positive {number.sign or 'always'}" for number in numbers)
        quantities = tuple({number.quantity.name: number.quantity for number in numbers}.values())
        return cls(name, gives, signs, derivative, quantities, numbers, base, nowhere, of_axle)

    @property
    def own_names(self) -> tuple[str, ...]:
        return tuple(number.name for number in self.numbers)

    def gives_numbers(self, topology: Topology) -> Mapping[str, tuple[str, ...]]:
        prefixes = [prefix for prefix, _ in self._subjects(topology)]
        return {
            quantity.name: tuple(
                prefix + number.name
                for number in self.numbers
                for prefix in prefixes
                if number.quantity is quantity
            )
            for quantity in self.quantities
        }

    @property
    def lines(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys(role for number in self.numbers for role in number.roles))

    @property
    def way(self) -> str:
        return self.numbers[0].way

    def ways(self, topology: Topology) -> tuple[Way, ...]:
        return tuple(wheel.way(self.way) for wheel in self._wheels(topology) if self.way)

    @property
    def no_number(self) -> str:
        """Where nothing can be divided by."""
        travels = "the wheel does not travel there" if self.way == BY_TRAVEL else ""
        return " or ".join(filter(None, (travels, self.nowhere)))

    def needs(self, topology: Topology) -> Collection[str]:
        return {p for wheel in self._wheels(topology) for role in self.lines for p in wheel.role(role)}

    def _subjects(self, topology: Topology) -> list[tuple[str, tuple[Wheel, ...]]]:
        wheels = wheels_of(topology, self.lines)
        if not self.of_axle:
            return [(wheel.prefix, (wheel,)) for wheel in wheels]
        pair = sorted((wheel for wheel in wheels if wheel.part), key=lambda wheel: wheel.side)
        return [("", tuple(pair))] if [wheel.side for wheel in pair] == ["left", "right"] else []

    def _wheels(self, topology: Topology) -> list[Wheel]:
        return [wheel for _, wheels in self._subjects(topology) for wheel in wheels]

    def evaluate(self, poses: Poses) -> dict[str, dict[str, Array]]:
        found: dict[str, dict[str, Array]] = {quantity.name: {} for quantity in self.quantities}
        for name, number, value in self._made(poses):
            found[number.quantity.name][name] = value
        return found

    def errors(self, poses: EnclosedPoses, numbers: Numbers) -> dict[str, dict[str, Array]]:
        """From where each exactly is, in units of the mechanism."""
        unit, time = float(poses.mechanism.unit), poses.powers[self.derivative]
        found: dict[str, dict[str, Array]] = {quantity.name: {} for quantity in self.quantities}
        for name, number, exact in self._made(poses):
            reported = numbers[number.quantity.name][name]
            # The units of length and of time are powers of two: no product with them rounds.
            off = exact.scaled(unit**number.power).errors(reported * time) / time
            found[number.quantity.name][name] = off
        return found

    def _made(self, poses: Poses | EnclosedPoses) -> Iterator[tuple[str, Number, Any]]:
        """Every number by its name, in the arithmetic of the poses."""
        for prefix, wheels in self._subjects(poses.mechanism.topology):
            corners = [self._corner(poses, wheel) for wheel in wheels]
            for number in self.numbers:
                yield prefix + number.name, number, number.formula(*corners)

    def _corner(self, poses: Poses | EnclosedPoses, wheel: Wheel) -> Corner[Any]:
        """A corner, with the derivatives by time or along its wheel's way if the numbers take any."""
        corner = corner_of(poses, wheel)
        if self.derivative:
            states = poses.states if isinstance(poses, Poses) else poses.points
            return corner.moving((states[1], poses.in_chassis[1]))
        return corner.moving(poses.slopes[wheel.way(self.way)]) if self.way else corner

    def refusal(self, topology: Topology, drawn: Mapping[str, Point], axes: CarAxes) -> str:
        """What it is made of is missing."""
        wheels = self._wheels(topology)
        if not wheels and self.of_axle:
            needs = f"two parts on opposite sides of the car with the roles {' and '.join(self.lines)}"
            missing = f", and the mechanism {topology.name!r} does not have them"
            return lacks(self.name, needs + missing, "take one of an axle")
        if not wheels:
            return no_role(self.name, next(r for r in self.lines if not wheels_of(topology, [r])), topology)
        if axes.wheel_radius is None and any(number.needs_radius for number in self.numbers):
            return no_radius(self.name)
        data = dict.fromkeys(name for number in self.numbers for name in number.data)
        if absent := [name for name in data if name not in axes.car]:
            needs = f"of the car what the scene does not say: {', '.join(absent)}"
            lines = ", ".join(f"{name} = {SUCH_AS[name]}" for name in absent)
            return lacks(self.name, needs, f"give it under [mechanism.car], such as {lines}")
        for wheel in wheels:
            driven = wheel.driven(self.way) if self.way else ("",)
            if len(driven) != 1:
                of = f"of the {wheel.part} wheel " if wheel.part else ""
                return not_one_input(self.name, f"{of}that {KINDS[self.way]}", driven)
        return ""


def corner_of(poses: Poses | EnclosedPoses, wheel: Wheel) -> Corner[Any]:
    """A wheel of poses: of floats or duals in mm, or where it exactly is in units of the mechanism."""
    mechanism, axes = poses.mechanism, poses.axes.on(wheel.side)
    unit = 1.0
    constant: Callable[..., Any] = Enclosed.of
    component: Callable[..., Any] = axes.enclosed
    if isinstance(poses, Poses):
        constant, component = poses.constant, axes.component
        places, drawn, origin = poses.states[0], poses.drawn, poses.beside(mechanism.origin)
    else:
        unit, vectors = float(mechanism.unit), mechanism.drawing.vectors
        drawn = {name: Enclosed.of(vectors[name]) for name in mechanism.topology.points}
        places, origin = poses.points[0], mechanism.origin / unit
    radius = constant(np.array(np.nan if axes.wheel_radius is None else axes.wheel_radius / unit))
    up, outboard = constant(axes.up), constant(axes.outboard)

    def view(points: Mapping[str, Any]) -> View[Any]:
        return View(wheel, points, component, up, outboard, radius)

    car = {n: constant(np.array(number / unit if n in LENGTHS else number)) for n, number in axes.car.items()}
    return Corner(view(places), view(poses.in_chassis[0]), view(drawn), constant(origin), car)
