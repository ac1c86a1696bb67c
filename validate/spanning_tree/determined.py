"""Independent rows of a Jacobian, and its diagonal blocks."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import qr
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components, maximum_bipartite_matching

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]

# Rows that are dependent apart from the rounding of points, some 1e-15 of the car, have a remainder of that
# size. A mechanism that a rounding moves by 1e-9 of the car is singular for every use.
DEPENDENT = 1e-9


def independent_rows(jacobian: Array) -> Numbers:
    """A largest set of independent rows of a Jacobian (rows, columns), in increasing order.

    Rows are chosen by pivoting (Golub and Van Loan, Matrix Computations, 5.4.2), so the rows left out are
    those that depend most on the others.
    """
    if not jacobian.size:
        return np.zeros(0, dtype=np.int64)
    _, triangle, order = qr(jacobian.T, mode="economic", pivoting=True)
    count = int((np.abs(np.diag(triangle)) > DEPENDENT).sum())
    return np.sort(order[:count]).astype(np.int64)


def blocks(pattern: NDArray[np.bool_]) -> list[tuple[Numbers, Numbers]]:
    """Rows and columns of the diagonal blocks of a square pattern in block triangular form.

    The determinant of the matrix is the product of those of the blocks (Duff and Reid, ACM Transactions on
    Mathematical Software 4, 1978).
    """
    row_of = maximum_bipartite_matching(csr_matrix(pattern), perm_type="row")
    count, label = connected_components(csr_matrix(pattern[row_of]), directed=True, connection="strong")
    members = [np.flatnonzero(label == k) for k in range(count)]
    return [(np.asarray(row_of[columns], dtype=np.int64), columns) for columns in members]
