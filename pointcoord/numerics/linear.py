r"""One factorisation of a square system, used for many right-hand sides.

The rows are first scaled by powers of two to a largest entry near 1, which is exact. LAPACK's LU with partial
pivoting then gives the inverse, because the condition number and the error bound of a pose need it anyway.
Each solution is refined once with its own residual, which makes it as accurate as an LU solve (Higham,
Accuracy and Stability of Numerical Algorithms, ch. 12 and 14). A large sparse matrix is factorised, and its
solutions are found, by sparse algebra (see `few_entries`).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from pointcoord.numerics.arrays import Array, Flags, Indices
from pointcoord.numerics.few_entries import LARGE, SparseFactors, sparse_inverse
from pointcoord.numerics.rounding import EPS

# Rows of a large matrix processed at a time, so that intermediate results stay in the second-level cache.
ROWS = 32


@dataclass(frozen=True)
class Factors:
    """A factorised matrix, of shape (..., n, n), any leading batch dimensions.

    Attributes:
        matrix: the matrix, its rows scaled.
        inverse: the inverse of the scaled matrix.
        row_scale: the power of two that scales each row, shape (..., n).
        condition: condition number of the scaled matrix in the maximum norm, shape (...,); infinite
            where the matrix is exactly singular, and NaN where it has NaN elements.
        sparse: factors of the scaled matrix, if it is large and has few entries.
    """

    matrix: Array
    inverse: Array
    row_scale: Array
    condition: Array
    sparse: SparseFactors | None = None

    def solve(self, right: Array) -> Array:
        """x with matrix x = right, shapes (..., n), refined once."""
        rows = right * self.row_scale
        if self.sparse is not None:
            found = self.sparse.solve(rows)
            return np.asarray(found + self.sparse.solve(rows - self._times(found)))
        found = np.matvec(self.inverse, rows)
        return np.asarray(found + np.matvec(self.inverse, rows - np.matvec(self.matrix, found)))

    def solve_many(self, rights: Array) -> Array:
        """Solutions for several right-hand sides of each matrix, (m, ..., n), refined once."""
        if self.sparse is not None:
            return self.solve(rights)
        rows = rights * self.row_scale
        found = _times(rows, self.inverse)
        found += _times(rows - _times(found, self.matrix), self.inverse)
        return found

    def moved(self, matrix: Array) -> Factors:
        """Factors of a nearby matrix (..., n, n) with this inverse, |I - inverse matrix| = z well below 1.

        A solution's relative error is z^2, because it is refined with the new matrix. The condition number
        is kept from the old matrix.
        """
        scaled = matrix * self.row_scale[..., None]
        return Factors(scaled, self.inverse, self.row_scale, self.condition, self.sparse)

    def _times(self, x: Array) -> Array:
        """The product with vectors of shape (..., n), over the nonzero entries only."""
        rows, columns, starts = self._entries
        return np.add.reduceat(self.matrix[..., rows, columns] * x.take(columns, axis=-1), starts, axis=-1)

    @cached_property
    def _entries(self) -> tuple[Indices, Indices, Indices]:
        """Rows and columns of the entries nonzero in any member, row by row, and the start of each row."""
        n = self.matrix.shape[-1]
        filled = (self.matrix != 0.0).reshape(-1, n, n).any(axis=0)
        rows, columns = np.divmod(np.flatnonzero(filled), n)
        return rows, columns, np.searchsorted(rows, np.arange(n))

    def reshaped(self, batch: tuple[int, ...]) -> Factors:
        """The same factors with other batch dimensions."""
        n = self.matrix.shape[-1]
        return Factors(
            self.matrix.reshape(*batch, n, n),
            self.inverse.reshape(*batch, n, n),
            self.row_scale.reshape(*batch, n),
            self.condition.reshape(batch),
            None if self.sparse is None else self.sparse.reshaped(batch),
        )

    def taken(self, members: Indices) -> Factors:
        """Some members of the one batch dimension, by number."""
        return Factors(
            self.matrix[members],
            self.inverse[members],
            self.row_scale[members],
            self.condition[members],
            None if self.sparse is None else self.sparse.taken(members),
        )

    def replaced(self, members: Indices, new: Factors) -> Factors:
        """These factors with some members of the one batch dimension, by number, replaced by others."""
        if len(members) == len(self.condition):
            return new
        result = [self.matrix.copy(), self.inverse.copy(), self.row_scale.copy(), self.condition.copy()]
        for mine, other in zip(result, (new.matrix, new.inverse, new.row_scale, new.condition), strict=True):
            mine[members] = other
        matrix, inverse, row_scale, condition = result
        return Factors(matrix, inverse, row_scale, condition)

    @cached_property
    def preconditioner(self) -> Array:
        """The inverse of the unscaled matrix, shape (..., n, n)."""
        return np.asarray(self.inverse * self.row_scale[..., None, :])

    @property
    def singular(self) -> Flags:
        """Where no digit of a solution is certain: n eps condition >= 1 (or a NaN), shape (...,)."""
        return np.asarray(~(self.matrix.shape[-1] * EPS * self.condition < 1.0))


def _times(rows: Array, matrix: Array) -> Array:
    """The product of each matrix, (..., n, n), with several vectors for it, (m, ..., n)."""
    return np.asarray(np.matmul(rows, matrix, axes=[(0, -1), (-1, -2), (0, -1)]))


def factorise(matrix: Array) -> Factors:
    """Factorise matrices of shape (..., n, n); singular ones are marked, and raise no error."""
    row_scale = np.ldexp(1.0, 1 - np.frexp(np.abs(matrix).max(axis=-1))[1])
    scaled = matrix * row_scale[..., None]
    found = sparse_inverse(scaled)
    if found is not None:
        own, sparse = found
        return Factors(scaled, own, row_scale, _condition(scaled, own), sparse)
    try:
        inverse = np.linalg.inv(scaled)
    except np.linalg.LinAlgError:
        # An exactly zero pivot in one member stops the whole batch: the identity replaces such members.
        sound = (np.linalg.slogdet(scaled)[0] != 0.0)[..., None, None]
        inverse = np.linalg.inv(np.where(sound, scaled, np.eye(matrix.shape[-1])))
        inverse = np.where(sound, inverse, np.inf)
    return Factors(scaled, inverse, row_scale, _condition(scaled, inverse))


def _condition(matrix: Array, inverse: Array) -> Array:
    """|A| |A^-1| in the maximum norm, shape (...,)."""
    with np.errstate(invalid="ignore", over="ignore"):
        return _norm(matrix) * _norm(inverse)


def _norm(matrix: Array) -> Array:
    """The largest sum of magnitudes of a row, shape (...,)."""
    if matrix.shape[-2] < LARGE:
        # A product takes a fraction of a reduction's time.
        return np.asarray((np.abs(matrix) @ np.ones(matrix.shape[-1])).max(axis=-1))
    parts = (matrix[..., low : low + ROWS, :] for low in range(0, matrix.shape[-2], ROWS))
    return np.asarray(np.max([np.abs(part).sum(axis=-1).max(axis=-1) for part in parts], axis=0))


def null_directions(matrix: Array) -> tuple[Array, Array]:
    """Right and left null vectors of one matrix (m, n): rows of shape (k, n) and (l, m).

    A singular value counts as zero below max(m, n) eps times the largest (LAPACK's own error bound).
    """
    rows, columns = matrix.shape
    left, values, right = np.linalg.svd(matrix)
    limit = max(rows, columns) * EPS * (values[0] if values.size else 1.0)
    rank = int(np.count_nonzero(values > limit))
    return right[rank:], left[:, rank:].T


def smallest_singular_vectors(matrix: Array) -> tuple[Array, Array]:
    """Unit vectors (n,) of the combinations of rows and of columns of (n, n) that are nearest to zero."""
    left, _, right = np.linalg.svd(matrix)
    return left[:, -1], right[-1]
