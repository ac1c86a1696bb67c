r"""Power series of the motion, from one factorisation.

With y(t0 + s T) = sum_k y_k s^k in every coordinate, C(y(t)) = B(y, y) = 0 reads at order k

    C_u u_k = -( C_w w_k + sum_{0<i<k} B(y_i, y_{k-i}) ),     k = 1, 2, 3, ...

k = 1 is the paper's velocity equation (19), k = 2 half its acceleration equation (22).
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.linear import Factors
from pointcoord.numerics.quadratic import QuadraticMap

Array = NDArray[np.float64]


def expand(
    system: QuadraticMap, factors: Factors, y: Array, known: Array, begun: Array | None = None
) -> Array:
    """Series of all coordinates about an assembled pose.

    Args:
        factors: factorisation of C_u at y.
        y: assembled coordinates, shape (..., size).
        known: series of the known coordinates, shape (..., order + 1, size - unknowns), in the
            mechanism's units per power of the time unit.
        begun: the first orders, if they are at hand, shape (..., orders, size).
    Returns:
        Coefficients, shape (..., order + 1, size).
    """
    dense = system.dense if y.ndim == 1 and known.ndim == 2 else None
    if dense is not None:
        return _expand_one(dense, factors, y, known, begun)
    return expand_plainly(system, factors, y, known, begun)


def expand_plainly(
    system: QuadraticMap, factors: Factors, y: Array, known: Array, begun: Array | None = None
) -> Array:
    """The same for any batch and for maps of any size, term by term."""
    n, orders = system.unknowns, known.shape[-2]
    series = np.zeros((*y.shape[:-1], orders, y.shape[-1]))
    series[..., 1:, n:] = known[..., 1:, :]
    series[..., 0, :] = y
    first = 1 if begun is None else begun.shape[-2]
    if begun is not None:
        series[..., :first, :] = begun
    left, right = system.factors(series)
    driven = np.any(known[..., 1:, :].reshape(-1, orders - 1, known.shape[-1]) != 0.0, axis=(0, 2))
    for k in range(first, orders):
        products = np.zeros_like(left[..., 0, :])
        if driven[k - 1]:
            products += left[..., 0, :] * right[..., k, :] + left[..., k, :] * right[..., 0, :]
        if k > 1:
            products += np.sum(left[..., 1:k, :] * right[..., k - 1 : 0 : -1, :], axis=-2)
        series[..., k, :n] = -factors.solve(system.gather(products))
        left[..., k, :], right[..., k, :] = system.factors(series[..., k, :])
    return series


def _expand_one(
    dense: tuple[Array, Array], factors: Factors, y: Array, known: Array, begun: Array | None
) -> Array:
    """The series of one pose on a small map: a handful of products of vectors an order.

    The factors of all terms lie in two tables (terms, order + 1). Before order k is solved they hold what the
    known coordinates give to it, so that one product of rows takes C_w w_k and the sum together.
    """
    differences, sums = dense
    (orders, given), size, terms = known.shape, y.shape[0], sums.shape[1]
    n = size - given
    series = np.zeros((orders, size))
    series[1:, n:] = known[1:]
    series[0] = y
    first = 1 if begun is None else begun.shape[0]
    if begun is not None:
        series[:first] = begun
    both = differences @ series.T
    left, right = both[:terms], both[terms:]
    backwards = right[:, ::-1]
    by_unknowns = np.ascontiguousarray(differences[:, :n])
    minus_rows = -sums * factors.row_scale[:, None]
    matrix, inverse = factors.matrix, factors.inverse
    # Of vectors, `dot` takes half the time that the operator @ does.
    for k in range(first, orders):
        rows = minus_rows.dot(np.vecdot(left[:, : k + 1], backwards[:, orders - 1 - k :]))
        x = inverse.dot(rows)
        x += inverse.dot(rows - matrix.dot(x))
        series[k, :n] = x
        both[:, k] += by_unknowns.dot(x)
    return series


def cross_series(a: Array, b: Array) -> Array:
    """Series of a x b from the series of two vectors, shapes (..., order + 1, 3)."""
    orders = a.shape[-2]
    # Row k of a table holds b_k, b_(k-1), ..., b_0 and zeros: its product with a sums a_i b_(k-i).
    padded = np.zeros((*b.shape[:-2], 3, orders + 1))
    padded[..., 1:] = b.swapaxes(-1, -2)
    products = padded[..., _backwards(orders)] @ a[..., None, :, :]
    cross = np.empty((*products.shape[:-3], orders, 3))
    for i, (j, k) in enumerate(((1, 2), (2, 0), (0, 1))):
        np.subtract(products[..., k, :, j], products[..., j, :, k], out=cross[..., i])
    return cross


@cache
def _backwards(orders: int) -> NDArray[np.intp]:
    """Places 1 + k - i, and 0 where i > k, (orders, orders)."""
    number = np.arange(orders)
    return np.asarray(np.maximum(1 + number[:, None] - number, 0), dtype=np.intp)
