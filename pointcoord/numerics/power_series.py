r"""Power series of all coordinates in p parameters, from one factorisation.

The parameters are time (p = 1), the share of a straight path (p = 1), or up to three inputs. With
y(s) = sum_k y_k s^k in every coordinate, k a power of p parameters (see `multi_index`), C(y(s)) = B(y, y) = 0
reads at each k

    C_u u_k = -( C_w w_k + sum_{0 < i < k} B(y_i, y_{k-i}) ),

all k of one total degree at once. In time k = 1 is the paper's velocity equation (19), k = 2 half its
acceleration equation (22). Only products of two differences that both move take part in the sum, and many
rows share one (see `QuadraticMap.moving_products`).
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.linear import Factors
from pointcoord.numerics.multi_index import Products, pairs_at, powers_counted, products
from pointcoord.numerics.quadratic import QuadraticMap

Array = NDArray[np.float64]

# Products of pairs of coefficients at once: 7 MB for a map of a hundred terms.
PAIRS = 8192
CYCLE, BACK = np.array([1, 2, 0]), np.array([2, 0, 1])


def expand(
    system: QuadraticMap,
    factors: Factors,
    y: Array,
    known: Array,
    begun: Array | None = None,
    inputs: int = 1,
) -> Array:
    """Series of all coordinates about assembled poses.

    Args:
        factors: factorisation of C_u at y.
        y: assembled coordinates, shape (..., size).
        known: series of the known coordinates, shape (..., powers, size - unknowns).
        begun: the first powers, of whole degrees, if they are at hand, shape (..., some powers, size).
        inputs: p, how many parameters.
    Returns:
        Coefficients by power, shape (..., powers, size).
    """
    n = system.unknowns
    places = np.flatnonzero(known[..., 1:, :].reshape(-1, known.shape[-1]).any(axis=0))
    first = None if begun is None else begun[..., :n]
    series = np.empty((*y.shape[:-1], known.shape[-2], y.shape[-1]))
    series[..., n:] = known
    moving = (places + n).tolist()
    series[..., :n] = expand_unknowns(system, factors, y, known[..., places], moving, first, inputs)
    series[..., 0, :] = y
    return series


def expand_unknowns(
    system: QuadraticMap,
    factors: Factors,
    y: Array,
    known: Array,
    driven: Sequence[int],
    begun: Array | None = None,
    inputs: int = 1,
) -> Array:
    """Series of the unknown coordinates, where only some of the known ones move.

    Args:
        known: series of those that move, shape (..., powers, moving).
        driven: which coordinates these are.
        begun: the first powers of the unknown ones, shape (..., some powers, unknowns).
    Returns:
        Coefficients by power, shape (..., powers, unknowns); powers come first in memory.
    """
    n, count = system.unknowns, known.shape[-2]
    every, moving = powers_counted(inputs, count), tuple(driven)
    terms, edges = system.moving_products(moving), every.edges
    # What moves, and a last 0 for all that stands still; the constant term takes no part in a product.
    own = np.zeros((count, *y.shape[:-1], n + len(moving) + 1))
    series, first = np.moveaxis(own, 0, -2), 1
    series[..., 1:, n:-1] = known[..., 1:, :]
    if begun is not None:
        series[..., 1 : begun.shape[-2], :n] = begun[..., 1:, :]
        first = edges.index(begun.shape[-2])
    by_known = np.swapaxes(system.derivative_by(y, moving), -1, -2)
    rows = np.moveaxis(series[..., n:-1] @ -by_known, -2, 0)
    # A table of each factor by exponents, 0 where a power is still to come.
    sides = [slice(low, low + terms.count) for low in range(0, terms.ends.shape[-1], terms.count)]
    grid = [every.order + 1] * inputs
    tables = [np.zeros((*grid, *y.shape[:-1], terms.count)) for _ in sides]
    flat = [table.reshape(*grid, -1) for table in tables]

    def put(low: int, high: int) -> None:
        for k, both in zip(every.tuples[low:high], terms.factors(own[low:high]), strict=True):
            for table, side in zip(tables, sides, strict=True):
                table[k] = both[..., side]

    put(1, edges[first])
    for low, high in pairwise(edges[first:]):
        wanted = rows[low:high]
        if low > inputs:
            sums = np.empty((high - low, *tables[0].shape[inputs:]))
            for k, out in zip(every.tuples[low:high], sums.reshape(high - low, -1), strict=True):
                _sum_at(k, flat, out)
            wanted = wanted - terms.gather(sums)
        own[low:high, ..., :n] = factors.solve_many(wanted)
        if high < count:
            put(low, high)
    own[0, ..., :n] = y[..., :n]
    return series[..., :n]


def _sum_at(k: tuple[int, ...], tables: Sequence[Array], out: Array) -> None:
    """Sum the products of i in the first table and k - i in the last one over all i, (numbers,)."""
    left, right = tables[0], tables[-1]
    pairs = pairs_at(k, left is right)
    (first, last, subscripts), *others = pairs.rectangles
    np.einsum(subscripts, left[first], right[last], out=out)
    for first, last, subscripts in others:
        out += np.einsum(subscripts, left[first], right[last])
    if left is right:
        out *= 2.0
    if pairs.middle is not None:
        out += left[pairs.middle] ** 2


def multiplied(left: Array, right: Array, pairs: Products) -> Array:
    """Coefficients of products of series.

    Args:
        left, right: factors, shape (powers, ..., terms).
    Returns:
        Shape (targets, ..., terms).
    """
    result = np.empty((len(pairs.targets), *left.shape[1:]))
    edges = [*pairs.starts.tolist(), len(pairs.first)]
    block = max(PAIRS // max(int(np.prod(left.shape[1:-1])), 1), 1)
    low = 0
    while low < len(pairs.targets):
        # As many targets as make a block of pairs, one at least.
        high = max(int(np.searchsorted(edges, edges[low] + block, side="right")) - 1, low + 1)
        first, last = edges[low], edges[high]
        each = left[pairs.first[first:last]]
        each *= right[pairs.second[first:last]]
        np.add.reduceat(each, pairs.starts[low:high] - first, axis=0, out=result[low:high])
        low = high
    return result


def cross_series(a: Array, b: Array, inputs: int = 1, doubled: bool = False) -> Array:
    """Series of a x b from the series of two vectors, shapes (..., powers, 3).

    Args:
        doubled: whether to go on to twice the order, where the product ends.
    """
    order = powers_counted(inputs, a.shape[-2]).order
    pairs = products(inputs, order, (0, 2 * order if doubled else order), 0)
    left = np.concatenate([a[..., CYCLE], a[..., BACK]], axis=-1)
    right = np.concatenate([b[..., BACK], b[..., CYCLE]], axis=-1)
    found = multiplied(np.moveaxis(left, -2, 0), np.moveaxis(right, -2, 0), pairs)
    result = np.empty((*found.shape[:-1], 3))
    result[pairs.targets] = found[..., :3] - found[..., 3:]
    return np.moveaxis(result, 0, -2)
