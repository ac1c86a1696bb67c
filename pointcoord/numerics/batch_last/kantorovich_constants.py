r"""The constants of Newton and Kantorovich's theorem for many members, a member a column.

With X = C_u^-1 at a place and weights g, in the norm max_i |u_i| / g_i:

    omega = max_i (1 / g_i) sum_r |X_ir| sum_jk |2 B_rjk| g_j g_k  >=  Lipschitz(X C_u),
    z     = max_i (1 / g_i) sum_j |(X C_u(T))_ij| g_j             =  |X C_u(T)|.

`quadratic.lipschitz` takes the sum over r inside the magnitude, which may be less and never more: with this omega
whatever is proven holds all the same, and it costs a tenth.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.batch_last.column_map import ColumnMap
from pointcoord.numerics.batch_last.elimination import Elimination

Array = NDArray[np.float64]
Indices = NDArray[np.intp]


@dataclass(frozen=True)
class Constants:
    """How the constants are summed; make it with `constants_of`.

    Attributes:
        pairs: j, k of each pair of unknowns in the curvature of a row.
        turning: |2 B_rjk|, shape (rows, pairs).
        rows, unknowns: of each entry of X. sums: 1 where an entry is of an unknown, (unknowns, entries).
        factors: entries of X and of C_u(T) in each product of a sum, sorted by how often their sum has had one.
        layers: how many sums have a first product, a second, and so on.
        columns, by_row: of each sum X C_u(T)_ij its j, and 1 where it is of row i, (unknowns, sums).
    """

    pairs: tuple[Indices, Indices]
    turning: Array
    rows: Indices
    sums: Array
    factors: tuple[Indices, Indices]
    layers: tuple[int, ...]
    columns: Indices
    by_row: Array

    def lipschitz(self, inverse: Array, weights: Array | None = None) -> Array:
        """Omega, shape (members,).

        Args:
            inverse: magnitudes of the entries of X, shape (entries, members).
            weights: g, shape (unknowns, members); 1 unless given.
        """
        if weights is None:
            return np.asarray((self.sums @ (inverse * self._plain_turning[:, None])).max(axis=0))
        first, second = self.pairs
        turning = self.turning @ (weights.take(first, axis=0) * weights.take(second, axis=0))
        return np.asarray(((self.sums @ (inverse * turning.take(self.rows, axis=0))) / weights).max(axis=0))

    @property
    def _plain_turning(self) -> Array:
        return np.asarray(self.turning.sum(axis=-1)[self.rows])

    def turns(self, inverse: Array, along: Array) -> Array:
        """Magnitudes of the entries of X C_u(T), shape (sums, members).

        Args:
            inverse: entries of X. along: entries of C_u(T), shape (entries, members).
        """
        one, other = self.factors
        products = inverse.take(one, axis=0)
        products *= along.take(other, axis=0)
        total, first = products[: self.layers[0]], self.layers[0]
        for count in self.layers[1:]:
            total[:count] += products[first : first + count]
            first += count
        return np.abs(total, out=total)

    def turning_norm(self, turns: Array, weights: Array | None = None) -> Array:
        """z, shape (members,)."""
        if weights is None:
            return np.asarray((self.by_row @ turns).max(axis=0))
        return np.asarray(
            ((self.by_row @ (turns * weights.take(self.columns, axis=0))) / weights).max(axis=0)
        )


def constants_of(columns: ColumnMap, plan: Elimination) -> Constants:
    """How the constants are summed for matrices of a pattern."""
    table, first, second = columns.system._curvature
    entries = plan.inverse_program.entries
    n = columns.unknowns
    unordered: dict[tuple[int, int], int] = {}
    turning = np.zeros((len(table), len(first)))
    for column, (j, k) in enumerate(zip(first.tolist(), second.tolist(), strict=True)):
        turning[:, unordered.setdefault((min(j, k), max(j, k)), len(unordered))] += np.abs(table[:, column])
    pairs = np.array(list(unordered), dtype=np.intp).reshape(-1, 2)
    sums = np.zeros((n, len(entries)))
    sums[[i for i, _ in entries], np.arange(len(entries))] = 1.0
    in_row: dict[int, list[tuple[int, int]]] = {}
    for place, (row, column) in enumerate(plan.entries):
        in_row.setdefault(row, []).append((place, column))
    found: dict[tuple[int, int], list[tuple[int, int]]] = {}
    for number, (i, row) in enumerate(entries):
        for place, column in in_row.get(row, ()):
            found.setdefault((i, column), []).append((number, place))
    by_length = sorted(found.items(), key=lambda each: -len(each[1]))
    longest = max(len(products) for products in found.values())
    layers = [[products[place] for _, products in by_length if len(products) > place] for place in range(longest)]
    flat = np.array([product for layer in layers for product in layer], dtype=np.intp)
    by_row = np.zeros((n, len(by_length)))
    by_row[[target[0] for target, _ in by_length], np.arange(len(by_length))] = 1.0
    return Constants(
        (pairs[:, 0].copy(), pairs[:, 1].copy()),
        np.ascontiguousarray(turning[:, : len(unordered)]),
        np.array([row for _, row in entries], dtype=np.intp),
        sums,
        (flat[:, 0].copy(), flat[:, 1].copy()),
        tuple(len(layer) for layer in layers),
        np.array([target[1] for target, _ in by_length], dtype=np.intp),
        by_row,
    )
