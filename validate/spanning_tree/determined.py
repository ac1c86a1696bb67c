"""Which rows of a Jacobian determine its columns, and which of them together."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import qr
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components, maximum_bipartite_matching

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]

# Rows that depend on each other but for how points are rounded, to some 1e-15 of the car, have a remainder of
# that size. A mechanism that is moved by 1e-9 of the car at a rounding is singular for every use.
DEPENDENT = 1e-9


def independent_rows(jacobian: Array) -> Numbers:
    """As many rows as are independent, increasing, at a pose, (rows, columns).

    Rows are taken by pivoting (Golub and Van Loan, Matrix Computations, 5.4.2), so that those that are left
    out are those that depend most on the others.
    """
    if not jacobian.size:
        return np.zeros(0, dtype=np.int64)
    _, triangle, order = qr(jacobian.T, mode="economic", pivoting=True)
    count = int((np.abs(np.diag(triangle)) > DEPENDENT).sum())
    return np.sort(order[:count]).astype(np.int64)


def blocks(pattern: NDArray[np.bool_]) -> list[tuple[Numbers, Numbers]]:
    """Rows and columns of the diagonal blocks of a square pattern in block triangular form.

    The determinant is the product of theirs (Duff and Reid, ACM Transactions on Mathematical Software 4,
    1978).
    """
    row_of = maximum_bipartite_matching(csr_matrix(pattern), perm_type="row")
    count, label = connected_components(csr_matrix(pattern[row_of]), directed=True, connection="strong")
    members = [np.flatnonzero(label == k) for k in range(count)]
    return [(np.asarray(row_of[columns], dtype=np.int64), columns) for columns in members]
