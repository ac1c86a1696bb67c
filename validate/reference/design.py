"""The drawn points as exact fractions, scaled to the mechanism's size, and the mechanism's equations."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from validate.reference.car_data import car_data, corners
from validate.reference.chassis import ChassisMotion
from validate.reference.drives import compiled
from validate.reference.equations import Equations, equations_in
from validate.reference.errors import NoReferenceError
from validate.reference.exact import as_ball, as_fraction
from validate.reference.jet import Jet
from validate.reference.mechanism import Mechanism
from validate.reference.vectors import Scalar, Vector, each, minus, times

Driven = Mapping[str, Jet]
"""Value, rate, acceleration and perhaps higher derivatives of every input, in fractions; rad or mm."""


@dataclass(frozen=True)
class Known:
    """The known data of the equations at one instant; scalars may be balls, floats, arrays or jets.

    Attributes:
        equations: the equations in this kind of number.
        numbers: the numbers w.
        chassis: motion of the car as a whole.
        inputs: the inputs as jets by name, rad and mm; w and the motion of the chassis depend on them.
    """

    equations: Equations
    numbers: Sequence[Scalar]
    chassis: ChassisMotion
    inputs: Mapping[str, Jet]

    @classmethod
    def of(cls, equations: Equations, inputs: Mapping[str, Jet]) -> Known:
        """From the inputs as jets."""
        one, exact = equations.mechanism, equations.number
        chassis = ChassisMotion.of(one.plain, one.table, one.unit, inputs, exact)
        return cls(equations, one.numbers(inputs, exact), chassis, inputs)

    @property
    def derivatives(self) -> int:
        """Number of known time derivatives of the inputs."""
        return max((len(jet.parts) for jet in self.inputs.values()), default=3) - 1

    def driven_at(self, name: str, rate: Scalar) -> Known:
        """This instant with one input at a rate, rad/s or mm/s, and the others at rest."""
        rates = dict.fromkeys(self.inputs, rate * 0) | {name: rate}
        inputs = {one: Jet(jet.value, jet.value * 0 + rates[one]) for one, jet in self.inputs.items()}
        return Known.of(self.equations, inputs)

    def points_of(self, unknown: Sequence[Scalar]) -> dict[str, Vector]:
        """Position of every point, after the motion of the chassis."""
        return {name: self.chassis.moved(p) for name, p in self.equations.points_of(unknown).items()}

    def residual(self, unknown: Sequence[Scalar]) -> list[Scalar]:
        """C(y, w)."""
        return self.equations.residual(unknown, self.numbers)


@dataclass(frozen=True, eq=False)
class Design:
    """The mechanism of a checked scene, in exact local coordinates (p - origin) / unit.

    These keep balls narrow even if the points lie 1e9 mm from the frame's origin, or the mechanism is 1e-3 or
    1e6 mm in size.

    Attributes:
        plain: the description, see `pointcoord/mechanisms/README.md`; its points are in `table`.
        mechanism: the equations.
        table: the points by name, local.
        origin: the first point, mm.
        unit: a power of two near the mechanism's size, mm.
        corners, car: see `car_data`.
        loads: force, N, and moment, N mm, of the ground on the knuckle at the contact point, by prefix of the
            corner, for corners with a load.
    """

    plain: Mapping[str, Any]
    mechanism: Mechanism
    table: Mapping[str, Vector]
    origin: Vector
    unit: Fraction
    corners: Mapping[str, int]
    car: Mapping[str, Fraction]
    loads: Mapping[str, tuple[Vector, Vector]]

    @classmethod
    def from_plain(cls, plain: Mapping[str, Any]) -> Design:
        """Read a description, mm.

        Raises:
            NoReferenceError: a number is not finite, a rod or a body has no extent, or the inputs do not
                determine all degrees of freedom.
        """
        table = {name: exact_vector(place, f"points[{name!r}]") for name, place in plain["points"].items()}
        up, right = exact_vector(plain["up"], "up"), exact_vector(plain["right"], "right")
        origin = next(iter(table.values()))
        unit = _unit(table.values(), origin)
        table = {name: times(minus(p, origin), 1 / unit) for name, p in table.items()}
        exact = {**plain, "up": up, "right": right}
        mechanism = compiled(exact, table, unit)
        equations_in(mechanism)  # refuses what is not determined
        return cls(exact, mechanism, table, origin, unit, corners(plain), car_data(plain), _loads(plain))

    @property
    def inputs(self) -> tuple[str, ...]:
        """The names of the inputs."""
        return tuple(self.plain["inputs"])

    def role(self, name: str) -> Any:
        """The value of a role of the mechanism, or None."""
        return self.plain["roles"].get(name)

    def driven(self, inputs: Mapping[str, Sequence[object]]) -> Driven:
        """Inputs by name as fractions; an input that is not given rests at zero."""
        count = max((len(law) for law in inputs.values()), default=3)
        return {
            name: Jet(*(as_fraction(part, f"inputs[{name!r}]") for part in inputs.get(name, (0,) * count)))
            for name in self.inputs
        }

    def known(self, driven: Driven) -> Known:
        """The known data of the equations, as jets of balls at the present precision, local."""
        return Known.of(equations_in(self.mechanism), {name: balls(jet) for name, jet in driven.items()})


def values_only(known: Known) -> Known:
    """The known data for the position equations: the jets' values, without derivatives."""
    return replace(known, numbers=[jet.value for jet in known.numbers], chassis=known.chassis.still())


def exact_vector(numbers: Sequence[object], what: str) -> Vector:
    """Three numbers as fractions; NoReferenceError if there are not three."""
    if len(numbers) != 3:
        raise NoReferenceError(what, f"is {numbers!r}", "three numbers")
    return each(lambda number: as_fraction(number, what), (numbers[0], numbers[1], numbers[2]))


def balls(jet: Jet) -> Jet:
    """A jet of fractions as a jet of balls."""
    return Jet(*map(as_ball, jet.parts))


def _unit(points: Collection[Vector], origin: Vector) -> Fraction:
    size = max(abs(x) for p in points for x in minus(p, origin))
    if size == 0:
        raise NoReferenceError("points", "are all in one place", "points with some distance between them")
    power = size.numerator.bit_length() - size.denominator.bit_length()
    return Fraction(2**power) if power >= 0 else Fraction(1, 2**-power)


def _loads(plain: Mapping[str, Any]) -> dict[str, tuple[Vector, Vector]]:
    found = {}
    for part, load in plain.get("loads", {}).items():
        force, moment = load["force"], load.get("moment") or (0, 0, 0)
        found[f"{part}." if part else ""] = exact_vector(force, "force"), exact_vector(moment, "moment")
    return found
