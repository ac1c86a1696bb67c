"""The given points as exact fractions, in a frame of their own size, and the equations that they make."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import lru_cache
from typing import Any

import numpy as np
from flint import arb, arb_mat, ctx

from validate.reference.car_data import car_data, corners
from validate.reference.chassis import ChassisMotion
from validate.reference.drives import compiled
from validate.reference.equations import Equations, equations_in
from validate.reference.errors import BadInputError
from validate.reference.exact import as_ball, as_fraction
from validate.reference.jet import Jet
from validate.reference.krawczyk import System
from validate.reference.mechanism import Mechanism
from validate.reference.vectors import Scalar, Vector, dot, each, minus, times

DIRECTION_SLACK = Fraction(1, 10**12)  # a float64 unit vector is off by about 1e-16; a wrong one by far more
SAME_ROW = 1e-9  # of the largest: what is left of a row that others say already, in doubles

# Every input, each (value, rate, acceleration) in fractions, or with more of its derivatives; rad or mm.
Driven = Mapping[str, Jet]


@dataclass(frozen=True)
class Known:
    """What the equations take as given at one instant; scalars may be balls, floats, arrays or jets.

    Attributes:
        mechanism: whose equations hold.
        equations: in that kind of number.
        numbers: w.
        chassis: how the car as a whole is moved.
        inputs: what w and the chassis follow, as jets by name, rad and mm.
    """

    mechanism: Mechanism
    equations: Equations
    numbers: Sequence[Scalar]
    chassis: ChassisMotion
    inputs: Mapping[str, Jet]

    @property
    def derivatives(self) -> int:
        """How many time derivatives of the inputs are known."""
        return max((len(jet.parts) for jet in self.inputs.values()), default=3) - 1

    def driven_at(self, name: str, rate: arb) -> Known:
        """One input at a rate, rad/s or mm/s, and all else at rest, at the same instant; in balls."""
        inputs = {one: Jet(jet.value, rate if one == name else arb(0)) for one, jet in self.inputs.items()}
        numbers = self.mechanism.numbers(inputs, as_ball)
        return replace(self, numbers=numbers, chassis=self.chassis.still())

    def handed(self, unknown: Sequence[arb]) -> bool:
        """Whether a zero is an assembly, proven: no body is mirrored, no hinge the wrong way round."""
        return all(one > 0 for one in self.mechanism.handed(unknown, self.numbers, as_ball))

    def frames_of(self, unknown: Sequence[Scalar]) -> dict[str, tuple[Vector, Vector]]:
        """Of every moving body two vectors fixed in it, with the chassis moved."""
        frames = {name: self.equations.frame_of(unknown, name) for name in self.equations.frames}
        return {n: (self.chassis.turned(u), self.chassis.turned(v)) for n, (u, v) in frames.items()}

    def points_of(self, unknown: Sequence[Scalar]) -> dict[str, Vector]:
        """Where every point is, with the chassis moved."""
        return {name: self.chassis.moved(p) for name, p in self.equations.points_of(unknown).items()}

    def residual(self, unknown: Sequence[Scalar]) -> list[Scalar]:
        """C(y, w)."""
        return self.equations.residual(unknown, self.numbers)

    def matrix(self, unknown: Sequence[arb]) -> arb_mat:
        """dC/dy as a square matrix of balls."""
        return self.equations.matrix(unknown, self.numbers)

    @property
    def system(self) -> System:
        """C(y, w) = 0 in y; numbers are balls."""
        return System(self.residual, self.matrix, self.equations.bend)


@dataclass(frozen=True, eq=False)
class Design:
    """The mechanism as given. Local coordinates are (p - origin) / unit, exact.

    The shift and the unit keep balls tight whether the points lie 1e9 mm from the frame's origin or
    the mechanism is 1e-3 or 1e6 mm in size.

    Attributes:
        plain: the description, see `pointcoord/mechanisms/README.md`; its points are not read after this.
        mechanism: its equations.
        table: the points, by name, local.
        origin: the first point, mm.
        unit: a power of two near the mechanism's size, mm.
        corners, car: see `car_data`.
        loads: of the corners that have one, by their prefix, force, N, and moment, N mm, of the ground on the
            knuckle at its contact point.
        chosen: the rows that are solved, as many as unknowns; the others depend on them as drawn.
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
        """Take over a description, mm.

        Raises:
            BadInputError: a point is unknown, a number is not finite, `up` and `right` are not unit vectors
                at right angles, a number of the car cannot be, a rod or a body has no extent, or freedoms and
                inputs are not as many.
        """
        given = {name: exact_vector(place, f"points[{name!r}]") for name, place in plain["points"].items()}
        if not given:
            raise BadInputError("points", "none", "at least one")
        up, right = exact_vector(plain["up"], "up"), exact_vector(plain["right"], "right")
        for off, allowed in (
            (max(abs(dot(up, up) - 1), abs(dot(right, right) - 1)), "unit vectors"),
            (abs(dot(up, right)), "at right angles"),
        ):
            if off > DIRECTION_SLACK:
                raise BadInputError("up and right", (plain["up"], plain["right"]), f"{allowed}, to 1e-12")
        for kind in ("bodies", "rods"):
            for name, points in plain[kind].items():
                for point in points:
                    if point not in given:
                        raise BadInputError(f"{kind}.{name}", point, f"one of {', '.join(given)}")
        origin = next(iter(given.values()))
        unit, parts = _unit(given.values(), origin), corners(plain)
        table = {name: times(minus(p, origin), 1 / unit) for name, p in given.items()}
        exact = {**plain, "up": up, "right": right}
        mechanism = compiled(exact, table, unit)
        return cls(
            exact,
            mechanism,
            table,
            origin,
            unit,
            parts,
            car_data(plain),
            _loads(plain, parts),
            _chosen(mechanism, table),
        )

    @property
    def names(self) -> tuple[str, ...]:
        """The points that this car has."""
        return tuple(self.table)

    @property
    def inputs(self) -> tuple[str, ...]:
        """The inputs that it takes."""
        return tuple(self.plain["inputs"])

    def role(self, name: str) -> Any:
        """What a role names, or None."""
        return self.plain["roles"].get(name)

    def equations(self) -> Equations:
        """In balls at the present precision."""
        return _equations(self, ctx.prec)

    def driven(self, inputs: Mapping[str, Sequence[object]]) -> Driven:
        """Inputs by name as fractions; a travel or chassis motion that is not named rests at zero.

        Raises:
            BadInputError: an unknown name, fewer than three finite numbers, not as many of each, or an input
                is missing.
        """
        count = max((len(law) for law in inputs.values()), default=3)
        for name, law in inputs.items():
            if name not in self.inputs:
                raise BadInputError(f"inputs[{name!r}]", law, f"one of {', '.join(self.inputs)}")
            if len(law) != count or count < 3:
                allowed = "three numbers: value, rate, acceleration; or of all inputs as many more"
                raise BadInputError(f"inputs[{name!r}]", law, allowed)
        required = [name for name, drive in self.mechanism.drives.items() if drive.required]
        if not set(required) <= set(inputs):
            allowed = f"a mapping that names at least {' and '.join(required)}"
            raise BadInputError("inputs", sorted(inputs), allowed)
        return {
            name: Jet(*(as_fraction(part, f"inputs[{name!r}]") for part in inputs.get(name, (0,) * count)))
            for name in self.inputs
        }

    def known(self, driven: Driven) -> Known:
        """What the equations take as given, as jets of balls at the present precision, local."""
        inputs = {name: balls(jet) for name, jet in driven.items()}
        numbers = self.mechanism.numbers(inputs, as_ball)
        return self._known(numbers, inputs)

    def known_as_drawn(self) -> Known:
        """The same at rest at the inputs that the car is drawn at, the chassis in its place."""
        drives, zero = self.mechanism.drives, arb(0)
        drawn = {name: drive.input_of(drive.drawn()) for name, drive in drives.items()}
        numbers = [Jet(w, zero, zero) for w in self.mechanism.drawn_numbers]
        return self._known(numbers, {name: Jet(drawn.get(name, zero), zero, zero) for name in self.inputs})

    def _known(self, numbers: Sequence[Jet], inputs: Mapping[str, Jet]) -> Known:
        chassis = ChassisMotion.of(self.plain, self.table, self.unit, inputs, as_ball)
        return Known(self.mechanism, self.equations(), numbers, chassis, inputs)

    def drawn_unknown(self) -> list[arb]:
        """The unknowns of the points as drawn, exact numbers: what they do not meet is theirs to close."""
        places = {name: ball_vector(p) for name, p in self.table.items()}
        unknown = self.mechanism.unknown_of(places, self.mechanism.drawn_numbers, as_ball)
        return [arb(number).mid() for number in unknown]


@lru_cache(maxsize=256)
def _equations(design: Design, precision: int) -> Equations:
    return equations_in(design.mechanism, design.chosen, as_ball)


def values_only(known: Known) -> Known:
    """The same with the values of the jets, for the position equations."""
    return replace(known, numbers=[jet.value for jet in known.numbers], chassis=known.chassis.still())


def exact_vector(numbers: Sequence[object], what: str) -> Vector:
    """Three numbers as fractions; `BadInputError` if there are not three."""
    if len(numbers) != 3:
        raise BadInputError(what, numbers, "three numbers")
    return each(lambda number: as_fraction(number, what), (numbers[0], numbers[1], numbers[2]))


def ball_vector(vector: Vector) -> Vector:
    """Three fractions as balls."""
    return each(as_ball, vector)


def balls(jet: Jet) -> Jet:
    """A jet of fractions as a jet of balls."""
    return Jet(*map(as_ball, jet.parts))


def _unit(points: Collection[Vector], origin: Vector) -> Fraction:
    size = max(abs(x) for p in points for x in minus(p, origin))
    if size == 0:
        raise BadInputError("points", "all in one place", "points with some distance between them")
    power = size.numerator.bit_length() - size.denominator.bit_length()
    return Fraction(2**power) if power >= 0 else Fraction(1, 2**-power)


def _loads(plain: Mapping[str, Any], corners: Collection[str]) -> dict[str, tuple[Vector, Vector]]:
    found = {}
    for part, load in plain.get("loads", {}).items():
        prefix, what = f"{part}." if part else "", f"loads[{part!r}]"
        if prefix not in corners:
            raise BadInputError(what, load, f"a load of a part: {', '.join(corners).replace('.', '')}")
        force, moment = load["force"], load.get("moment") or (0, 0, 0)
        found[prefix] = exact_vector(force, f"{what}.force"), exact_vector(moment, f"{what}.moment")
    return found


def _chosen(mechanism: Mechanism, table: Mapping[str, Vector]) -> tuple[int, ...]:
    """As many rows as unknowns; of more than that those that stand most clearly apart as drawn.

    Rows are taken in turn, each time the one of which most is left beside those taken (QR with pivots).
    """
    rows, size = len(mechanism.rows), mechanism.size
    if rows < size:
        allowed = f"{size} rows: drive {size - rows} more of what can move"
        raise BadInputError("the equations", f"{rows} rows for {size} unknowns", allowed)
    if rows == size:
        return tuple(range(size))
    from scipy.linalg import qr  # few mechanisms need it, and it takes long to import

    places, w = {n: ball_vector(p) for n, p in table.items()}, mechanism.drawn_numbers
    drawn, numbers = [float(x) for x in mechanism.unknown_of(places, w, as_ball)], [float(x) for x in w]
    every = equations_in(mechanism, range(rows), float)
    matrix = np.zeros((rows, size))
    for i, j, entry in every.jacobian(drawn, numbers):
        matrix[i, j] = entry
    triangle, taken = qr(matrix.T / np.linalg.norm(matrix, axis=1), mode="r", pivoting=True)
    rank = int((np.abs(np.diag(triangle)) > SAME_ROW).sum())
    if rank < size:
        allowed = f"inputs and joints that leave no freedom; {size - rank} are left as drawn"
        raise BadInputError("the equations", f"{rank} independent rows for {size} unknowns", allowed)
    return tuple(sorted(int(row) for row in taken[:size]))
