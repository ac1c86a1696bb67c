r"""The inverse of a large matrix of few entries, block after block.

With the rows and columns in the order of the blocks that its entries make (see `structure`), a matrix A is
block lower triangular, and the rows of its inverse X follow one block after the other,

    X_b = D_b^-1 (E_b - sum_{c < b} A_bc X_c),

D_b the diagonal block and E_b its rows of the identity: n products for each earlier unknown that a row
reads, where LAPACK takes n^3 in all. The determinant is the product of those of the D_b. The members of a
batch have the blocks of the entries that any of them has, which is a block triangle of each.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from pointcoord.data_classes import dataclass
from pointcoord.numerics.structure import Block, structure_of

Array = NDArray[np.float64]

# Rows from which on blocks pay: below, LAPACK inverts a matrix in less time than they are found in.
LARGE = 100
# Of a row's places at most, those that hold an entry: with more there is little to gain, and finding blocks
# takes time for each.
DENSEST = 0.1


@dataclass(frozen=True)
class BlockInverse:
    """The inverse of matrices, shape (..., n, n), and the signs of their determinants, shape (...,)."""

    inverse: Array
    sign: Array


@dataclass(frozen=True)
class _Entries:
    """Where a matrix has entries; see `structure.System`."""

    reads: Sequence[Sequence[int]]
    unknowns: int


def inverse_by_blocks(matrix: Array) -> BlockInverse | None:
    """The inverse of large matrices, (..., n, n); None where blocks make it no easier, or there is none.

    Args:
        matrix: finite numbers.
    """
    n = matrix.shape[-1]
    if n < LARGE:
        return None
    filled = (matrix != 0.0).reshape(-1, n, n).any(axis=0)
    if np.count_nonzero(filled) > DENSEST * n * n:
        return None
    blocks = _blocks_of(np.packbits(filled).tobytes(), n)
    if max(len(block.rows) for block in blocks) > n // 2:
        return None
    try:
        return _inverted(matrix, blocks)
    except np.linalg.LinAlgError:
        return None


@lru_cache(maxsize=4)
def _blocks_of(filled: bytes, n: int) -> tuple[Block, ...]:
    """The blocks of a pattern, which stays the same from pose to pose, n rows of n bits."""
    bits = np.unpackbits(np.frombuffer(filled, dtype=np.uint8), count=n * n).reshape(n, n)
    rows, columns = np.nonzero(bits)
    reads = np.split(columns, np.searchsorted(rows, np.arange(1, n)))
    return structure_of(_Entries([read.tolist() for read in reads], n)).blocks


def _inverted(matrix: Array, blocks: Sequence[Block]) -> BlockInverse:
    n = matrix.shape[-1]
    diagonal, sign = _diagonal(matrix, blocks)
    rows = np.array([row for block in blocks for row in block.rows])
    unknowns = np.array([unknown for block in blocks for unknown in block.unknowns])
    place = np.empty(n, dtype=np.intp)
    place[unknowns] = np.arange(n)
    # In the order of the blocks, where what lies right of the diagonal is zero.
    found = np.zeros_like(matrix)
    low = 0
    for block, own in zip(blocks, diagonal, strict=True):
        high = low + len(block.rows)
        if block.reads:
            read = matrix[..., list(block.rows), :][..., list(block.reads)]
            earlier = found[..., place[list(block.reads)], :low]
            found[..., low:high, :low] = -(own @ read) @ earlier
        found[..., low:high, low:high] = own
        low = high
    inverse = np.empty_like(found)
    inverse[..., unknowns[:, None], rows] = found
    return BlockInverse(inverse, sign * _parity(rows) * _parity(unknowns))


def _diagonal(matrix: Array, blocks: Sequence[Block]) -> tuple[list[Array], Array]:
    """Inverses of the diagonal blocks, those of a size at once, and the sign of their product."""
    by_size: dict[int, list[int]] = {}
    for number, block in enumerate(blocks):
        by_size.setdefault(len(block.rows), []).append(number)
    inverses: dict[int, Array] = {}
    sign = np.ones(matrix.shape[:-2])
    for numbers in by_size.values():
        rows = np.array([blocks[number].rows for number in numbers])
        unknowns = np.array([blocks[number].unknowns for number in numbers])
        own = matrix[..., rows[:, :, None], unknowns[:, None, :]]
        sign = sign * np.linalg.slogdet(own)[0].prod(axis=-1)
        inverted = np.asarray(np.linalg.inv(own), dtype=float)
        inverses |= {number: inverted[..., i, :, :] for i, number in enumerate(numbers)}
    return [inverses[number] for number in range(len(blocks))], sign


def _parity(order: NDArray[np.intp]) -> float:
    """1 of an even permutation, -1 of an odd one: a cycle of even length changes it."""
    seen, parity = np.zeros(len(order), dtype=bool), 1.0
    for start in range(len(order)):
        length, here = 0, start
        while not seen[here]:
            seen[here] = True
            here, length = int(order[here]), length + 1
        if length and length % 2 == 0:
            parity = -parity
    return parity
