r"""Sums of series in several inputs at many values, and their time derivatives along any laws.

With the powers of a pose's inputs and their time derivatives (see `numerics.monomials`),

    p = Y(a, b),  v = Y_a a' + Y_b b',  acceleration = Y_a a'' + Y_b b'' + Y_aa a'^2 + 2 Y_ab a' b' + Y_bb
    b'^2

are three products with one and the same matrix of coefficients.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from pointcoord.data_classes import dataclass
from pointcoord.numerics.monomials import monomials
from pointcoord.patches.multi_index import powers

Array = NDArray[np.float64]
Whole = NDArray[np.int64]

# Poses per matrix product: their powers, 90 in two inputs, stay in a second-level cache.
BLOCK = 512


def sum_series(
    coefficients: Array,
    middle: Array,
    half: Array,
    order: int,
    patch: Whole,
    states: Sequence[Array],
) -> Array:
    """Sum each pose's series, and its time derivatives.

    Args:
        coefficients: shape (P, powers, m). middle, half: of the patches' boxes, (P, p).
        patch: which one each pose lies on, shape (N,).
        states: inputs and their time derivatives, each (N, p).
    Returns:
        Shape (derivatives + 1, N, m), per s^d.
    """
    result = np.empty((len(states), len(patch), coefficients.shape[-1]))
    summing = _Summing.of(coefficients, middle, half, order, states)
    for number, members in _by_patch(patch, len(coefficients)):
        for here, d, block in summing.blocks(number, members):
            summed = block[1:].T @ coefficients[number, 1:]
            if d == 0:
                summed += coefficients[number, 0]
            result[d, here] = summed
    return result


def sum_rows(
    tables: Sequence[Array],
    middle: Array,
    half: Array,
    order: int,
    patch: Whole,
    states: Sequence[Array],
) -> list[Array]:
    """The same with poses side by side in memory, and of each derivative only what is wanted.

    Args:
        tables: by derivative the coefficients of what is wanted of it, each (P, powers, m).
    Returns:
        By derivative, each (m, N).
    """
    found = [np.empty((table.shape[-1], len(patch))) for table in tables]
    summing = _Summing.of(tables[0], middle, half, order, states)
    for number, members in _by_patch(patch, len(tables[0])):
        for here, d, block in summing.blocks(number, members):
            summed = tables[d][number, 1:].T @ block[1:]
            if d == 0:
                summed += tables[0][number, 0, :, None]
            found[d][:, here] = summed
    return found


def _by_patch(patch: Whole, patches: int) -> Iterator[tuple[int, NDArray[np.intp] | None]]:
    """Each patch that poses lie on with the places of these; None for all of them."""
    if not len(patch):
        return
    if (patch == patch[0]).all():
        yield int(patch[0]), None
        return
    # Whole numbers of 16 bits are sorted in one pass over their digits.
    small = patch.astype(np.int16) if patches < 2**15 else patch
    by_patch = np.argsort(small, kind="stable")
    counts = np.bincount(patch, minlength=patches)
    last = np.cumsum(counts)
    for number in np.flatnonzero(counts):
        yield int(number), by_patch[last[number] - counts[number] : last[number]]


@dataclass(frozen=True)
class _Summing:
    """Powers of the poses on a patch, in blocks that share their memory."""

    middle: Array
    half: Array
    order: int
    states: Sequence[Array]
    room: Array

    @classmethod
    def of(
        cls, coefficients: Array, middle: Array, half: Array, order: int, states: Sequence[Array]
    ) -> _Summing:
        count = min(len(states[0]), BLOCK)
        return cls(middle, half, order, states, np.empty((len(states) + 1, coefficients.shape[1], count)))

    def blocks(
        self, number: int, members: NDArray[np.intp] | None
    ) -> Iterator[tuple[slice | NDArray[np.intp], int, Array]]:
        """Places of some poses, a derivative, and the powers' derivatives there, (powers, poses)."""
        scale = 1.0 / self.half[number]
        count = len(self.states[0]) if members is None else len(members)
        for low in range(0, count, BLOCK):
            here = slice(low, min(low + BLOCK, count)) if members is None else members[low : low + BLOCK]
            local = [np.array(state[here].T, order="C") for state in self.states]
            local[0] -= self.middle[number][:, None]
            for state in local:
                state *= scale[:, None]
            for d, block in enumerate(monomials(local, self.order, self.room)):
                yield here, d, block


@lru_cache(maxsize=32)
def _exponents(inputs: int, order: int) -> tuple[Array, list[NDArray[np.intp]]]:
    """0 .. order, and the exponents of every power but the first by variable."""
    return np.arange(order + 1.0), list(powers(inputs, order).exponents[1:].T)


def sum_series_once(
    coefficients: Array, middle: Array, half: Array, order: int, states: Sequence[Array]
) -> Array:
    """The same for one pose on one patch, with as few calls as possible.

    Args:
        coefficients: shape (powers, m). middle, half: (p,).
        states: inputs and their time derivatives, each (p,).
    Returns:
        Shape (derivatives + 1, m), per s^d.
    """
    if len(states) > 1:
        local = [((states[0] - middle) / half)[:, None], *((state / half)[:, None] for state in states[1:])]
        rows = np.stack([row[1:, 0] for row in monomials(local, order)])
        result = np.asarray(rows @ coefficients[1:])
        result[0] += coefficients[0]
        return result
    exponents, which = _exponents(len(middle), order)
    row: Array | None = None
    for value, at, width, k in zip(states[0].tolist(), middle.tolist(), half.tolist(), which, strict=True):
        own = (((value - at) / width) ** exponents)[k]
        row = own if row is None else row * own
    assert row is not None  # a map has an input
    return np.asarray(row @ coefficients[1:] + coefficients[0])[None]
