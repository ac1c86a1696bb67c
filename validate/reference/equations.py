"""The equations of a mechanism in one kind of number: values, Jacobian, and places of points and bodies."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

from flint import arb, ctx

from validate.reference.exact import as_ball
from validate.reference.krawczyk import Matrix, matrix_of
from validate.reference.mechanism import Mechanism, at, of_kind
from validate.reference.polynomial import Polynomial, ordered
from validate.reference.vectors import Exact, Scalar, Vector


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
    return Equations(
        mechanism=mechanism,
        number=number,
        rows=tuple(row.of_kind(number) for row in chosen),
        entries=tuple(
            (i, j, row.derivative(j).of_kind(number)) for i, row in enumerate(chosen) for j in row.unknowns
        ),
        places={name: of_kind(place, number) for name, place in mechanism.places.items()},
        frames={n: (of_kind(u, number), of_kind(v, number)) for n, (u, v) in mechanism.frames.items()},
    )
