"""Large sparse matrices: their inverse, solutions and products, by sparse algebra.

SuperLU's factors take as many operations as they have entries, where LAPACK takes n^3 for the inverse and n^2
for a product with it. Each member of a batch is factorised separately: a mechanism of this size keeps a
processor busy on its own.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.arrays import Array, Indices

# Rows from which sparse algebra is faster. Measured on chains of rockers, ms for an inverse by SuperLU and by
# LAPACK: 0.18 and 0.08 for 60 rows, 0.4 and 0.6 for 150, 6 and 47 for 600, 115 and 490 for 1500.
LARGE = 100
# Largest share of nonzero entries: with more there is little to gain.
DENSEST = 0.1
# Columns of a product computed at a time: the data that they read stay in the second-level cache.
TOGETHER = 48


@dataclass(frozen=True)
class SparseFactors:
    """SuperLU's factors of matrices, (..., n, n).

    Attributes:
        factors: factors of each matrix, an array of `scipy.sparse.linalg.SuperLU` of shape (...,).
    """

    factors: NDArray[np.object_]

    def solve(self, right: Array) -> Array:
        """x with matrix x = right, (..., n); further dimensions come before those of the matrices."""
        found, batch = np.empty_like(right), self.factors.shape
        for member in np.ndindex(batch):
            place = (..., *member, slice(None))
            own: Any = self.factors[member]
            rows = right[place].reshape(-1, right.shape[-1])
            found[place] = own.solve(rows.T).T.reshape(right[place].shape)
        return found

    def taken(self, members: Indices) -> SparseFactors:
        """Some members of the one batch dimension, by number."""
        return SparseFactors(self.factors[members])

    def reshaped(self, batch: tuple[int, ...]) -> SparseFactors:
        """The factors with other batch dimensions."""
        return SparseFactors(self.factors.reshape(batch))


def sparse_inverse(matrix: Array) -> tuple[Array, SparseFactors] | None:
    """The inverse of large sparse matrices, (..., n, n), and the factors that it comes from.

    Returns:
        None where dense algebra is as good, or no inverse exists.
    """
    n = matrix.shape[-1]
    if n < LARGE or not (_few(matrix) and np.isfinite(matrix).all()):
        return None
    # Imported here: no car's matrix is so large.
    from scipy.sparse import csc_matrix
    from scipy.sparse.linalg import splu

    batch = matrix.shape[:-2]
    inverse, factors = np.empty_like(matrix), np.empty(batch, dtype=object)
    for member in np.ndindex(batch):
        try:
            own: Any = splu(csc_matrix(matrix[member]))
        except RuntimeError:  # an exactly zero pivot
            return None
        factors[member], inverse[member] = own, own.solve(np.eye(n))
    return inverse, SparseFactors(factors)


def product_of_few_entries(left: Array, right: Array) -> Array:
    """Products of matrices, (..., n, k) and (..., k, m), where large right ones are sparse.

    Computed for some columns at a time: rows without an entry in these columns are skipped.
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
    """Whether the members of a batch, (..., n, m), are sparse, with the entries of all members counted."""
    filled = (matrix != 0.0).reshape(-1, *matrix.shape[-2:]).any(axis=0)
    return bool(np.count_nonzero(filled) <= DENSEST * filled.size)
