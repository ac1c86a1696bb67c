r"""Sums of series in several inputs at many values, and their time derivatives along any laws.

With the powers of a pose's inputs and their time derivatives (see `numerics.monomials`),

    p = Y(a, b),  v = Y_a a' + Y_b b',  acceleration = Y_a a'' + Y_b b'' + Y_aa a'^2 + 2 Y_ab a' b' + Y_bb
    b'^2

are three products with one and the same matrix of coefficients.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.monomials import monomials

Array = NDArray[np.float64]
Whole = NDArray[np.int64]

# Poses per matrix product: their powers, 90 in two inputs, stay in a second-level cache.
BLOCK = 512


def sum_series(
    tables: Sequence[Array], boxes: tuple[Array, Array], order: int, patch: Whole, states: Sequence[Array]
) -> list[Array]:
    """Sum each pose's series, and its time derivatives; poses lie side by side in memory.

    Args:
        tables: by derivative the coefficients of what is wanted of it, each (P, powers, m).
        boxes: middles and half widths of the patches, each (P, p).
        patch: which one each pose lies on, shape (N,).
        states: inputs and their time derivatives, each (N, p).
    Returns:
        By derivative, each (m, N), per s^d.
    """
    found = [np.empty((table.shape[-1], len(patch))) for table in tables]
    # Memory that the system has to map takes longer than filling it does.
    room = np.empty((len(states) + 1, tables[0].shape[1], min(len(patch), BLOCK)))
    for number, members in _by_patch(patch, len(tables[0])):
        middle, scale = boxes[0][number], 1.0 / boxes[1][number]
        count = len(patch) if members is None else len(members)
        for low in range(0, count, BLOCK):
            here = slice(low, min(low + BLOCK, count)) if members is None else members[low : low + BLOCK]
            local = [np.array(state[here].T, order="C") for state in states]
            local[0] -= middle[:, None]
            for state in local:
                state *= scale[:, None]
            for d, block in enumerate(monomials(local, order, room)):
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
