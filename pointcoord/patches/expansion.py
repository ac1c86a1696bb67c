r"""Power series of all coordinates in several inputs at once, from one factorisation.

With y(s) = sum_k y_k s^k, s the inputs from the centre of a patch in parts of its half widths, and k a
multi-index, C(y(s)) = B(y, y) = 0 reads at each k

    C_u u_k = -( C_w w_k + sum_{0 < i < k} B(y_i, y_{k-i}) ),

the recursion of a series in time (see `numerics.power_series`) with all k of one total degree at once.
Sizes of patches by the terms that they leave out: Jorba and Zou, A software package for the numerical
integration of ODEs by means of high-order Taylor methods, Experimental Mathematics 14 (2005).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.linear import Factors
from pointcoord.numerics.quadratic import QuadraticMap
from pointcoord.patches.multi_index import Products, powers, products

Array = NDArray[np.float64]

# Products of pairs of coefficients at once: 7 MB for a map of a hundred terms.
PAIRS = 8192


def expand_in_inputs(
    system: QuadraticMap, factors: Factors, y: Array, known: Array, inputs: int, order: int
) -> Array:
    """Series of all coordinates about assembled poses.

    Args:
        factors: of C_u at y.
        y: assembled coordinates, shape (P, size).
        known: series of the known coordinates, shape (P, powers, size - unknowns).
        order: the highest total degree.
    Returns:
        Coefficients by power (see `multi_index`), shape (P, powers, size).
    """
    n, every = system.unknowns, powers(inputs, order)
    series = np.zeros((len(y), every.count, system.size))
    series[:, 1:, n:] = known[:, 1:]
    series[:, 0] = y
    left, right = system.factors(series)
    inverse, matrix = (np.swapaxes(part, -1, -2) for part in (factors.inverse, factors.matrix))
    for degree in range(1, order + 1):
        here = slice(every.first_of(degree), every.first_of(degree + 1))
        value = left[:, :1] * right[:, here] + left[:, here] * right[:, :1]
        if degree > 1:
            value += multiplied(left, right, products(inputs, order, (degree, degree), 1))
        rest = -system.gather(value) * factors.row_scale[:, None]
        found = rest @ inverse
        found += (rest - found @ matrix) @ inverse
        series[:, here, :n] = found
        left[:, here], right[:, here] = system.factors(series[:, here])
    return series


def multiplied(left: Array, right: Array, pairs: Products) -> Array:
    """Coefficients of products of series.

    Args:
        left, right: factors, shape (P, powers, terms).
    Returns:
        Shape (P, targets, terms).
    """
    result = np.empty((left.shape[0], len(pairs.targets), left.shape[-1]))
    edges = [*pairs.starts.tolist(), len(pairs.first)]
    block = max(PAIRS // max(len(left), 1), 1)
    low = 0
    while low < len(pairs.targets):
        # As many targets as make a block of pairs, one at least.
        high = max(int(np.searchsorted(edges, edges[low] + block, side="right")) - 1, low + 1)
        first, last = edges[low], edges[high]
        each = left.take(pairs.first[first:last], axis=1)
        each *= right.take(pairs.second[first:last], axis=1)
        np.add.reduceat(each, pairs.starts[low:high] - first, axis=1, out=result[:, low:high])
        low = high
    return result
