"""A mechanism's description, compiled: equations and inputs in their final numbering."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from flint import arb

from validate.reference.compiler import Compiler, Exact, Reader, Table, at
from validate.reference.drives import Drive, drive_of
from validate.reference.errors import BadInputError
from validate.reference.jet import Jet
from validate.reference.polynomial import Polynomial, polynomial
from validate.reference.vectors import Scalar, Vector, cross, dot, each


@dataclass(frozen=True, eq=False)
class Mechanism:
    """The compiled description.

    Attributes:
        size: unknowns.
        rows: C(y, w); symbols from `size` on are the numbers w.
        names: of every row, what it says.
        places: of every point, relative to the chassis.
        frames: of every moving body two vectors fixed in it and not parallel.
        triples: the columns of every matrix R; an assembly's are right-handed.
        positive: products that are positive in an assembly: where not, a hinge is mounted the wrong way round
            or an angle is off by half a turn.
        readers: give the unknowns of assembled points, one after the other.
        drives: by input, what its numbers w are; chassis motions are not among them.
        driving: of each of these the row that its numbers are in, the last of them if there are several.
        rods: of each the row of its length.
        joints: of each point whose place two bodies say in rows the body, place - place of the other, and the
            first of the three rows.
        sliding: of each point on a slide the first of the three rows that say where it is on the line.
        closing: of the second point of each hinge that has such rows the first of the two more rows that make
            it one, and what each of them takes the product of place - place with.
    """

    size: int
    rows: tuple[Polynomial, ...]
    names: tuple[str, ...]
    places: Mapping[str, Vector]
    frames: Mapping[str, tuple[Vector, Vector]]
    triples: tuple[tuple[Vector, Vector, Vector], ...]
    positive: tuple[Polynomial, ...]
    readers: tuple[Reader, ...]
    drives: Mapping[str, Drive]
    driving: Mapping[str, int]
    rods: Mapping[str, int]
    joints: Mapping[str, tuple[str, int]]
    sliding: Mapping[str, int]
    closing: Mapping[str, tuple[int, Vector, Vector]]

    @property
    def fixed(self) -> frozenset[str]:
        """The points of the chassis."""
        constant = ((n, all(not m for x in p for m in x.terms)) for n, p in self.places.items())
        return frozenset(name for name, rests in constant if rests)

    def numbers(self, inputs: Mapping[str, Jet], exact: Exact) -> list[Jet]:
        """The numbers w of all inputs, of jets of any kind of number and a fraction in that kind."""
        return [w for drive in self.drives.values() for w in drive.numbers(inputs, exact)]

    @property
    def drawn_numbers(self) -> list[arb]:
        """The numbers w at the drawn inputs, at the present precision."""
        return [w for drive in self.drives.values() for w in drive.drawn()]

    def unknown_of(self, points: Table, numbers: Sequence[Scalar], exact: Exact) -> list[Scalar]:
        """The unknowns of assembled points, relative to the chassis, in their kind of number.

        Args:
            numbers: w. exact: a fraction in that kind.
        """
        unknown: list[Scalar] = []
        for read in self.readers:
            unknown.extend(read(points, unknown, exact, numbers))
        return unknown

    def handed(self, unknown: Sequence[Scalar], numbers: Sequence[Scalar], exact: Exact) -> list[Scalar]:
        """Numbers that are all positive in an assembly, and one of them not in a zero that is none."""
        values = [*unknown, *numbers]
        found = [one.at(values, exact) for one in self.positive]
        for columns in self.triples:
            a, b, c = (at(column, values, exact) for column in columns)
            found.append(dot(cross(a, b), c))
        return found


def compiled(plain: Mapping[str, Any], table: Table, unit: Fraction, hangs: bool = True) -> Mechanism:
    """The equations of a description, its points taken from `table`, local.

    Args:
        hangs: whether a body hangs on a point or a hinge of one before it, and a free point on a line of the
            chassis; else each joint and slide has its rows.
    Raises:
        BadInputError: something in the description cannot be.
    """
    compiler = Compiler(plain, table, unit, hangs)
    compiler.add_parts()
    drives, driving = {}, {}
    for name, spec in plain["inputs"].items():
        if "moves" not in spec and "turns" not in spec:
            drives[name] = drive_of(compiler, name, spec)
            driving[name] = len(compiler.rows) - 1
    for name in compiler.table:
        if name not in compiler.holder and name not in compiler.free:
            raise BadInputError(f"points.{name}", "in no body, rod or slide", "a point of one of them")
    size = compiler.size

    def final(vector: Vector) -> Vector:
        return each(lambda one: _final(one, size), vector)

    return Mechanism(
        size=size,
        rows=tuple(_final(row, size) for _, row in compiler.rows),
        names=tuple(name for name, _ in compiler.rows),
        places={name: final(compiler.place(name)) for name in compiler.table},
        frames={body: (final(u), final(v)) for body, (u, v) in compiler.frames.items()},
        triples=tuple((final(a), final(b), final(c)) for a, b, c in compiler.triples),
        positive=tuple(_final(one, size) for one in compiler.positive),
        readers=tuple(compiler.readers),
        drives=drives,
        driving=driving,
        rods=compiler.rods,
        joints=compiler.joints,
        sliding=compiler.sliding,
        closing={point: (row, final(u), final(v)) for point, (row, u, v) in compiler.closing.items()},
    )


def _final(one: Scalar, size: int) -> Polynomial:
    """With the symbols of the numbers behind the unknowns."""
    terms = {
        tuple(sorted(s if s >= 0 else size - 1 - s for s in monomial)): coefficient
        for monomial, coefficient in polynomial(one).terms.items()
        if coefficient
    }
    return Polynomial(terms)
