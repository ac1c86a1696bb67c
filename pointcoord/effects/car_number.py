"""Effects that are numbers of the car, each with one formula of its points.

With places as floats the formula gives the value; with enclosed places it gives bounds of the exact value, so
that the error bound needs no derivation of its own. Numbers that depend on how the points move with one
input, such as wheel or rack travel, take points as duals. Among the driven inputs, those that are a slide's
travel steer the car; the other one moves the wheel up and down. The other inputs and the chassis are held
(see `linkage.slopes`).

An angle is the inclination of a line of the car in a plane of two of the car's axes: atan2(p, q) of the
line's components p and q along two directions of the car. It is positive where the line has a positive
component along the first.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from pointcoord.effects.arithmetic import S, angle
from pointcoord.effects.corner import Corner, Wheel, corner_of, wheels_of
from pointcoord.effects.effect import (
    Doubt,
    Effect,
    Poses,
    Quantity,
    lacks,
    no_radius,
    no_role,
    not_one_input,
)
from pointcoord.linkage.directions import CarAxes, Direction
from pointcoord.linkage.slopes import Way
from pointcoord.linkage.topology import Topology
from pointcoord.numerics.arrays import Array

if TYPE_CHECKING:
    from pointcoord.bounds.enclosed_points import EnclosedPoses


BY_TRAVEL, BY_RACK, BY_ROLL = "by_travel", "by_rack", "by_roll"
# Car data that a scene may give, with an example value for messages.
SUCH_AS = {
    "axle": '"front"',
    "wheelbase": "2500.0",
    "centre_of_gravity_height": "500.0",
    "brake_share": "0.6",
    "drive_share": "1.0",
    "spring_rate": "30.0",
    "spring_free_length": "350.0",
}
WHEEL = Quantity("wheel", "wheel angle", "rad", "car")
# Symbols of the axes, as in the README.
LETTERS = {"wheel_axis": "n", "steering_axis": "k"}
KINDS = {
    BY_TRAVEL: "is not the travel of a slide, such as wheel travel",
    BY_RACK: "is the travel of a slide or a steering wheel, such as a rack",
    BY_ROLL: "rolls the chassis",
}


@dataclass(frozen=True, eq=False, kw_only=True)
class Number:
    """A number of the car with its formula, as listed in `numbers.toml`.

    Attributes:
        name: in results and files. words: for people.
        sign: where it is positive, in words; empty if it is never negative.
        definition: the formula in words, in the symbols of the README.
        formula: the number from a corner, or from the left and the right one; lengths in the points' unit.
        roles: roles whose points it needs. needs_radius: whether it needs the wheel's radius too.
        quantity: the kind of number that it is.
        data: names of the car data that it needs from the scene.
        way: way along which it needs the points' derivatives; empty for none.
        power: exponent of the points' unit of length, mm, in the number's unit.
        source: other programs or standards with the same definition.
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
        letter = LETTERS[self.line]
        components = f"{letter} . {self.sine}, {letter} . {self.cosine}"
        components = components.replace("to_the_left", "(up x outboard)")
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


@dataclass(frozen=True, eq=False)
class CarNumbers(Effect):
    """Numbers of the car, along at most one way: of each wheel, or of the two wheels of an axle together.

    Attributes:
        numbers: the numbers.
        of_axle: whether the formulas take two wheels, the left one and the right one.
        apart: whether no body may carry two wheels. A roll centre is found from the motion of each wheel
            alone; a beam axle that rolls moves both.
    """

    numbers: tuple[Number, ...] = ()
    of_axle: bool = False
    apart: bool = False

    @classmethod
    def of(
        cls, name: str, gives: str, *numbers: Number, derivative: int = 0, nowhere: str = "", **more: Any
    ) -> CarNumbers:
        """The effect that gives some numbers.

        Args:
            derivative: 1 if the formulas take the points' derivatives by time.
            nowhere: where else, besides a wheel that does not travel, there is no number because a divisor
                is zero; in words.
            more: further attributes.
        """
        way = numbers[0].way
        travels = "the wheel does not travel there" if way == BY_TRAVEL else ""
        return cls(
            name,
            gives,
            derivative=derivative,
            quantities=tuple({number.quantity.name: number.quantity for number in numbers}.values()),
            own_names=tuple(number.name for number in numbers),
            lines=tuple(dict.fromkeys(role for number in numbers for role in number.roles)),
            way=way,
            no_number=" or ".join(filter(None, (travels, nowhere))),
            numbers=numbers,
            **more,
        )

    def gives_numbers(self, topology: Topology) -> Mapping[str, tuple[str, ...]]:
        names = [(self._name(number, wheels), number) for number, wheels in self._each(topology)]
        return {q.name: tuple(name for name, n in names if n.quantity is q) for q in self.quantities}

    def ways(self, topology: Topology) -> tuple[Way, ...]:
        return tuple(wheel.way(self.way) for wheel in self._wheels(topology) if self.way)

    def needs(self, topology: Topology) -> Collection[str]:
        return {p for wheel in self._wheels(topology) for role in self.lines for p in wheel.role(role)}

    def evaluate(self, poses: Poses | EnclosedPoses) -> dict[str, dict[str, Any]]:
        """Values of the formulas, with derivatives by time or along each wheel's way if they need them."""

        def corner(wheel: Wheel) -> Corner[Any]:
            if self.derivative:
                return corner_of(poses, wheel, (poses.points[1], poses.in_chassis[1]))
            return corner_of(poses, wheel, poses.slopes[wheel.way(self.way)] if self.way else None)

        topology = poses.mechanism.topology
        corners = {wheel.part: corner(wheel) for wheel in self._wheels(topology)}
        found: dict[str, dict[str, Any]] = {quantity.name: {} for quantity in self.quantities}
        for number, wheels in self._each(topology):
            value = number.formula(*(corners[wheel.part] for wheel in wheels))
            reported = poses.in_mm(value, number.power, self.derivative)
            found[number.quantity.name][self._name(number, wheels)] = reported
        return found

    def _each(self, topology: Topology) -> Iterator[tuple[Number, tuple[Wheel, ...]]]:
        """Every number with the wheels that its formula takes."""
        wheels = self._wheels(topology)
        subjects = [tuple(wheels)] if self.of_axle and wheels else [(wheel,) for wheel in wheels]
        return product(self.numbers, subjects)

    def _name(self, number: Number, wheels: Sequence[Wheel]) -> str:
        return number.name if self.of_axle else wheels[0].prefix + number.name

    def _wheels(self, topology: Topology) -> Sequence[Wheel]:
        """The wheels that have the roles; of an axle the left and the right one, or none."""
        wheels = wheels_of(topology, self.lines)
        if not self.of_axle:
            return wheels
        pair = sorted((wheel for wheel in wheels if wheel.part), key=lambda wheel: wheel.side)
        return pair if [wheel.side for wheel in pair] == ["left", "right"] else []

    def refusal(self, topology: Topology, axes: CarAxes) -> str:
        """Why the car does not have these numbers: roles, wheel radius, car data or an input are missing."""
        wheels = self._wheels(topology)
        if not wheels and self.of_axle:
            needs = f"two parts on opposite sides of the car with the roles {' and '.join(self.lines)}"
            missing = f", which the mechanism {topology.name!r} does not have"
            return lacks(self.name, needs + missing, "use a mechanism of an axle")
        if not wheels:
            return no_role(self.name, next(r for r in self.lines if not wheels_of(topology, [r])), topology)
        if axes.wheel_radius is None and any(number.needs_radius for number in self.numbers):
            return no_radius(self.name)
        knuckles = [wheel.role("knuckle") for wheel in wheels_of(topology, ["knuckle"])]
        if self.apart and len({*knuckles}) < len(knuckles):
            needs = "each wheel on a body of its own: the travel of one wheel gives no roll centre of a beam"
            return lacks(self.name, needs, "use a mechanism with two such bodies")
        data = dict.fromkeys(name for number in self.numbers for name in number.data)
        if absent := [name for name in data if name not in axes.car]:
            needs = f"car data that the scene does not give: {', '.join(absent)}"
            lines = ", ".join(f"{name} = {SUCH_AS[name]}" for name in absent)
            return lacks(self.name, needs, f"give it under [mechanism.car], such as {lines}")
        for wheel in wheels:
            driven = wheel.driven(self.way) if self.way else ("",)
            if len(driven) != 1:
                of = f"of the {wheel.part} wheel " if wheel.part else ""
                return not_one_input(self.name, f"{of}that {KINDS[self.way]}", driven)
        return ""
