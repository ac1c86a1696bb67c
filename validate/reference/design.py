"""The drawing as exact fractions, scaled to the mechanism's size, and its equations in any kind of number."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import lru_cache
from typing import Any

from flint import arb, ctx

from validate.reference.car_data import car_data, corners
from validate.reference.chassis import ChassisMotion
from validate.reference.drives import compiled
from validate.reference.errors import NoReferenceError
from validate.reference.exact import as_ball, as_fraction
from validate.reference.jet import Jet
from validate.reference.krawczyk import Matrix, matrix_of
from validate.reference.mechanism import Mechanism
from validate.reference.polynomial import Polynomial, at, of_kind, ordered
from validate.reference.vectors import Exact, Scalar, Vector, minus, times

Driven = Mapping[str, Jet]
"""Value, rate, acceleration and perhaps higher derivatives of every input, in fractions; rad or mm."""


@dataclass(frozen=True, eq=False)
class Equations:
    """C(y, w) with coefficients in one kind of number; y and w may be jets or power series of this kind.

    Attributes:
        number: converts a fraction to this kind of number.
        rows: C, in the unknowns and the numbers w; as many as unknowns.
        entries: nonzero entries (row, column, entry) of the Jacobian by the unknowns.
        places: position of each point, relative to the chassis.
        frames: two vectors fixed in each moving body.
    """

    mechanism: Mechanism
    number: Exact
    rows: Sequence[Polynomial]
    entries: Sequence[tuple[int, int, Polynomial]]
    places: Mapping[str, Vector]
    frames: Mapping[str, tuple[Vector, Vector]]

    def residual(self, unknown: Sequence[Scalar], numbers: Sequence[Scalar]) -> list[Scalar]:
        """C(y, w)."""
        values = ordered(unknown, numbers)
        return [row.at(values) for row in self.rows]

    def jacobian(self, unknown: Sequence[Scalar], numbers: Sequence[Scalar]) -> list[tuple[int, int, Scalar]]:
        """Nonzero entries of dC/dy as (row, column, entry)."""
        values = ordered(unknown, numbers)
        return [(row, column, entry.at(values)) for row, column, entry in self.entries]

    def matrix(self, unknown: Sequence[arb], numbers: Sequence[arb]) -> Matrix:
        """dC/dy as a square matrix of balls."""
        return matrix_of(len(self.rows), self.jacobian(unknown, numbers))

    def points_of(self, unknown: Sequence[Scalar], names: Iterable[str] | None = None) -> dict[str, Vector]:
        """Positions of all or some points, relative to the chassis."""
        return {n: at(self.places[n], unknown) for n in (self.places if names is None else names)}

    def frame_of(self, unknown: Sequence[Scalar], body: str) -> tuple[Vector, Vector]:
        """Two vectors fixed in a body, not parallel."""
        one, two = self.frames[body]
        return at(one, unknown), at(two, unknown)


def equations_in(mechanism: Mechanism, number: Exact = as_ball) -> Equations:
    """The equations in one kind of number, cached for the present precision.

    Args:
        number: converts a fraction to that kind of number.
    """
    return _equations(mechanism, number, ctx.prec)


@lru_cache(maxsize=256)
def _equations(mechanism: Mechanism, number: Exact, precision: int) -> Equations:
    chosen = [mechanism.rows[row][1] for row in mechanism.chosen]
    entries = [
        (i, j, row.derivative(j).of_kind(number)) for i, row in enumerate(chosen) for j in row.unknowns
    ]
    places = {name: of_kind(place, number) for name, place in mechanism.places.items()}
    frames = {n: (of_kind(u, number), of_kind(v, number)) for n, (u, v) in mechanism.frames.items()}
    return Equations(mechanism, number, [row.of_kind(number) for row in chosen], entries, places, frames)


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


def values_only(known: Known) -> Known:
    """The known data for the position equations: the jets' values, without derivatives."""
    return replace(known, numbers=[jet.value for jet in known.numbers], chassis=known.chassis.still())


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
        table = {name: _vector(place, f"points[{name!r}]") for name, place in plain["points"].items()}
        origin = next(iter(table.values()))
        size = max(abs(x) for place in table.values() for x in minus(place, origin))
        if size == 0:
            raise NoReferenceError("points", "are all in one place", "points with some distance between them")
        unit = Fraction(2) ** (size.numerator.bit_length() - size.denominator.bit_length())
        table = {name: times(minus(p, origin), 1 / unit) for name, p in table.items()}
        exact = {**plain, "up": _vector(plain["up"], "up"), "right": _vector(plain["right"], "right")}
        mechanism = compiled(exact, table, unit)
        equations_in(mechanism)  # refuses what is not determined
        loads = {
            f"{part}." if part else "": (
                _vector(load["force"], "force"),
                _vector(load.get("moment") or (0, 0, 0), "moment"),
            )
            for part, load in plain.get("loads", {}).items()
        }
        return cls(exact, mechanism, table, origin, unit, corners(plain), car_data(plain), loads)

    def role(self, name: str) -> Any:
        """The value of a role of the mechanism, or None."""
        return self.plain["roles"].get(name)

    def driven(self, inputs: Mapping[str, Sequence[object]]) -> Driven:
        """Inputs by name as fractions; an input that is not given rests at zero."""
        count = max((len(law) for law in inputs.values()), default=3)
        return {
            name: Jet(*(as_fraction(part, f"inputs[{name!r}]") for part in inputs.get(name, (0,) * count)))
            for name in self.plain["inputs"]
        }

    def known(self, driven: Driven) -> Known:
        """The known data of the equations, as jets of balls at the present precision, local."""
        return Known.of(equations_in(self.mechanism), {name: balls(jet) for name, jet in driven.items()})


def balls(jet: Jet) -> Jet:
    """A jet of fractions as a jet of balls."""
    return Jet(*map(as_ball, jet.parts))


def _vector(numbers: Sequence[object], what: str) -> Vector:
    x, y, z = (as_fraction(number, what) for number in numbers)
    return x, y, z
