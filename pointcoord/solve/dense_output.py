"""A chain of series and its derivatives summed at any instants, by matrix products."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pointcoord.solve.taylor import Chain

Array = NDArray[np.float64]

# Instants per matrix product: the powers and the results of a block stay in a second-level cache.
BLOCK = 1024


def evaluate(chain: Chain, columns: list[Array], instants: Array, derivatives: int) -> Array:
    """Sum series at instants by matrix products.

    Args:
        columns: for each segment its coefficients of the wanted coordinates, shape (..., order + 1, m).
        instants: in any order, inside the chain, shape (N,), s.
        derivatives: highest time derivative wanted.
    Returns:
        Shape (derivatives + 1, ..., N, m), per s**derivative.
    """
    order = np.argsort(instants, kind="stable")
    ordered = instants[order]
    result = np.empty((derivatives + 1, *columns[0].shape[:-2], len(instants), columns[0].shape[-1]))
    starts = [segment.start for segment in chain.segments]
    edges = [0, *np.searchsorted(ordered, starts[1:], side="left").tolist(), len(instants)]
    for segment, piece, first, last in zip(chain.segments, columns, edges[:-1], edges[1:], strict=True):
        tables = derivative_tables(piece, segment.scale, derivatives) if first < last else []
        for low in range(first, last, BLOCK):
            high = min(low + BLOCK, last)
            s = (ordered[low:high] - segment.start) / segment.scale
            powers = np.vander(s, piece.shape[-2], increasing=True)
            for values, table in zip(result, tables, strict=True):
                np.matmul(powers, table, out=values[..., low:high, :])
    if (order[1:] > order[:-1]).all():
        return result
    back = np.empty_like(order)
    back[order] = np.arange(len(order))
    return result[..., back, :]


def derivative_tables(coefficients: Array, scale: float, derivatives: int) -> list[Array]:
    """Coefficients of a series and of its time derivatives, each of shape (..., order + 1, m)."""
    tables = [coefficients]
    powers = np.arange(coefficients.shape[-2], dtype=float)[:, None]
    for _ in range(derivatives):
        lower = np.zeros_like(coefficients)
        lower[..., :-1, :] = (tables[-1] * powers)[..., 1:, :] / scale
        tables.append(lower)
    return tables
