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
from math import comb

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.linear import Factors
from pointcoord.numerics.multi_index import Products, powers, products
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
    driven: Sequence[int] | None = None,
) -> Array:
    """Series of all coordinates about assembled poses.

    Args:
        factors: factorisation of C_u at y.
        y: assembled coordinates, shape (..., size).
        known: series of the known coordinates, shape (..., powers, size - unknowns).
        begun: the first powers, of whole degrees, if they are at hand, shape (..., some powers, size).
        inputs: p, how many parameters.
        driven: the coordinates that `known` is of, if only of some of the known ones; the others stand still.
    Returns:
        Coefficients by power, shape (..., powers, size).
    """
    n, count = system.unknowns, known.shape[-2]
    order = next(degree for degree in range(count) if comb(degree + inputs, inputs) == count)
    every = powers(inputs, order)
    if driven is None:
        places = np.flatnonzero(known[..., 1:, :].reshape(-1, known.shape[-1]).any(axis=0))
        known, driven = known[..., places], (places + n).tolist()
    moving = tuple(driven)
    terms = system.moving_products(moving)
    # What moves, and a last 0 for all that stands still. Powers come first: a degree is one piece of memory.
    own = np.zeros((count, *y.shape[:-1], n + len(moving) + 1))
    known = np.broadcast_to(known, (*y.shape[:-1], *known.shape[-2:]))
    own[1:, ..., n:-1] = np.moveaxis(known[..., 1:, :], -2, 0)
    first = 1
    if begun is not None:
        own[: begun.shape[-2], ..., :-1] = np.moveaxis(begun[..., [*range(n), *moving]], -2, 0)
        first = next(d for d in range(order + 2) if every.first_of(d) == begun.shape[-2])
    by_known, rows = system.derivative_by(y, moving), np.zeros((count, *y.shape[:-1], n))
    for i in range(len(moving)):
        rows -= own[..., n + i, None] * by_known[..., i]
    left, right = terms.factors(own)
    for degree in range(first, order + 1):
        here = slice(every.first_of(degree), every.first_of(degree + 1))
        wanted = rows[here]
        if degree > 1:
            wanted -= terms.gather(_of_degree(left, right, inputs, order, degree))
        own[here, ..., :n] = factors.solve_many(wanted)
        left[here], right[here] = terms.factors(own[here])
    series = np.zeros((count, *y.shape))
    series[..., :n] = own[..., :n]
    series[..., moving] = own[..., n:-1]
    series[0] = y
    return np.moveaxis(series, 0, -2)


def _of_degree(left: Array, right: Array, inputs: int, order: int, degree: int) -> Array:
    """The sums over 0 < i < k of all k of a degree, shape (powers of the degree, ..., products)."""
    if inputs > 1:
        pairs = products(inputs, order, (degree, degree), 1, right is left)
        found = multiplied(left, right, pairs)
        if right is left:
            same = np.flatnonzero(pairs.first == pairs.second)
            found *= 2.0
            found[np.searchsorted(pairs.starts, same, side="right") - 1] -= left[pairs.first[same]] ** 2
        return found
    if right is not left:
        backwards = right[degree - 1 : 0 : -1]
        return np.asarray(np.einsum("i...t,i...t->...t", left[1:degree], backwards)[None])
    # Of squares the second half of the products is the first half again.
    middle = (degree + 1) // 2
    found = np.einsum("i...t,i...t->...t", left[1:middle], left[degree - 1 : degree - middle : -1])
    found *= 2.0
    if degree % 2 == 0:
        found += left[middle] ** 2
    return np.asarray(found[None])


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
    count = a.shape[-2]
    order = next(degree for degree in range(count) if comb(degree + inputs, inputs) == count)
    pairs = products(inputs, order, (0, 2 * order if doubled else order), 0)
    left = np.concatenate([a[..., CYCLE], a[..., BACK]], axis=-1)
    right = np.concatenate([b[..., BACK], b[..., CYCLE]], axis=-1)
    found = multiplied(np.moveaxis(left, -2, 0), np.moveaxis(right, -2, 0), pairs)
    result = np.empty((*found.shape[:-1], 3))
    result[pairs.targets] = found[..., :3] - found[..., 3:]
    return np.moveaxis(result, 0, -2)
