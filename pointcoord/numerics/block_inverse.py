r"""The inverse of a large matrix of few entries, block after block.

With the rows and columns in the order of the blocks that its entries make (see `block_order`), a matrix A is
block lower triangular. Neighbours in that order are taken together in groups of some rows, which one product
each serves as quickly as it would a single block; the rows of the inverse X follow one group after the other,

    X_g = D_g^-1 (E_g - sum_{c < g} A_gc X_c),

D_g the group's diagonal block and E_g its rows of the identity: n products for each earlier unknown that a
row reads, where LAPACK takes n^3 in all. The determinant is the product of those of the D_g. A solution of
A x = b needs no X at all,

    x_g = D_g^-1 (b_g - sum_{c < g} A_gc x_c):

for n unknowns n GROUP products and those of the entries, where a product with X takes n^2. The members of a
batch have the blocks of the entries that any of them has, which is a block triangle of each.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.block_order import block_order_of

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

# Rows from which on blocks pay. Measured on chains of rockers, ms, blocks against LAPACK's inverse and
# determinant: 0.24 and 0.15 for 60 rows, 0.43 and 0.45 for 102, 0.5 and 1.1 for 150, 1.3 and 4 for 252, 22
# and 390 for 1500; the pattern has been seen before.
LARGE = 100
# Of a row's places at most, those that hold an entry: with more there is little to gain, and finding blocks
# takes time for each.
DENSEST = 0.1
# Rows of a group: of 16 to 192, those from 32 to 64 take the least time, at 150 unknowns and at 1500.
GROUP = 48


@dataclass(frozen=True)
class _Group:
    """Some blocks one after the other: places low to high in the order of the blocks.

    Attributes:
        reads: the places of earlier unknowns that its rows read. saved: where the inverse's rows of these are
            kept (see `_Plan.later`).
    """

    low: int
    high: int
    reads: Indices
    saved: Indices


@dataclass(frozen=True)
class _Plan:
    """How matrices of a pattern are inverted.

    Attributes:
        rows, unknowns: in the order of the blocks.
        later: the places of the unknowns that a later group reads, ascending.
        largest: rows of the largest block.
    """

    rows: Indices
    unknowns: Indices
    groups: tuple[_Group, ...]
    later: Indices
    largest: int


@dataclass(frozen=True)
class Substitution:
    """Solutions group after group, for matrices of shape (..., n, n).

    Attributes:
        own: D_g^-1 of each group. outside: A_gc of all c that it reads.
    """

    plan: _Plan
    own: tuple[Array, ...]
    outside: tuple[Array, ...]

    def solve(self, right: Array) -> Array:
        """x with A x = right, shapes (..., n)."""
        b = right.take(self.plan.rows, axis=-1)
        x = np.empty_like(b)
        for group, own, outside in zip(self.plan.groups, self.own, self.outside, strict=True):
            rows = b[..., group.low : group.high]
            if len(group.reads):
                rows = rows - np.matvec(outside, x.take(group.reads, axis=-1))
            x[..., group.low : group.high] = np.matvec(own, rows)
        found = np.empty_like(x)
        found[..., self.plan.unknowns] = x
        return found

    def taken(self, members: Indices) -> Substitution:
        """Some members, by number; one batch dimension."""
        own, outside = (tuple(part[members] for part in parts) for parts in (self.own, self.outside))
        return Substitution(self.plan, own, outside)

    def reshaped(self, batch: tuple[int, ...]) -> Substitution:
        """The same with other batch dimensions."""
        own, outside = (
            tuple(part.reshape(*batch, *part.shape[-2:]) for part in parts)
            for parts in (self.own, self.outside)
        )
        return Substitution(self.plan, own, outside)


def inverse_by_blocks(matrix: Array) -> tuple[Array, Substitution] | None:
    """The inverse of large matrices, (..., n, n), and the parts that it is made of.

    Args:
        matrix: finite numbers.
    Returns:
        None where blocks make it no easier, or there is no inverse.
    """
    n = matrix.shape[-1]
    if n < LARGE:
        return None
    filled = (matrix != 0.0).reshape(-1, n, n).any(axis=0)
    if np.count_nonzero(filled) > DENSEST * n * n:
        return None
    plan = _plan_of(np.packbits(filled).tobytes(), n)
    if plan.largest > n // 2:
        return None
    try:
        return _inverted(matrix, plan)
    except np.linalg.LinAlgError:
        return None


@lru_cache(maxsize=4)
def _plan_of(filled: bytes, n: int) -> _Plan:
    """How to go about a pattern, which stays the same from pose to pose, n rows of n bits."""
    bits = np.unpackbits(np.frombuffer(filled, dtype=np.uint8), count=n * n).reshape(n, n)
    reads = np.split(np.nonzero(bits)[1], np.cumsum(np.count_nonzero(bits, axis=1))[:-1])
    blocks = block_order_of([read.tolist() for read in reads], n).blocks
    rows = np.array([row for block in blocks for row in block.rows])
    unknowns = np.array([unknown for block in blocks for unknown in block.unknowns])
    place = np.empty(n, dtype=np.intp)
    place[unknowns] = np.arange(n)
    edges, high = [0], 0
    for block in blocks:
        if high > edges[-1] and high + len(block.rows) - edges[-1] > GROUP:
            edges.append(high)
        high += len(block.rows)
    spans = list(zip(edges, [*edges[1:], n], strict=True))
    outside = [
        np.unique(np.concatenate([place[reads[row]] for row in rows[low:high]])) for low, high in spans
    ]
    outside = [read[read < low] for read, (low, _) in zip(outside, spans, strict=True)]
    later = np.unique(np.concatenate(outside))
    groups = tuple(
        _Group(low, high, read, np.searchsorted(later, read))
        for (low, high), read in zip(spans, outside, strict=True)
    )
    largest = max(len(block.rows) for block in blocks)
    return _Plan(rows, unknowns, groups, later, largest)


def _inverted(matrix: Array, plan: _Plan) -> tuple[Array, Substitution]:
    batch, n = matrix.shape[:-2], matrix.shape[-1]
    inverse = np.zeros_like(matrix)
    # Rows of the inverse that are read again, their columns in the order of the blocks.
    saved = np.zeros((*batch, len(plan.later), n))
    own_parts, outside_parts = [], []
    for group in plan.groups:
        low, high = group.low, group.high
        some = matrix[..., plan.rows[low:high], :]
        diagonal = some[..., plan.unknowns[low:high]]
        outside = some[..., plan.unknowns[group.reads]]
        own = np.asarray(np.linalg.inv(diagonal), dtype=float)
        found = np.empty((*batch, high - low, high))
        found[..., low:] = own
        found[..., :low] = -(own @ outside) @ saved[..., group.saved, :low]
        inverse[..., plan.unknowns[low:high, None], plan.rows[:high]] = found
        first, last = np.searchsorted(plan.later, (low, high))
        saved[..., first:last, :high] = found[..., plan.later[first:last] - low, :]
        own_parts.append(own)
        outside_parts.append(outside)
    return inverse, Substitution(plan, tuple(own_parts), tuple(outside_parts))


def product_of_few_entries(left: Array, right: Array) -> Array:
    """Products of matrices, (..., n, k) and (..., k, m), the right ones of few entries when they are large.

    Some columns at a time: where none of these has an entry in a row, the left one's column adds nothing.
    """
    n = right.shape[-1]
    if n < LARGE:
        return np.asarray(left @ right)
    filled = (right != 0.0).reshape(-1, *right.shape[-2:]).any(axis=0)
    if np.count_nonzero(filled) > DENSEST * filled.size:
        return np.asarray(left @ right)
    found = np.empty((*np.broadcast_shapes(left.shape[:-2], right.shape[:-2]), left.shape[-2], n))
    for low in range(0, n, GROUP):
        some = slice(low, low + GROUP)
        rows = np.flatnonzero(filled[:, some].any(axis=1))
        np.matmul(left[..., rows], right[..., rows, some], out=found[..., some])
    return found
