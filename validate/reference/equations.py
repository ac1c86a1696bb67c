"""The equations of a mechanism in one kind of number: values, Jacobian, and places of points and bodies."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

from flint import arb, ctx

from validate.reference.krawczyk import Matrix, matrix_of
from validate.reference.mechanism import Mechanism, at, of_kind
from validate.reference.polynomial import Polynomial, ordered
from validate.reference.vectors import Exact, Scalar, Vector


@dataclass(frozen=True, eq=False)
class Equations:
    """C(y, w) with coefficients in one kind of number; y and w may be jets or power series of this kind.

    Attributes:
        size: number of unknowns, and of equations.
        rows: C, in the unknowns and the numbers w.
        entries: nonzero entries (row, column, entry) of the Jacobian by the unknowns.
        places: position of each point, relative to the chassis.
        frames: two vectors fixed in each moving body.
    """

    size: int
    rows: tuple[Polynomial, ...]
    entries: tuple[tuple[int, int, Polynomial], ...]
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
        return matrix_of(self.size, self.jacobian(unknown, numbers))

    def bend(self, change: Sequence[arb]) -> Matrix:
        """The change of dC/dy for a change of y; dC/dy is linear in y."""
        return matrix_of(self.size, ((i, j, entry.at(change)) for i, j, entry in self._bending))

    @cached_property
    def _bending(self) -> list[tuple[int, int, Polynomial]]:
        """The terms of the entries that depend on y."""
        bending = (
            (i, j, Polynomial({m: x for m, x in entry.terms.items() if m and m[0] >= 0}))
            for i, j, entry in self.entries
        )
        return [entry for entry in bending if entry[2].terms]

    def points_of(self, unknown: Sequence[Scalar], names: Iterable[str] | None = None) -> dict[str, Vector]:
        """Positions of all or some points, relative to the chassis."""
        return {n: at(self.places[n], unknown) for n in (self.places if names is None else names)}

    def frame_of(self, unknown: Sequence[Scalar], body: str) -> tuple[Vector, Vector]:
        """Two vectors fixed in a body, not parallel."""
        one, two = self.frames[body]
        return at(one, unknown), at(two, unknown)


def equations_in(mechanism: Mechanism, rows: Sequence[int], number: Exact) -> Equations:
    """The equations in one kind of number, cached for the present precision.

    Args:
        rows: the rows that are solved, as many as unknowns.
        number: converts a fraction to that kind of number.
    """
    return _equations(mechanism, tuple(rows), number, ctx.prec)


@lru_cache(maxsize=256)
def _equations(mechanism: Mechanism, rows: tuple[int, ...], number: Exact, precision: int) -> Equations:
    chosen = [mechanism.rows[row][1] for row in rows]
    return Equations(
        size=mechanism.size,
        rows=tuple(row.of_kind(number) for row in chosen),
        entries=tuple(
            (i, j, row.derivative(j).of_kind(number))
            for i, row in enumerate(chosen)
            for j in sorted({s for m in row.terms for s in m if s >= 0})
        ),
        places={name: of_kind(place, number) for name, place in mechanism.places.items()},
        frames={n: (of_kind(u, number), of_kind(v, number)) for n, (u, v) in mechanism.frames.items()},
    )
