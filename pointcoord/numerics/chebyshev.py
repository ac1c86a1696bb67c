r"""A function on [-1, 1] as a polynomial of low degree through its values at the Chebyshev points.

With x_j = -cos(pi j / n) and T_k Chebyshev's polynomials, the polynomial through the n + 1 values f_j is

    sum_k a_k T_k,      a_k = (2 / n) sum''_j f_j T_k(x_j),  a_0 and a_n halved,

where '' halves the first and the last term. An error of the values is amplified by at most some 2.3 for n = 8
(the Lebesgue constant). The polynomial differs from the function by at most twice the sum of the magnitudes
of the function's coefficients of T_k, k > n (Trefethen, Approximation Theory and Approximation Practice,
theorems 4.2, 15.1).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from pointcoord.numerics.arrays import Array


@dataclass(frozen=True)
class Interpolation:
    """Matrices for a degree n.

    Attributes:
        points: x_j, ascending, shape (n + 1,).
        coefficients: from f_j to a_k, (n + 1, n + 1).
        powers: from a_k to the coefficients of x^m, [k, m].
        slopes: from f_j to the polynomial's derivative at the points, (n + 1, n + 1).
    """

    points: Array
    coefficients: Array
    powers: Array
    slopes: Array

    def chebyshev(self, values: Array, moved: Array) -> Array:
        """a_k from values near the points, both shape (..., n + 1).

        Only differences of the values are transformed, so that their common part is not rounded.

        Args:
            moved: distance of each value's place from its point, below 2^-24 of the interval; corrected to
                first order, which leaves an error of the distance squared.
        """
        middle = values[..., len(self.points) // 2, None]
        spread = values - middle
        spread = spread - moved * (spread @ self.slopes.T)
        found: Array = spread @ self.coefficients.T
        found[..., :1] += middle
        return found


@lru_cache(maxsize=8)
def interpolation(degree: int) -> Interpolation:
    """The matrices of an even degree, at least 2."""
    series, orders = np.polynomial.chebyshev, np.arange(degree + 1)
    angles = np.pi * orders[::-1] / degree
    points = np.cos(angles)
    points[degree // 2] = 0.0
    halved = np.where(orders % degree == 0, 0.5, 1.0)
    coefficients = halved[:, None] * np.cos(np.outer(orders, angles)) * (halved * 2.0 / degree)
    powers = np.zeros((degree + 1, degree + 1))
    for k in orders:
        powers[k, : k + 1] = series.cheb2poly(np.eye(degree + 1)[k])
    slopes: Array = series.chebvander(points, degree - 1) @ np.asarray(series.chebder(coefficients), float)
    return Interpolation(points, coefficients, powers, slopes)
