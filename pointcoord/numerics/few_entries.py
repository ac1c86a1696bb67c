"""Large matrices of few entries: their inverse, their solutions and products with them, by sparse algebra.

SuperLU's factors take as many operations as they have entries where LAPACK takes n^3 in all and a product
with an inverse n^2. Each member of a batch is factorised by itself: so large a mechanism fills a processor
alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

# Rows from which on it pays. Measured on chains of rockers, ms, an inverse by factors against LAPACK's: 0.18
# and 0.08 for 60 rows, 0.4 and 0.6 for 150, 6 and 47 for 600, 115 and 490 for 1500.
LARGE = 100
# Of a matrix' places at most, those that hold an entry: with more there is little to gain.
DENSEST = 0.1
# Columns of a product that are made at a time: what they read stays in a second-level cache.
TOGETHER = 48


@dataclass(frozen=True)
class SparseFactors:
    """SuperLU's factors of matrices, (..., n, n).

    Attributes:
        factors: of each, an array of `scipy.sparse.linalg.SuperLU` of shape (...,).
    """

    factors: NDArray[np.object_]

    def solve(self, right: Array) -> Array:
        """x with matrix x = right, (..., n); further dimensions before those of the matrices are of one."""
        found, batch = np.empty_like(right), self.factors.shape
        for member in np.ndindex(batch):
            place = (..., *member, slice(None))
            own: Any = self.factors[member]
            rows = right[place].reshape(-1, right.shape[-1])
            found[place] = own.solve(rows.T).T.reshape(right[place].shape)
        return found

    def taken(self, members: Indices) -> SparseFactors:
        """Some members, by number; one batch dimension."""
        return SparseFactors(self.factors[members])

    def reshaped(self, batch: tuple[int, ...]) -> SparseFactors:
        """The same with other batch dimensions."""
        return SparseFactors(self.factors.reshape(batch))


def sparse_inverse(matrix: Array) -> tuple[Array, SparseFactors] | None:
    """The inverse of large matrices of few entries, (..., n, n), and the factors that it is made of.

    Returns:
        None where the plain way is as good, or there is no inverse.
    """
    n = matrix.shape[-1]
    if n < LARGE or not (_few(matrix) and np.isfinite(matrix).all()):
        return None
    # Imported here: no car is so large.
    from scipy.sparse import csc_matrix
    from scipy.sparse.linalg import splu

    batch = matrix.shape[:-2]
    inverse, factors = np.empty_like(matrix), np.empty(batch, dtype=object)
    for member in np.ndindex(batch):
        try:
            own: Any = splu(csc_matrix(matrix[member]))
        except RuntimeError:  # a pivot that is exactly zero
            return None
        factors[member], inverse[member] = own, own.solve(np.eye(n))
    return inverse, SparseFactors(factors)


def product_of_few_entries(left: Array, right: Array) -> Array:
    """Products of matrices, (..., n, k) and (..., k, m), the right ones of few entries when they are large.

    Some columns at a time: where none of these has an entry in a row, the left one's column adds nothing.
    """
    n = right.shape[-1]
    if n < LARGE or not _few(right):
        return np.asarray(left @ right)
    filled = (right != 0.0).reshape(-1, *right.shape[-2:]).any(axis=0)
    found = np.empty((*np.broadcast_shapes(left.shape[:-2], right.shape[:-2]), left.shape[-2], n))
    for low in range(0, n, TOGETHER):
        some = slice(low, low + TOGETHER)
        rows = np.flatnonzero(filled[:, some].any(axis=1))
        np.matmul(left[..., rows], right[..., rows, some], out=found[..., some])
    return found


def _few(matrix: Array) -> bool:
    """Whether the members of a batch, (..., n, m), have few entries, each of them and all together."""
    filled = (matrix != 0.0).reshape(-1, *matrix.shape[-2:]).any(axis=0)
    return bool(np.count_nonzero(filled) <= DENSEST * filled.size)
