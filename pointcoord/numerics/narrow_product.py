"""A small matrix times many columns, a few columns at a time.

The products stay below what a numerical library shares out among threads: the threads of so small a product
wait for each other most of the time, and on a machine that is busy with other work some hundred times as long
as one thread takes. One thread does as well by parts, to a tenth.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Multiplications of a part. OpenBLAS shares out products of 2^20, and none of 2^19.
MOST = 2**19
FEWEST = 64


def narrow_product(matrix: Array, columns: Array, out: Array) -> None:
    """Write a product, shapes (..., m, k), (k, N) and (..., m, N), where it belongs."""
    step = max(MOST // max(matrix.shape[-2] * matrix.shape[-1], 1), FEWEST)
    for low in range(0, columns.shape[-1], step):
        here = slice(low, low + step)
        np.matmul(matrix, columns[:, here], out=out[..., here])
