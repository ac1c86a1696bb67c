r"""Power series of all coordinates in p parameters, from one factorisation.

The parameters are time (p = 1), the fraction of a straight path (p = 1), or up to three inputs. With
y(s) = sum_k y_k s^k in every coordinate, k a power of p parameters (see `multi_index`), C(y(s)) = B(y, y) = 0
gives for each k

    C_u u_k = -( C_w w_k + sum_{0 < i < k} B(y_i, y_{k-i}) ),

solved for all k of one total degree at once.

In time, k = 1 is the paper's velocity equation (19), and k = 2 half its acceleration equation (22). Only
products of two moving differences take part in the sum, and many rows share one (see
`QuadraticMap.moving_products`).
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Sequence
from itertools import pairwise
from math import prod

import numpy as np

from pointcoord.numerics.arrays import Array
from pointcoord.numerics.linear import Factors
from pointcoord.numerics.multi_index import Products, powers_counted, products
from pointcoord.numerics.quadratic import MovingProducts, QuadraticMap
from pointcoord.numerics.vectors import LAST, NEXT

Combine = Callable[[Array], Array]

# Pairs of coefficients multiplied at once: 7 MB for a map of a hundred terms.
PAIRS = 8192


def expand(
    system: QuadraticMap,
    factors: Factors,
    y: Array,
    known: Array,
    lacking: Array | None = None,
    inputs: int = 1,
) -> Array:
    """Series of all coordinates about assembled poses, or along which a pose's residual is reduced to zero.

    Args:
        factors: factorisation of C_u at y.
        y: coordinates, shape (..., size).
        known: series of the known coordinates, shape (..., powers, size - unknowns).
        lacking: C(y) where y is not assembled, shape (..., rows); then C(y(s)) = (1 - s) C(y), and p is 1.
        inputs: p, the number of parameters.
    Returns:
        Coefficients by power, shape (..., powers, size).
    """
    n = system.unknowns
    places = np.flatnonzero(known[..., 1:, :].reshape(-1, known.shape[-1]).any(axis=0))
    moving = np.empty((*y.shape[:-1], known.shape[-2], len(places)))
    moving[...] = known[..., places]
    found = expand_moving(system, factors, y, powers_first(moving), (places + n).tolist(), inputs, lacking)
    series = np.empty((*y.shape[:-1], known.shape[-2], y.shape[-1]))
    series[..., n:] = known
    powers_first(series)[..., :n] = found[..., :n]
    series[..., 0, :] = y
    return series


def expand_moving(
    system: QuadraticMap,
    factors: Factors,
    y: Array,
    known: Array,
    driven: Sequence[int],
    inputs: int,
    lacking: Array | None = None,
) -> Array:
    """Series of all unknowns and of the moving known coordinates, powers first, contiguous by power.

    Args:
        known: series of the known coordinates that move, shape (powers, ..., moving).
        driven: numbers of these coordinates.
        lacking: as in `expand`.
    Returns:
        Coefficients of the unknowns and then of these, shape (powers, ..., unknowns + moving).
    """
    n, every = system.unknowns, powers_counted(inputs, len(known))
    moving, edges = tuple(driven), every.edges
    terms = system.moving_products(moving)
    # Moving coordinates, and a last 0 for all that stand still; the constant term takes no part in products.
    own = np.zeros((every.count, *y.shape[:-1], n + len(moving) + 1))
    own[1:, ..., n:-1] = known[1:]
    # First the share of the known coordinates in each power; the sums of products follow degree by degree.
    by_known = factors.solve_many(powers_first(system.derivative_by(y, moving).swapaxes(-1, -2)))
    own[1:, ..., :n] = -_combined(own[1:, ..., n:-1], by_known)
    if lacking is not None:
        own[1, ..., :n] -= factors.solve(lacking)
    solved, advanced = _solved_sums(factors, terms)
    # The factors of each power at its exponents, without the sums still to come.
    table = np.zeros([*[every.order + 1] * inputs, *y.shape[:-1], terms.ends.shape[-1]])
    left, right = table[..., : terms.count], table[..., -terms.count :]
    table = table.reshape(-1, *table.shape[inputs:])
    table[every.places(1, every.count)] = terms.factors(own[1:])
    subscripts = f"{'abc'[:inputs]}...,{'abc'[:inputs]}...->..."
    sums = np.zeros((every.count - 1, *left.shape[inputs:]))
    for start, stop in pairwise(edges[2:]):
        each = sums[start - 1 : stop - 1]
        for place in range(start, stop):
            up, down = every.pairs[place]
            # A power still to come is multiplied by the 0 of the constant term.
            np.einsum(subscripts, left[up], right[down], out=each[place - start])
        table[every.places(start, stop)] -= advanced(each)
    own[1:, ..., :n] -= solved(sums)
    own[0, ..., :n] = y[..., :n]
    own[0, ..., n:-1] = known[0]
    return own[..., :-1]


def _solved_sums(factors: Factors, terms: MovingProducts) -> tuple[Combine, Combine]:
    """Functions from sums of products, (powers, ..., count), to the amounts to subtract.

    The amount for the unknowns, (powers, ..., n), is C_u^-1 times the rows that the sums make; the amount for
    the products' factors is its differences. Unless the matrix is large and sparse, each is one product with
    a matrix made beforehand.
    """
    if factors.sparse is not None:

        def substituted(sums: Array) -> Array:
            return factors.solve_many(terms.gather(sums))

        return substituted, lambda sums: terms.factors_of_first(substituted(sums))
    members = [1] * (factors.row_scale.ndim - 1)
    each = factors.solve_many(terms.rows_of_each.reshape(terms.count, *members, -1))
    factors_of_each = terms.factors_of_first(each)
    return lambda sums: _combined(sums, each), lambda sums: _combined(sums, factors_of_each)


def _combined(shares: Array, vectors: Array) -> Array:
    """Sums of vectors times shares, (powers, ..., n) from shapes (powers, ..., count) and (count, ..., n)."""
    return np.asarray(np.matmul(shares, vectors, axes=[(0, -1), (0, -1), (0, -1)]))


def powers_first(series: Array) -> Array:
    """A view of series, (..., powers, n), in the order (powers, ..., n)."""
    last = series.ndim - 1
    return series.transpose(last - 1, *range(last - 1), last)


def multiplied(left: Array, right: Array, pairs: Products) -> Array:
    """Coefficients of products of series.

    Args:
        left, right: factors, shape (powers, ..., terms).
    Returns:
        Shape (targets, ..., terms).
    """
    result = np.empty((len(pairs.targets), *left.shape[1:]), left.dtype)
    edges, block = pairs.edges, max(PAIRS // max(prod(left.shape[1:-1]), 1), 1)
    low = 0
    while low < len(pairs.targets):
        # As many targets as fill a block of pairs, and at least one.
        high = max(bisect_right(edges, edges[low] + block) - 1, low + 1)
        first, last = edges[low], edges[high]
        each = left[pairs.first[first:last]]
        each *= right[pairs.second[first:last]]
        np.add.reduceat(each, pairs.starts[low:high] - first, axis=0, out=result[low:high])
        low = high
    return result


def cross_series(a: Array, b: Array, inputs: int = 1, doubled: bool = False) -> Array:
    """Series of a x b from the series of two vectors, shapes (..., powers, 3).

    Args:
        doubled: whether to continue to twice the order, where the product ends.
    """
    order = powers_counted(inputs, a.shape[-2]).order
    pairs = products(inputs, order, (0, 2 * order if doubled else order), 0)
    left = np.concatenate([a[..., NEXT], a[..., LAST]], axis=-1)
    right = np.concatenate([b[..., LAST], b[..., NEXT]], axis=-1)
    found = multiplied(powers_first(left), powers_first(right), pairs)
    result = np.empty((*found.shape[:-1], 3), found.dtype)
    result[pairs.targets] = found[..., :3] - found[..., 3:]
    return result.transpose(*range(1, result.ndim - 1), 0, result.ndim - 1)
