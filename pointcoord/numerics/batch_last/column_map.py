r"""A quadratic map of members that are columns: y of shape (size, members).

The rows are made of differences of coordinates, d = y_first - y_second, each taken once:

    C(y) = Q (d_left d_right) + L d,      C_u(y) = J [d, 1],

with Q, L and J matrices of small whole numbers that all members share, so that a row is rounded no more than
in the plain form (see `quadratic`). Coordinates that are constants of every mechanism, 0 and 1, are put in,
which makes most terms linear. B(a, b) is then only the bilinear part, which is all there is of it where a and
b hold no constant: steps, tangents and terms of a series.
"""

from __future__ import annotations

from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from pointcoord.data_classes import dataclass
from pointcoord.numerics.quadratic import Product, QuadraticMap
from pointcoord.numerics.rounding import UNIT_ROUNDOFF

Array = NDArray[np.float64]
Indices = NDArray[np.intp]
Constants = tuple[tuple[int, float], ...]
Entry = tuple[int, int]


@dataclass(frozen=True)
class _Terms:
    """Products of two differences by number, each with its row and coefficient, and linear ones."""

    bilinear: tuple[tuple[int, float, int, int], ...]
    linear: tuple[tuple[int, float, int], ...]
    pairs: tuple[tuple[int, int], ...]


@dataclass(frozen=True)
class ColumnMap:
    """A quadratic map with its constants put in; make one with `column_map`, which keeps it.

    Attributes:
        constants: known coordinates with the one value that they always have.
    """

    system: QuadraticMap
    constants: Constants

    @property
    def unknowns(self) -> int:
        """How many coordinates are unknown."""
        return self.system.unknowns

    @cached_property
    def _terms(self) -> _Terms:
        value = dict(self.constants)
        numbers: dict[tuple[int, int], int] = {}
        bilinear: list[tuple[int, float, int, int]] = []
        linear: list[tuple[int, float, int]] = []

        def fixed(ends: tuple[int, int]) -> float | None:
            return value[ends[0]] - value[ends[1]] if ends[0] in value and ends[1] in value else None

        def number(ends: tuple[int, int]) -> tuple[int, float]:
            if (ends[1], ends[0]) in numbers:
                return numbers[ends[1], ends[0]], -1.0
            return numbers.setdefault(ends, len(numbers)), 1.0

        # Squares come first, so that their differences lie together.
        products: list[tuple[int, Product]] = [(r, p) for r, row in enumerate(self.system.rows) for p in row]
        products.sort(key=lambda each: set(each[1].left) != set(each[1].right))
        for row, p in products:
            left, right = fixed(p.left), fixed(p.right)
            if left is not None and right is not None:
                raise ValueError(f"row {row}: {p} is a constant")
            if left is not None or right is not None:
                factor, ends = (left, p.right) if left is not None else (right, p.left)
                place, sign = number(ends)
                linear.append((row, p.coefficient * sign * (factor or 0.0), place))
                continue
            (one, one_sign), (other, other_sign) = number(p.left), number(p.right)
            bilinear.append((row, p.coefficient * one_sign * other_sign, one, other))
        return _Terms(tuple(bilinear), tuple(linear), tuple(numbers))

    @cached_property
    def ends(self) -> tuple[Indices, Indices]:
        """First and second coordinate of each difference."""
        pairs = np.array(self._terms.pairs, dtype=np.intp).reshape(-1, 2)
        return pairs[:, 0].copy(), pairs[:, 1].copy()

    @cached_property
    def _factors(self) -> tuple[Indices, Indices]:
        left = np.array([term[2] for term in self._terms.bilinear], dtype=np.intp)
        return left, np.array([term[3] for term in self._terms.bilinear], dtype=np.intp)

    @cached_property
    def _sums(self) -> tuple[Array, Array]:
        """Q, shape (rows, bilinear terms), and L, shape (rows, differences)."""
        rows = len(self.system.rows)
        q = np.zeros((rows, len(self._terms.bilinear)))
        for place, (row, coefficient, _, _) in enumerate(self._terms.bilinear):
            q[row, place] = coefficient
        linear = np.zeros((rows, len(self._terms.pairs)))
        for row, coefficient, place in self._terms.linear:
            linear[row, place] += coefficient
        return q, linear

    @cached_property
    def entries(self) -> tuple[Entry, ...]:
        """Row and unknown of every entry of C_u that may be other than zero."""
        return self._jacobian[0]

    @cached_property
    def _jacobian(self) -> tuple[tuple[Entry, ...], Array, Array]:
        """The entries, and J apart for the differences and for the 1."""
        found: dict[Entry, int] = {}
        moved: list[tuple[int, int, float]] = []
        still: list[tuple[int, float]] = []
        first, second = self.ends

        def entry(row: int, unknown: int) -> int:
            return found.setdefault((row, unknown), len(found))

        def sides(place: int) -> list[tuple[int, float]]:
            ends = ((int(first[place]), 1.0), (int(second[place]), -1.0))
            return [(i, sign) for i, sign in ends if i < self.unknowns]

        for row, coefficient, left, right in self._terms.bilinear:
            for one, other in ((left, right), (right, left)):
                moved += [(entry(row, i), other, sign * coefficient) for i, sign in sides(one)]
        for row, coefficient, place in self._terms.linear:
            still += [(entry(row, i), sign * coefficient) for i, sign in sides(place)]
        by_differences, alone = np.zeros((len(found), len(first))), np.zeros(len(found))
        for number, place, value in moved:
            by_differences[number, place] += value
        for number, value in still:
            alone[number] += value
        return tuple(found), by_differences, alone

    def differences(self, y: Array) -> Array:
        """d of coordinates y, shape (size, members)."""
        first, second = self.ends
        return np.asarray(y.take(first, axis=0) - y.take(second, axis=0))

    def residual(self, d: Array) -> Array:
        """C(y) from y's differences, shape (rows, members)."""
        _, linear = self._sums
        return self.bilinear(d) + linear @ d

    def bilinear(self, d: Array) -> Array:
        """B(h, h) of what holds no constant, from its differences, shape (rows, members)."""
        left, right = self._factors
        return np.asarray(self._sums[0] @ (d.take(left, axis=0) * d.take(right, axis=0)))

    def polar(self, d: Array, e: Array) -> Array:
        """2 B(g, h) of what holds no constant, from differences, shape (rows, members)."""
        left, right = self._factors
        products = d.take(left, axis=0) * e.take(right, axis=0)
        products += e.take(left, axis=0) * d.take(right, axis=0)
        return np.asarray(self._sums[0] @ products)

    def derivative(self, d: Array, e: Array) -> Array:
        """C'(y) h from the differences d of y and e of h, which holds no constant."""
        return self.polar(d, e) + self._sums[1] @ e

    def jacobian(self, d: Array, out: Array | None = None) -> Array:
        """The entries of C_u(y) from y's differences, shape (entries, members)."""
        _, by_differences, alone = self._jacobian
        result = np.matmul(by_differences, d, out=out)
        result += alone[:, None]
        return np.asarray(result)

    def jacobian_along(self, e: Array) -> Array:
        """The entries of C_u(h) of what holds no constant, from its differences."""
        return np.asarray(self._jacobian[1] @ e)

    def uncertainty(self, d: Array, data: Array) -> Array:
        """How far the computed C(y) may be from the exact one, shape (rows, members); see `quadratic`.

        Args:
            d: differences. data: uncertainty of every coordinate, shape (size,).
        """
        first, second = self.ends
        left, right = self._factors
        q, linear = self._sums
        gamma = (max(len(row) for row in self.system.rows) + 3) * UNIT_ROUNDOFF
        size = np.abs(d)
        own = (data[first] + data[second])[:, None]
        doubt = UNIT_ROUNDOFF * size + own
        one, other = size.take(left, axis=0), size.take(right, axis=0)
        spread = one * (gamma * other + doubt.take(right, axis=0))
        spread += doubt.take(left, axis=0) * (other + doubt.take(right, axis=0))
        return np.asarray(np.abs(q) @ spread + np.abs(linear) @ (gamma * size + doubt))

    def jacobian_uncertainty(self, d: Array, data: Array) -> Array:
        """How far the computed entries of C_u(y) may be from the exact ones, shape (entries, members).

        Args:
            d: differences, or what is at least their magnitudes. data: uncertainty of every coordinate,
                shape (size,), or (size, members).
        """
        first, second = self.ends
        _, by_differences, alone = self._jacobian
        # A difference is rounded once, and a sum as often as it has terms.
        gamma = (int(np.count_nonzero(by_differences, axis=-1).max(initial=0)) + 2) * UNIT_ROUNDOFF
        doubt = gamma * np.abs(d) + (data[first] + data[second]).reshape(len(first), -1)
        return np.asarray(np.abs(by_differences) @ doubt + gamma * np.abs(alone)[:, None])

    @cached_property
    def convolution(self) -> Convolution:
        """The bilinear terms, for sums over the orders of a series."""
        left, right = self._factors
        squares = left == right
        count = int(np.count_nonzero(squares))
        if not squares[:count].all():
            raise ValueError("squares come first")
        return Convolution(self._sums[0], left[:count], left[count:], right[count:])


@dataclass(frozen=True)
class Convolution:
    """sum_i B(y_i, y_{k-i}) by differences: squares apart, because half their products are the other half.

    Attributes:
        sums: Q, its columns the squares and then the others. squares, left, right: numbers of differences.
    """

    sums: Array
    squares: Indices
    left: Indices
    right: Indices

    def of_moving(self, moves: NDArray[np.bool_]) -> Convolution:
        """The part of it that is left where only some differences change."""
        squares, both = moves[self.squares], moves[self.left] & moves[self.right]
        return Convolution(
            np.ascontiguousarray(self.sums[:, np.concatenate([squares, both])]),
            self.squares[squares],
            self.left[both],
            self.right[both],
        )


@lru_cache(maxsize=64)
def column_map(system: QuadraticMap, constants: Constants) -> ColumnMap:
    """The map for members that are columns; the same for every mechanism of a topology."""
    return ColumnMap(system, constants)
