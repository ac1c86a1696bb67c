r"""The equations of a mechanism in one kind of number: their values, their Jacobian, and what they place."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

from flint import arb

from validate.reference.krawczyk import Matrix, matrix_of
from validate.reference.mechanism import Mechanism
from validate.reference.polynomial import Monomial, ordered, polynomial, value_of
from validate.reference.vectors import Scalar, Vector, each

Terms = tuple[tuple[Monomial, Scalar], ...]


@dataclass(frozen=True, eq=False)
class Equations:
    """C(y, w) with its coefficients in one kind of number; y and w may be jets or power series of it.

    Attributes:
        size: unknowns, and equations.
        rows: of each row its terms, in the unknowns and the numbers w.
        entries: (row, column, terms) of the Jacobian by the unknowns, zeros left out.
        places: of each point, relative to the chassis.
        frames: of each moving body two vectors fixed in it.
    """

    size: int
    rows: tuple[Terms, ...]
    entries: tuple[tuple[int, int, Terms], ...]
    places: Mapping[str, tuple[Terms, Terms, Terms]]
    frames: Mapping[str, tuple[tuple[Terms, Terms, Terms], tuple[Terms, Terms, Terms]]]

    def residual(self, unknown: Sequence[Scalar], numbers: Sequence[Scalar]) -> list[Scalar]:
        """C(y, w)."""
        values = ordered(unknown, numbers)
        return [value_of(row, values) for row in self.rows]

    def jacobian(self, unknown: Sequence[Scalar], numbers: Sequence[Scalar]) -> list[tuple[int, int, Scalar]]:
        """dC/dy as (row, column, entry), zeros left out."""
        values = ordered(unknown, numbers)
        return [(row, column, value_of(terms, values)) for row, column, terms in self.entries]

    def matrix(self, unknown: Sequence[arb], numbers: Sequence[arb]) -> Matrix:
        """dC/dy as a square matrix of balls."""
        return matrix_of(self.size, self.jacobian(unknown, numbers))

    def bend(self, change: Sequence[arb]) -> Matrix:
        """By how much a change of y changes dC/dy, which is linear in y."""
        return matrix_of(self.size, ((i, j, value_of(terms, change)) for i, j, terms in self._bending))

    @cached_property
    def _bending(self) -> list[tuple[int, int, Terms]]:
        """Of the entries the terms that y changes."""
        bending = (
            (i, j, tuple(term for term in terms if term[0] and term[0][0] >= 0))
            for i, j, terms in self.entries
        )
        return [entry for entry in bending if entry[2]]

    def points_of(self, unknown: Sequence[Scalar], names: Iterable[str] | None = None) -> dict[str, Vector]:
        """Where every point is, or some are, relative to the chassis."""
        return {
            name: _vector(self.places[name], unknown) for name in (self.places if names is None else names)
        }

    def frame_of(self, unknown: Sequence[Scalar], body: str) -> tuple[Vector, Vector]:
        """Two vectors fixed in a body and not parallel."""
        one, two = self.frames[body]
        return _vector(one, unknown), _vector(two, unknown)


def equations_in(
    mechanism: Mechanism, rows: Sequence[int], number: Callable[[Fraction], Scalar]
) -> Equations:
    """The equations with their coefficients in one kind of number.

    Args:
        rows: those that are solved, as many as unknowns.
        number: a fraction in that kind.
    """

    def terms(one: Scalar) -> Terms:
        found = polynomial(one).terms
        return tuple((m, number(found[m])) for m in sorted(found, key=lambda m: -len(m)))

    chosen = [mechanism.rows[row][1] for row in rows]
    return Equations(
        size=mechanism.size,
        rows=tuple(terms(row) for row in chosen),
        entries=tuple(
            (i, j, terms(row.derivative(j)))
            for i, row in enumerate(chosen)
            for j in sorted({s for m in row.terms for s in m if s >= 0})
        ),
        places={name: each(terms, place) for name, place in mechanism.places.items()},
        frames={name: (each(terms, u), each(terms, v)) for name, (u, v) in mechanism.frames.items()},
    )


def _vector(terms: tuple[Terms, Terms, Terms], values: Sequence[Scalar]) -> Vector:
    return each(lambda one: value_of(one, values), terms)
