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

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from pointcoord.effects.arithmetic import S, angle
from pointcoord.effects.corner import Corner, View, Wheel, wheels_of
from pointcoord.effects.effect import (
    Doubt,
    Effect,
    Point,
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
from pointcoord.numerics.enclosure import Enclosed

if TYPE_CHECKING:
    from pointcoord.bounds.enclosed_points import EnclosedPoses, Numbers


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
LENGTHS = ("wheelbase", "centre_of_gravity_height", "spring_free_length")
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
        cls,
        name: str,
        gives: str,
        *numbers: Number,
        base: str = "",
        nowhere: str = "",
        of_axle: bool = False,
        apart: bool = False,
        derivative: int = 0,
    ) -> CarNumbers:
        """The effect that gives some numbers.

        Args:
            base: the effect of whose numbers these are the gradients; empty if they are not gradients.
            nowhere: where else, besides a wheel that does not travel, there is no number because a divisor
                is zero; in words.
            derivative: 1 if the formulas take the points' derivatives by time.
        """
        way = numbers[0].way
        travels = "the wheel does not travel there" if way == BY_TRAVEL else ""
        return cls(
            name,
            gives,
            sign="; ".join(f"{number.words}: positive {number.sign or 'always'}" for number in numbers),
            derivative=derivative,
            quantities=tuple({number.quantity.name: number.quantity for number in numbers}.values()),
            own_names=tuple(number.name for number in numbers),
            lines=tuple(dict.fromkeys(role for number in numbers for role in number.roles)),
            way=way,
            base=base,
            no_number=" or ".join(filter(None, (travels, nowhere))),
            numbers=numbers,
            of_axle=of_axle,
            apart=apart,
        )

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

    def ways(self, topology: Topology) -> tuple[Way, ...]:
        return tuple(wheel.way(self.way) for wheel in self._wheels(topology) if self.way)

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
        """Errors from the enclosed exact numbers, which are in units of the mechanism."""
        unit, time = float(poses.mechanism.unit), poses.powers[self.derivative]
        found: dict[str, dict[str, Array]] = {quantity.name: {} for quantity in self.quantities}
        for name, number, exact in self._made(poses):
            reported = numbers[number.quantity.name][name]
            # The units of length and time are powers of two, so products with them are exact.
            off = exact.scaled(unit**number.power).errors(reported * time) / time
            found[number.quantity.name][name] = off
        return found

    def _made(self, poses: Poses | EnclosedPoses) -> Iterator[tuple[str, Number, Any]]:
        """Every number with its name, in the arithmetic of the poses."""
        for prefix, wheels in self._subjects(poses.mechanism.topology):
            corners = [self._corner(poses, wheel) for wheel in wheels]
            for number in self.numbers:
                yield prefix + number.name, number, number.formula(*corners)

    def _corner(self, poses: Poses | EnclosedPoses, wheel: Wheel) -> Corner[Any]:
        """A corner, with derivatives by time or along its wheel's way if the numbers need them."""
        corner = corner_of(poses, wheel)
        if self.derivative:
            states = poses.states if isinstance(poses, Poses) else poses.points
            return corner.moving((states[1], poses.in_chassis[1]))
        return corner.moving(poses.slopes[wheel.way(self.way)]) if self.way else corner

    def refusal(self, topology: Topology, drawn: Mapping[str, Point], axes: CarAxes) -> str:
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


def corner_of(poses: Poses | EnclosedPoses, wheel: Wheel) -> Corner[Any]:
    """One wheel of poses: floats or duals in mm, or enclosures in units of the mechanism."""
    mechanism, axes = poses.mechanism, poses.axes.on(wheel.side)
    constant: Callable[[Array], Any]
    if isinstance(poses, Poses):
        unit, constant = 1.0, poses.constant
        places, drawn, origin = poses.states[0], poses.drawn, poses.beside(mechanism.origin)
    else:
        unit, constant, vectors = float(mechanism.unit), Enclosed.of, mechanism.drawing.vectors
        drawn = {name: Enclosed.of(vectors[name]) for name in mechanism.topology.points}
        places, origin = poses.points[0], mechanism.origin / unit
    radius = constant(np.array(np.nan if axes.wheel_radius is None else axes.wheel_radius / unit))
    up, outboard = constant(axes.up), constant(axes.outboard)

    def view(points: Mapping[str, Any]) -> View[Any]:
        return View(wheel, points, axes, up, outboard, radius)

    car = {n: constant(np.array(number / unit if n in LENGTHS else number)) for n, number in axes.car.items()}
    return Corner(view(places), view(poses.in_chassis[0]), view(drawn), constant(origin), car)
