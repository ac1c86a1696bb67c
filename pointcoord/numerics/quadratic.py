r"""The quadratic map: every constraint of a mechanism is one sparse quadratic form.

All coordinates are stacked in y = [u, w], unknowns first. The known coordinates w contain the constants 0 and
1 besides chassis points and inputs. So linear and constant terms are quadratic too, and the whole map is
homogeneous:

    C_r(y) = sum_t c_t (y_a - y_b)(y_c - y_d)  =  B_r(y, y)      (terms t of row r)

with the polar form B(a, b) = B(b, a), the Jacobian C'(y) h = 2 B(y, h), and B constant. Terms are products of
two differences because constraints have this form, and because taking the difference first loses no digits
for points that are close together and far from the origin.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from math import frexp

import numpy as np

from pointcoord.numerics.arrays import Array, Indices
from pointcoord.numerics.block_order import BlockOrder, block_order_of
from pointcoord.numerics.few_entries import product_of_few_entries
from pointcoord.numerics.rounding import UNIT_ROUNDOFF


@dataclass(frozen=True)
class Product:
    """c (y_a - y_b)(y_c - y_d), with left = (a, b) and right = (c, d).

    Attributes:
        coefficient: a power of two with a sign, so that it is exact; other factors of a product are
            coordinates.
    """

    coefficient: float
    left: tuple[int, int]
    right: tuple[int, int]


Row = tuple[Product, ...]
# Index arrays of a derivative's entries; see `_pattern`.
Pattern = tuple[Indices, Indices, Array, Indices, Indices]


@dataclass(frozen=True)
class _Curvature:
    """The entries 2 B_rjk of a map by pairs of unknowns (j, k), with proportional columns stored once.

    For a link most pairs have one entry, and the coordinates of a point all have those of its links. So a few
    directions represent all pairs.

    Attributes:
        first, second, scales: the pairs by direction, and their positive factors, (pairs,).
        starts: index of each direction's first pair, (directions,).
        table: the entries of each direction, (rows of the map, directions).
    """

    first: Indices
    second: Indices
    scales: Array
    starts: Indices
    table: Array

    @classmethod
    def of(cls, pairs: Mapping[tuple[int, int], Mapping[int, float]], count: int) -> _Curvature:
        """From the entries of each pair, by row, and the number of rows."""
        directions: dict[tuple[tuple[int, float], ...], list[tuple[int, int, float]]] = {}
        for (j, k), own in pairs.items():
            kept = sorted((row, value) for row, value in own.items() if value)
            if kept:
                scale = kept[0][1]
                direction = tuple((row, value / scale) for row, value in kept)
                directions.setdefault(direction, []).append((j, k, abs(scale)))
        found = [pair for same in directions.values() for pair in same]
        table = np.zeros((count, len(directions)))
        for column, direction in enumerate(directions):
            for row, value in direction:
                table[row, column] = value
        return cls(
            np.array([j for j, _, _ in found], dtype=np.intp),
            np.array([k for _, k, _ in found], dtype=np.intp),
            np.array([scale for _, _, scale in found]),
            np.cumsum([0, *(len(same) for same in directions.values())])[:-1].astype(np.intp),
            table,
        )

    def sizes(self, weights: Array) -> Array:
        """sum g_j g_k |scale| over the pairs of each direction, shape (..., directions)."""
        products = weights.take(self.first, axis=-1) * weights.take(self.second, axis=-1) * self.scales
        return np.asarray(np.add.reduceat(products, self.starts, axis=-1))

    def bent(self, preconditioner: Array, weights: Array | None) -> Array:
        """sum_jk |sum_r X_ir 2 B_rjk| g_j g_k, shape (..., unknowns); without weights, g = 1."""
        sizes = self.plain if weights is None else self.sizes(weights)
        turned = product_of_few_entries(preconditioner, self.table)
        return np.asarray(np.matvec(np.abs(turned, out=turned), sizes))

    @cached_property
    def plain(self) -> Array:
        """The sizes for weights of 1, (directions,)."""
        return np.asarray(np.add.reduceat(self.scales, self.starts))


@dataclass(frozen=True, eq=False)
class QuadraticMap:
    """A system of quadratic rows in `size` coordinates, of which the first `unknowns` are unknown.

    Every array may have leading batch dimensions, and no code loops over them. A map is equal to itself only,
    so that derived data can be cached by the map.
    """

    rows: tuple[Row, ...]
    unknowns: int
    size: int

    @cached_property
    def _terms(self) -> tuple[Array, Indices, Indices, Indices]:
        """Coefficients of all terms; both ends of the left and then of the right factors, (2 terms,) each;
        and the index of each row's first term.
        """
        products = [product for row in self.rows for product in row]
        ends = np.array([p.left for p in products] + [p.right for p in products], dtype=np.intp).reshape(
            -1, 2
        )
        starts = np.cumsum([0, *(len(row) for row in self.rows[:-1])])
        coefficients = np.array([p.coefficient for p in products])
        return coefficients, ends[:, 0].copy(), ends[:, 1].copy(), starts.astype(np.intp)

    @cached_property
    def _jacobian_pattern(self) -> Pattern:
        return _pattern(self, tuple(range(self.unknowns)))

    @cached_property
    def _bends(self) -> _Curvature:
        """2 B restricted to the unknowns, with proportional columns stored once."""
        return _Curvature.of(self._pairs, len(self.rows))

    @cached_property
    def _pairs(self) -> dict[tuple[int, int], dict[int, float]]:
        """2 B restricted to the unknowns, by pair and row."""
        pairs: dict[tuple[int, int], dict[int, float]] = {}
        for index, row in enumerate(self.rows):
            for p in row:
                for i, left_sign in ((p.left[0], 1.0), (p.left[1], -1.0)):
                    for j, right_sign in ((p.right[0], 1.0), (p.right[1], -1.0)):
                        if i < self.unknowns and j < self.unknowns:
                            value = p.coefficient * left_sign * right_sign
                            for pair in ((i, j), (j, i)):
                                entries = pairs.setdefault(pair, {})
                                entries[index] = entries.get(index, 0.0) + value
        return pairs

    @cached_property
    def reads(self) -> tuple[frozenset[int], ...]:
        """The coordinates that each row reads; a product with a zero difference reads none."""
        return tuple(
            frozenset(
                i
                for p in row
                if p.left[0] != p.left[1] and p.right[0] != p.right[1]
                for i in (*p.left, *p.right)
            )
            for row in self.rows
        )

    @cached_property
    def block_order(self) -> BlockOrder:
        """The block order: which rows determine which unknowns."""
        return block_order_of(self.reads, self.unknowns)

    @property
    def terms(self) -> tuple[Array, Indices]:
        """Coefficients of all terms, and the index of each row's first term."""
        coefficients, *_, starts = self._terms
        return coefficients, starts

    @cached_property
    def differences(self) -> tuple[tuple[Indices, Indices], tuple[Indices, Indices]]:
        """Both ends of every distinct difference, and for each term the indices of its two factors."""
        coefficients, plus, minus, _ = self._terms
        ends, places = np.unique(np.stack([plus, minus]), axis=1, return_inverse=True)
        count = len(coefficients)
        return (ends[0], ends[1]), (places[:count], places[count:])

    def factors(self, y: Array) -> tuple[Array, Array]:
        """Both differences of every term, each of shape (..., terms)."""
        coefficients, plus, minus, _ = self._terms
        both, count = y.take(plus, axis=-1) - y.take(minus, axis=-1), len(coefficients)
        return both[..., :count], both[..., count:]

    def sizes_of_factors(self, data: Array) -> tuple[Array, Array]:
        """At most both differences of every term, of coordinates of some sizes, each (..., terms)."""
        coefficients, plus, minus, _ = self._terms
        both, count = data.take(plus, axis=-1) + data.take(minus, axis=-1), len(coefficients)
        return both[..., :count], both[..., count:]

    def gather(self, products: Array) -> Array:
        """Sum the products of factors, shape (..., terms), into rows, shape (..., rows)."""
        coefficients, *_, starts = self._terms
        return np.add.reduceat(products * coefficients, starts, axis=-1)

    def gather_sizes(self, products: Array) -> Array:
        """Sum the sizes of products of factors, shape (..., terms), into rows, shape (..., rows)."""
        coefficients, *_, starts = self._terms
        return np.add.reduceat(products * np.abs(coefficients), starts, axis=-1)

    def moving_products(self, moving: tuple[int, ...]) -> MovingProducts:
        """The products of two moving differences, where all unknowns and some known coordinates move.

        All coordinates that stand still are treated as one in differences, so many rows share a product.
        """
        return _moving_products(self, moving)

    def residual(self, y: Array) -> Array:
        """C(y) = B(y, y), shape (..., rows)."""
        left, right = self.factors(y)
        return self.gather(left * right)

    def polar(self, a: Array, b: Array) -> Array:
        """B(a, b), symmetric and bilinear, shape (..., rows); C'(y) h = 2 B(y, h)."""
        left_a, right_a = self.factors(a)
        left_b, right_b = self.factors(b)
        return self.gather(0.5 * (left_a * right_b + left_b * right_a))

    def jacobian(self, y: Array) -> Array:
        """C_u(y), the derivative by the unknowns, shape (..., rows, unknowns); linear in y."""
        return self._derivative(y, self._jacobian_pattern, self.unknowns)

    def derivative_by(self, y: Array, coordinates: tuple[int, ...]) -> Array:
        """The derivative of C by some coordinates, shape (..., rows, coordinates)."""
        return self._derivative(y, _pattern(self, coordinates), len(coordinates))

    def _derivative(self, y: Array, pattern: Pattern, columns: int) -> Array:
        plus, minus, coefficients, *_ = pattern
        parts = y.take(plus, axis=-1) - y.take(minus, axis=-1)
        parts *= coefficients
        return self._matrix(parts, pattern, columns)

    def _matrix(self, parts: Array, pattern: Pattern, columns: int) -> Array:
        """The matrix of the parts of its entries, shape (..., rows, columns)."""
        *_, first, flat = pattern
        matrix = np.zeros((*parts.shape[:-1], len(self.rows) * columns))
        if len(flat):
            matrix[..., flat] = np.add.reduceat(parts, first, axis=-1)
        return matrix.reshape(*parts.shape[:-1], len(self.rows), columns)

    def jacobian_uncertainty(self, data: Array) -> Array:
        """Bound of the change of C_u if each coordinate changes by `data`, shape (..., rows, unknowns)."""
        plus, minus, coefficients, *_ = self._jacobian_pattern
        parts = data.take(plus, axis=-1) + data.take(minus, axis=-1)
        parts *= np.abs(coefficients)
        return self._matrix(parts, self._jacobian_pattern, self.unknowns)

    def uncertainty(self, y: Array, data: Array) -> Array:
        r"""Bound of the error of the computed C(y), shape (..., rows).

        Each factor has the rounding of its difference and the `data` uncertainty of its two coordinates
        (shape (..., size)). The row adds the rounding of its products and of their sum, gamma = (terms + 2) u
        relative to the sum of magnitudes (Higham, Accuracy and Stability, ch. 3).
        """
        coefficients, plus, minus, _ = self._terms
        sizes, count = np.abs(y.take(plus, axis=-1) - y.take(minus, axis=-1)), len(coefficients)
        errors = UNIT_ROUNDOFF * sizes + data.take(plus, axis=-1) + data.take(minus, axis=-1)
        left, right = sizes[..., :count], sizes[..., count:]
        left_error, right_error = errors[..., :count], errors[..., count:]
        gamma = (max(len(row) for row in self.rows) + 2) * UNIT_ROUNDOFF
        spread = gamma * left * right + left * right_error + left_error * (right + right_error)
        return self.gather_sizes(spread)

    def lipschitz(self, preconditioner: Array, weights: Array | None = None) -> Array:
        r"""The Lipschitz constant of X C_u in a maximum norm, weighted or plain, shape (...,).

        With |u| = max_i |u_i| / g_i it is max_i (1 / g_i) sum_jk |sum_r X_ir 2 B_rjk| g_j g_k for a
        preconditioner X of shape (..., unknowns, rows) and weights g of shape (..., unknowns), which may have
        more leading dimensions than X. C_u is linear in y, so this one number holds everywhere.
        """
        if weights is None:
            return np.asarray(self._bends.bent(preconditioner, None).max(axis=-1))
        return np.asarray((self._bends.bent(preconditioner, weights) / weights).max(axis=-1))


@lru_cache(maxsize=256)
def _pattern(system: QuadraticMap, coordinates: tuple[int, ...]) -> Pattern:
    """The terms of a derivative: ends of a factor, signed coefficient, run starts, flat position.

    d/dy_a of c (y_a - y_b) R is c R, so an entry takes the other factor of its term.
    """
    column = {coordinate: place for place, coordinate in enumerate(coordinates)}
    entries: list[tuple[int, int, int, float]] = []
    for index, row in enumerate(system.rows):
        for product in row:
            for ends, other in ((product.left, product.right), (product.right, product.left)):
                for coordinate, sign in ((ends[0], 1.0), (ends[1], -1.0)):
                    if coordinate in column:
                        position = index * len(column) + column[coordinate]
                        entries.append((position, *other, sign * product.coefficient))
    entries.sort(key=lambda entry: entry[0])
    flat, plus, minus = (np.array([entry[i] for entry in entries], dtype=np.intp) for i in range(3))
    first = np.flatnonzero(np.diff(flat, prepend=-1)).astype(np.intp)
    return plus, minus, np.array([entry[3] for entry in entries]), first, flat[first]


@dataclass(frozen=True)
class MovingProducts:
    """Products of moving differences, each once; of unknowns, moving known coordinates, and a last 0.

    Attributes:
        ends: ends of the left differences of all products and then of the right ones; of one side only if
            both sides are equal in all products; (2, sides * count). The last product is 0.
        count: number of products.
        taken, coefficients: products that each row sums, (rows, largest number), padded with the last.
    """

    ends: Indices
    count: int
    taken: Indices
    coefficients: Array

    def factors(self, moving: Array) -> Array:
        """The differences in every product, from moving coordinates and a last 0, (..., sides * count)."""
        plus, minus = self.ends
        return np.asarray(moving.take(plus, axis=-1) - moving.take(minus, axis=-1))

    def factors_of_first(self, first: Array) -> Array:
        """The differences in every product if only the first coordinates are not 0."""
        moving = np.zeros((*first.shape[:-1], self.size))
        moving[..., : first.shape[-1]] = first
        return self.factors(moving)

    @cached_property
    def size(self) -> int:
        """Number of moving coordinates, with the last 0."""
        return int(self.ends.max()) + 1

    def gather(self, products: Array) -> Array:
        """Sum products, shape (..., count), into rows, shape (..., rows)."""
        return np.asarray(np.vecdot(products.take(self.taken, axis=-1), self.coefficients))

    @cached_property
    def rows_of_each(self) -> Array:
        """The rows that each product alone makes, (count, rows)."""
        return self.gather(np.eye(self.count))


@lru_cache(maxsize=256)
def _moving_products(system: QuadraticMap, moving: tuple[int, ...]) -> MovingProducts:
    place = {number: i for i, number in enumerate((*range(system.unknowns), *moving))}
    zero = len(place)
    numbers: dict[tuple[int, int, int, int], int] = {}
    sums: list[list[tuple[int, float]]] = [[] for _ in system.rows]
    for own, row in zip(sums, system.rows, strict=True):
        for p in row:
            coefficient, factors = p.coefficient, []
            for ends in (p.left, p.right):
                first, second = (place.get(end, zero) for end in ends)
                coefficient = coefficient if first <= second else -coefficient
                factors.append((min(first, second), max(first, second)))
            if all(first != second for first, second in factors):
                (a, b), (c, d) = sorted(factors)
                own.append((numbers.setdefault((a, b, c, d), len(numbers)), coefficient))
    places = np.array([*numbers, (zero,) * 4], dtype=np.intp).T
    sides = [places[:2]] if (places[:2] == places[2:]).all() else [places[:2], places[2:]]
    most = max(len(own) for own in sums)
    filled = [[*own, *[(len(numbers), 0.0)] * (most - len(own))] for own in sums]
    return MovingProducts(
        np.concatenate(sides, axis=1),
        len(numbers) + 1,
        np.array([[product for product, _ in own] for own in filled], dtype=np.intp),
        np.array([[coefficient for _, coefficient in own] for own in filled]),
    )


def quadratic_map(rows: Sequence[Row], unknowns: int, size: int) -> QuadraticMap:
    """Build a map and check that every row has a term and every coordinate exists.

    Raises:
        ValueError: a row is empty, a term names a coordinate outside 0 .. size - 1, or a coefficient is not
            a power of two.
    """
    for number, row in enumerate(rows):
        if not row:
            raise ValueError(f"row {number} has no terms")
        for product in row:
            if abs(frexp(product.coefficient)[0]) != 0.5:
                raise ValueError(f"row {number}: the coefficient of {product} is not a power of two")
            if not all(0 <= i < size for i in (*product.left, *product.right)):
                raise ValueError(f"row {number}: {product} names a coordinate outside 0..{size - 1}")
    return QuadraticMap(tuple(tuple(row) for row in rows), unknowns, size)
