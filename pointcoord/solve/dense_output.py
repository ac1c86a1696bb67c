"""A chain of series and its derivatives summed at any instants, by matrix products.

Each number has one row of sums, in which the instants are contiguous in memory. So a matrix product writes
directly into its row, and later operations run along the rows.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pointcoord.numerics.arrays import Array
from pointcoord.solve.taylor import Chain

# Instants per matrix product: the powers and the results of a block stay in a second-level cache.
BLOCK = 1024
# Most multiplications of one part of a product, and fewest columns. OpenBLAS distributes products of 2^20
# multiplications over threads, which mostly wait for each other, but none of 2^19: one thread with parts is
# as fast to within a tenth.
MOST, FEWEST = 2**19, 64


@dataclass(frozen=True)
class SeriesRows:
    """Coefficients of a chain's series and of their derivatives, ready to be summed: one row for each series.

    Attributes:
        starts, scales: first instant and unit of time of each segment, s.
        tables: coefficients of each segment, shape (..., rows, order + 1), per s**derivative.
    """

    starts: tuple[float, ...]
    scales: tuple[float, ...]
    tables: tuple[Array, ...]

    @classmethod
    def of(cls, chain: Chain, columns: Sequence[Array], wanted: Sequence[Sequence[int]]) -> SeriesRows:
        """The rows of some derivatives of some coordinates.

        Args:
            columns: coefficients of the m coordinates, for each segment, shape (..., order + 1, m).
            wanted: numbers of the wanted coordinates for each time derivative. The rows are in this order.
        """
        tables = []
        for segment, piece in zip(chain.segments, columns, strict=True):
            each = derivative_tables(piece, segment.scale, len(wanted) - 1)
            rows = [table[..., list(places)] for table, places in zip(each, wanted, strict=True)]
            tables.append(np.ascontiguousarray(np.concatenate(rows, axis=-1).swapaxes(-1, -2)))
        starts, scales = zip(*((segment.start, segment.scale) for segment in chain.segments), strict=True)
        return cls(starts, scales, tuple(tables))

    @property
    def shape(self) -> tuple[int, ...]:
        """Leading dimensions and rows of the sums."""
        return self.tables[0].shape[:-1]

    def edges(self, instants: Array) -> list[int]:
        """Index of the first instant of each segment, and the number of instants, which must not decrease."""
        return [0, *np.searchsorted(instants, self.starts[1:], side="left").tolist(), len(instants)]

    def sum(self, instants: Array, out: Array) -> None:
        """Sum the rows at instants that do not decrease, shape (N,), into an array of shape (..., rows, N).

        Each sum is sum_k table_k s^k with s = (t - start) / scale of the segment that contains t.
        """
        edges = self.edges(instants)
        powers = np.empty((max(table.shape[-1] for table in self.tables), min(BLOCK, len(instants))))
        for i, table in enumerate(self.tables):
            for low in range(edges[i], edges[i + 1], BLOCK):
                high = min(low + BLOCK, edges[i + 1])
                block = powers[: table.shape[-1], : high - low]
                block[0] = 1.0
                if len(block) > 1:
                    np.subtract(instants[low:high], self.starts[i], out=block[1])
                    block[1] /= self.scales[i]
                for k in range(2, len(block)):
                    np.multiply(block[k - 1], block[1], out=block[k])
                narrow_product(table, block, out[..., low:high])


def evaluate(chain: Chain, columns: Sequence[Array], instants: Array, derivatives: int) -> Array:
    """Sum series at instants.

    Args:
        columns: coefficients of the m wanted coordinates, for each segment, shape (..., order + 1, m).
        instants: in any order, inside the chain, shape (N,), s.
        derivatives: highest time derivative wanted.
    Returns:
        Shape (derivatives + 1, ..., N, m), per s**derivative.
    """
    count = columns[0].shape[-1]
    rows = SeriesRows.of(chain, columns, [range(count)] * (derivatives + 1))
    sums = np.empty((*rows.shape, len(instants)))
    if (instants[1:] >= instants[:-1]).all():
        rows.sum(instants, sums)
    else:
        order = np.argsort(instants, kind="stable")
        ordered = np.empty_like(sums)
        rows.sum(instants[order], ordered)
        sums[..., order] = ordered
    split = sums.reshape(*rows.shape[:-1], derivatives + 1, count, len(instants))
    return np.moveaxis(split, -3, 0).swapaxes(-1, -2)


def derivative_tables(coefficients: Array, scale: float, derivatives: int) -> list[Array]:
    """Coefficients of a series and of its time derivatives, each of shape (..., order + 1, m)."""
    tables = [coefficients]
    powers = np.arange(coefficients.shape[-2], dtype=float)[:, None]
    for _ in range(derivatives):
        lower = np.zeros_like(coefficients)
        lower[..., :-1, :] = (tables[-1] * powers)[..., 1:, :] / scale
        tables.append(lower)
    return tables


def narrow_product(matrix: Array, columns: Array, out: Array) -> None:
    """Write a product, shapes (..., m, k), (k, N), into an array, (..., m, N), in parts of some columns."""
    step = max(MOST // max(matrix.shape[-2] * matrix.shape[-1], 1), FEWEST)
    for low in range(0, columns.shape[-1], step):
        here = slice(low, low + step)
        np.matmul(matrix, columns[:, here], out=out[..., here])
