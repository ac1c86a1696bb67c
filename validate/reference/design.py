"""The given points as exact fractions, in a frame of their own size, and the equations that they make."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import lru_cache
from typing import Any

import numpy as np
from flint import arb, arb_mat, ctx

from validate.reference.car_data import car_data
from validate.reference.chassis import ChassisMotion
from validate.reference.equations import Equations, equations_in
from validate.reference.errors import BadInputError
from validate.reference.exact import as_ball, as_fraction
from validate.reference.jet import Jet
from validate.reference.krawczyk import System
from validate.reference.mechanism import Mechanism, compiled
from validate.reference.vectors import Scalar, Vector, dot, each, minus, times

DIRECTION_SLACK = Fraction(1, 10**12)  # a float64 unit vector is off by about 1e-16; a wrong one by far more
SAME_ROW = 1e-9  # of the largest: what is left of a row that others say already, in doubles

# Every input, each (value, rate, acceleration) in fractions; rad or mm.
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
    def fixed(self) -> frozenset[str]:
        """The points of the chassis."""
        constant = ((n, all(not m for x in p for m in x.terms)) for n, p in self.mechanism.places.items())
        return frozenset(name for name, rests in constant if rests)

    def driven_at(self, name: str, rate: arb) -> Known:
        """One input at a rate, rad/s or mm/s, and all else at rest, at the same instant; in balls."""
        zero = arb(0)
        numbers: list[Jet] = []
        for one, drive in self.mechanism.drives.items():
            going = Jet(self.inputs[one].value, rate if one == name else zero, zero)
            numbers += drive.numbers(going)
        return replace(self, numbers=numbers, chassis=self.chassis.still())

    def unknown_of(self, points: Mapping[str, Vector]) -> list[arb]:
        """The unknowns of points in balls, relative to the chassis."""
        return self.mechanism.unknown_of(points, as_ball)

    def handed(self, unknown: Sequence[arb]) -> bool:
        """Whether a zero is an assembly, proven: no body is mirrored, no hinge the wrong way round."""
        return all(one > 0 for one in self.mechanism.handed(unknown, self.numbers, as_ball))

    def frames_of(self, unknown: Sequence[Scalar]) -> dict[str, tuple[Vector, Vector]]:
        """Of every moving body two vectors fixed in it, with the chassis moved."""
        frames = self.equations.frames_of(unknown)
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
        up: direction of z.
        right: direction of y.
        corners: the prefix of each part's names, and 1 where outboard is `right` there, -1 where it is the
            opposite; without parts there is one, whose names have none.
        car: what is given of the car as a whole, see `car_data`.
        loads: of the corners that have one, by their prefix, force, N, and moment, N mm, of the ground on the
            knuckle at its contact point.
        chosen: the rows that are solved, as many as unknowns; the others depend on them as drawn.
    """

    plain: Mapping[str, Any]
    mechanism: Mechanism
    table: Mapping[str, Vector]
    origin: Vector
    unit: Fraction
    up: Vector
    right: Vector
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
        z, y = exact_vector(plain["up"], "up"), exact_vector(plain["right"], "right")
        if abs(dot(z, z) - 1) > DIRECTION_SLACK or abs(dot(y, y) - 1) > DIRECTION_SLACK:
            raise BadInputError("up and right", (plain["up"], plain["right"]), "unit vectors, to 1e-12")
        if abs(dot(z, y)) > DIRECTION_SLACK:
            raise BadInputError("up and right", (plain["up"], plain["right"]), "at right angles, to 1e-12")
        car, first = car_data(plain), next(iter(given))
        unit, origin = _unit(given, first), given[first]
        table = {n: times(minus(p, origin), 1 / unit) for n, p in given.items()}
        exact = {**plain, "up": z, "right": y}
        for kind, groups in (("bodies", exact["bodies"]), ("rods", exact["rods"])):
            for name, points in groups.items():
                for point in points:
                    if point not in table:
                        raise BadInputError(f"{kind}.{name}", point, f"one of {', '.join(table)}")
        mechanism = compiled(exact, table, unit)
        corners, chosen = _corners(plain), _chosen(mechanism, table)
        loads = _loads(plain, corners)
        return cls(exact, mechanism, table, origin, unit, z, y, corners, car, loads, chosen)

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

    @property
    def wheel_radius(self) -> Fraction | None:
        """mm; None if it is not given.

        Raises:
            BadInputError: it is no number above 0.
        """
        given = self.plain.get("wheel_radius")
        if given is None:
            return None
        radius = as_fraction(given, "wheel_radius")
        if not radius > 0:
            raise BadInputError("wheel_radius", given, "a number of mm above 0")
        return radius

    def equations(self) -> Equations:
        """In balls at the present precision."""
        return _equations(self, ctx.prec)

    def driven(self, inputs: Mapping[str, Sequence[object]]) -> Driven:
        """Inputs by name as fractions; a travel or chassis motion that is not named rests at zero.

        Raises:
            BadInputError: an unknown name, not three finite numbers, or an input is missing.
        """
        for name, triple in inputs.items():
            if name not in self.inputs:
                raise BadInputError(f"inputs[{name!r}]", triple, f"one of {', '.join(self.inputs)}")
            if len(triple) != 3:
                raise BadInputError(f"inputs[{name!r}]", triple, "three numbers: value, rate, acceleration")
        required = [name for name, drive in self.mechanism.drives.items() if drive.required]
        if not set(required) <= set(inputs):
            allowed = f"a mapping that names at least {' and '.join(required)}"
            raise BadInputError("inputs", sorted(inputs), allowed)
        return {
            name: Jet(*(as_fraction(part, f"inputs[{name!r}]") for part in inputs.get(name, (0, 0, 0))))
            for name in self.inputs
        }

    def known(self, driven: Driven) -> Known:
        """What the equations take as given, as jets of balls at the present precision, local."""
        return self.known_for({name: balls(jet) for name, jet in driven.items()})

    def known_for(self, driven: Mapping[str, Jet]) -> Known:
        """The same from jets of balls, or of duals of balls; rad, mm, mm."""
        numbers = [w for name, drive in self.mechanism.drives.items() for w in drive.numbers(driven[name])]
        return Known(self.mechanism, self.equations(), numbers, ChassisMotion.of(self, driven), driven)

    def known_as_drawn(self) -> Known:
        """The same at rest at the inputs that the car is drawn at, the chassis in its place."""
        drives = self.mechanism.drives
        numbers = [Jet(w, arb(0), arb(0)) for drive in drives.values() for w in drive.drawn()]
        drawn = {name: drive.input_of(drive.drawn()) for name, drive in drives.items()}
        still = {name: Jet(drawn.get(name, arb(0)), arb(0), arb(0)) for name in self.inputs}
        return Known(self.mechanism, self.equations(), numbers, ChassisMotion.of(self, still), still)

    def drawn_unknown(self) -> list[arb]:
        """The unknowns of the points as drawn, exact numbers: what they do not meet is theirs to close."""
        places = {name: ball_vector(p) for name, p in self.table.items()}
        return [arb(number).mid() for number in self.mechanism.unknown_of(places, as_ball)]


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
    return Jet(as_ball(jet.value), as_ball(jet.rate), as_ball(jet.acceleration))


def _corners(plain: Mapping[str, Any]) -> dict[str, int]:
    given = {f"sides[{part!r}]": side for part, side in plain.get("sides", {}).items()}
    for what, side in (given or {"side": plain["side"]}).items():
        if side not in ("left", "right"):
            raise BadInputError(what, side, "'left' or 'right'")
    sides = {f"{part}.": side for part, side in plain.get("sides", {}).items()} or {"": plain["side"]}
    return {prefix: -1 if side == "left" else 1 for prefix, side in sides.items()}


def _loads(plain: Mapping[str, Any], corners: Collection[str]) -> dict[str, tuple[Vector, Vector]]:
    found = {}
    for part, load in plain.get("loads", {}).items():
        prefix, what = f"{part}." if part else "", f"loads[{part!r}]"
        if prefix not in corners:
            raise BadInputError(what, load, f"a load of a part: {', '.join(corners).replace('.', '')}")
        force, moment = load["force"], load.get("moment", (0, 0, 0))
        found[prefix] = exact_vector(force, f"{what}.force"), exact_vector(moment, f"{what}.moment")
    return found


def _unit(points: Mapping[str, Vector], origin: str) -> Fraction:
    size = max(abs(x) for p in points.values() for x in minus(p, points[origin]))
    if size == 0:
        raise BadInputError("points", "all in one place", "points with some distance between them")
    power = size.numerator.bit_length() - size.denominator.bit_length()
    return Fraction(2**power) if power >= 0 else Fraction(1, 2**-power)


def _chosen(mechanism: Mechanism, table: Mapping[str, Vector]) -> tuple[int, ...]:
    """As many rows as unknowns; of more than that those that stand most clearly apart as drawn.

    Rows are taken in turn, each time the one of which most is left beside those taken (Gram and Schmidt).
    """
    rows, size = len(mechanism.rows), mechanism.size
    if rows < size:
        allowed = f"{size} rows: drive {size - rows} more of what can move"
        raise BadInputError("the equations", f"{rows} rows for {size} unknowns", allowed)
    if rows == size:
        return tuple(range(size))
    drawn = [float(x) for x in mechanism.unknown_of({n: ball_vector(p) for n, p in table.items()}, as_ball)]
    numbers = [float(w) for drive in mechanism.drives.values() for w in drive.drawn()]
    matrix = np.array(
        [
            [float(row.derivative(j).at([*drawn, *numbers], float)) for j in range(size)]
            for row in mechanism.rows
        ]
    )
    left = matrix / np.linalg.norm(matrix, axis=1, keepdims=True)
    taken: list[int] = []
    for _ in range(size):
        lengths = np.linalg.norm(left, axis=1)
        best = int(lengths.argmax())
        if not lengths[best] > SAME_ROW:
            allowed = f"inputs and joints that leave no freedom; {size - len(taken)} are left as drawn"
            raise BadInputError(
                "the equations", f"{len(taken)} independent rows for {size} unknowns", allowed
            )
        taken.append(best)
        unit = left[best] / lengths[best]
        left = left - np.outer(left @ unit, unit)
    return tuple(sorted(taken))
