"""The drawn points as exact fractions, scaled to the mechanism's size, and the mechanism's equations."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np

from validate.reference.car_data import car_data, corners
from validate.reference.chassis import ChassisMotion
from validate.reference.drives import compiled
from validate.reference.equations import Equations, equations_in
from validate.reference.errors import NoReferenceError
from validate.reference.exact import as_ball, as_fraction
from validate.reference.jet import Jet
from validate.reference.mechanism import Mechanism
from validate.reference.vectors import Exact, Scalar, Vector, each, minus, times

SAME_ROW = 1e-9  # relative to the largest pivot: a row with a smaller pivot depends on others, in doubles

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

    mechanism: Mechanism
    equations: Equations
    numbers: Sequence[Scalar]
    chassis: ChassisMotion
    inputs: Mapping[str, Jet]

    @classmethod
    def of(
        cls,
        mechanism: Mechanism,
        equations: Equations,
        inputs: Mapping[str, Jet],
        exact: Exact,
    ) -> Known:
        """From the inputs as jets of any kind of number; `exact` converts a fraction to this kind."""
        chassis = ChassisMotion.of(mechanism.plain, mechanism.table, mechanism.unit, inputs, exact)
        return cls(mechanism, equations, mechanism.numbers(inputs, exact), chassis, inputs)

    @property
    def derivatives(self) -> int:
        """Number of known time derivatives of the inputs."""
        return max((len(jet.parts) for jet in self.inputs.values()), default=3) - 1

    def driven_at(self, name: str, rate: Scalar, exact: Exact) -> Known:
        """This instant with one input at a rate, rad/s or mm/s, and the others at rest."""
        rates = dict.fromkeys(self.inputs, rate * 0) | {name: rate}
        inputs = {one: Jet(jet.value, jet.value * 0 + rates[one]) for one, jet in self.inputs.items()}
        return Known.of(self.mechanism, self.equations, inputs, exact)

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
        chosen: the rows that are solved, as many as unknowns; the other rows depend on these as drawn.
    """

    plain: Mapping[str, Any]
    mechanism: Mechanism
    table: Mapping[str, Vector]
    origin: Vector
    unit: Fraction
    corners: Mapping[str, int]
    car: Mapping[str, Fraction]
    loads: Mapping[str, tuple[Vector, Vector]]
    chosen: tuple[int, ...]

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
        chosen = _chosen(mechanism)
        return cls(
            exact, mechanism, table, origin, unit, corners(plain), car_data(plain), _loads(plain), chosen
        )

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the points."""
        return tuple(self.table)

    @property
    def inputs(self) -> tuple[str, ...]:
        """The names of the inputs."""
        return tuple(self.plain["inputs"])

    def role(self, name: str) -> Any:
        """The value of a role of the mechanism, or None."""
        return self.plain["roles"].get(name)

    def equations(self, number: Exact = as_ball) -> Equations:
        """The equations in one kind of number; by default in balls at the present precision."""
        return equations_in(self.mechanism, self.chosen, number)

    def driven(self, inputs: Mapping[str, Sequence[object]]) -> Driven:
        """Inputs by name as fractions; an input that is not given rests at zero."""
        count = max((len(law) for law in inputs.values()), default=3)
        return {
            name: Jet(*(as_fraction(part, f"inputs[{name!r}]") for part in inputs.get(name, (0,) * count)))
            for name in self.inputs
        }

    def known(self, driven: Driven) -> Known:
        """The known data of the equations, as jets of balls at the present precision, local."""
        inputs = {name: balls(jet) for name, jet in driven.items()}
        return Known.of(self.mechanism, self.equations(), inputs, as_ball)


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


def _chosen(mechanism: Mechanism) -> tuple[int, ...]:
    """As many rows as unknowns; of redundant rows those that are most clearly independent as drawn.

    QR with pivoting takes, one by one, the row with the largest part independent of those taken.
    """
    rows, size = len(mechanism.rows), mechanism.size
    if rows < size:
        allowed = f"{size} rows: drive {size - rows} more of what can move"
        raise NoReferenceError("the equations", f"are {rows} rows for {size} unknowns", allowed)
    if rows == size:
        return tuple(range(size))
    from scipy.linalg import qr  # few mechanisms need it, and it takes long to import

    drawn, numbers = ([float(x) for x in of] for of in (mechanism.drawn_unknown, mechanism.drawn_numbers))
    every = equations_in(mechanism, range(rows), float)
    matrix = np.zeros((rows, size))
    for i, j, entry in every.jacobian(drawn, numbers):
        matrix[i, j] = entry
    triangle, taken = qr(matrix.T / np.linalg.norm(matrix, axis=1), mode="r", pivoting=True)
    rank = int((np.abs(np.diag(triangle)) > SAME_ROW).sum())
    if rank < size:
        allowed = f"inputs and joints that leave no degree of freedom; {size - rank} are left as drawn"
        raise NoReferenceError("the equations", f"are {rank} independent rows for {size} unknowns", allowed)
    return tuple(sorted(int(row) for row in taken[:size]))
