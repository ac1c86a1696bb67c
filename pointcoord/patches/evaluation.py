r"""Sums of series in several inputs for many poses, and their time derivatives for any laws of the inputs.

With the powers of a pose's inputs and their time derivatives (see `numerics.monomials`),

    p = Y(a, b),    v = Y_a a' + Y_b b',
    acceleration = Y_a a'' + Y_b b'' + Y_aa a'^2 + 2 Y_ab a' b' + Y_bb b'^2

are three products with the same matrix of coefficients.

A single pose, as in the time loop of another program, is summed variable by variable instead: nearly all of
the time is the overhead of calls, and this needs only a tenth of the calls.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache

import numpy as np

from pointcoord.numerics.arrays import Array, Indices, Integers
from pointcoord.numerics.monomials import monomials
from pointcoord.numerics.multi_index import powers

# Poses per matrix product: their powers, 90 in two inputs, stay in a second-level cache.
BLOCK = 512


def sum_series(
    table: Array,
    boxes: tuple[Array, Array],
    order: int,
    patch: Integers,
    states: Sequence[Array],
    out: Sequence[Array] | None = None,
) -> Sequence[Array]:
    """Sum the series of each pose's patch, and its time derivatives. Poses are contiguous in memory.

    Args:
        table: coefficients of the wanted numbers, (P, powers, m).
        boxes: middles and half widths of the patches, each (P, p).
        order: total degree of the series.
        patch: number of the patch of each pose, shape (N,).
        states: inputs and their time derivatives, each (N, p).
        out: arrays to write the sums into; new arrays unless given.
    Returns:
        One array for each derivative, (m, N), per s^d.
    """
    found = [np.empty((table.shape[-1], len(patch))) for _ in states] if out is None else out
    # One array for all blocks: getting new memory from the system takes longer than filling it.
    room = np.empty((len(states) + 1, table.shape[1], min(len(patch), BLOCK)))
    for number, members in _by_patch(patch, len(table)):
        middle, scale = boxes[0][number], 1.0 / boxes[1][number]
        for low in range(0, len(members), BLOCK):
            here = members[low : low + BLOCK]
            local = [np.array(state[here].T, order="C") for state in states]
            local[0] -= middle[:, None]
            for state in local:
                state *= scale[:, None]
            for d, block in enumerate(monomials(local, order, room)):
                summed = table[number, 1:].T @ block[1:]
                if d == 0:
                    summed += table[number, 0, :, None]
                found[d][:, here] = summed
    return found


def _by_patch(patch: Integers, patches: int) -> Iterator[tuple[int, Indices]]:
    """Each patch that has poses, with the places of its poses."""
    by_patch = np.argsort(patch, kind="stable")
    counts = np.bincount(patch, minlength=patches)
    last = np.cumsum(counts)
    for number in np.flatnonzero(counts):
        yield int(number), by_patch[last[number] - counts[number] : last[number]]


def table_of_exponents(coefficients: Array, inputs: int, order: int) -> tuple[Array, Array]:
    """The constant coefficients, (m,), and a table of the others by exponents, (order + 1, .., m).

    Args:
        coefficients: coefficients of one patch, (powers, m).
    """
    table = np.zeros(((order + 1,) * inputs) + coefficients.shape[1:])
    exponents = powers(inputs, order).exponents[1:]
    table[tuple(exponents.T)] = coefficients[1:]
    return coefficients[0], table


def sum_one(first: Array, table: Array, states: Sequence[Sequence[float]]) -> Array:
    """One pose's sums and their time derivatives, (derivatives + 1, m).

    Args:
        first, table: result of `table_of_exponents`.
        states: inputs in half widths from the middle, and their time derivatives, each (p,).
    """
    count, width = len(states), len(table)
    each, lowered, signs, factors = _powers_of_one(width)
    if count == 1:
        for x in states[0]:
            # Powers of a negative number take three times as long as those of its magnitude.
            row = x**each if x >= 0.0 else (-x) ** each * signs[0]
            table = row.dot(table.reshape(width, -1))
        return (table + first).reshape(1, -1)
    # For each variable the derivatives up to the highest. This gives all mixed derivatives, also unused ones.
    for i, x in enumerate(states[0]):
        rows = abs(x) ** lowered[:count] * (factors[:count] if x >= 0.0 else (factors * signs)[:count])
        table = rows @ table.reshape(count**i, width, -1)
    inputs = len(states[0])
    weights = np.zeros((count, count**inputs))
    weights[0, 0] = 1.0
    places = [count ** (inputs - 1 - i) for i in range(inputs)]
    for i, place in enumerate(places):
        weights[1, place] = states[1][i]
        if count > 2:
            weights[2, place] = states[2][i]
            for j, other in enumerate(places):
                weights[2, place + other] += states[1][i] * states[1][j]
    found = weights @ table.reshape(count**inputs, -1)
    found[0] += first
    return np.asarray(found)


@lru_cache(maxsize=32)
def _powers_of_one(width: int) -> tuple[Array, Array, Array, Array]:
    """Exponents k = 0 .. width - 1; then exponents, signs for negative x, and factors of x^k and its two
    derivatives, each (3, width)."""
    each = np.arange(float(width))
    lowered = np.maximum(each - np.arange(3.0)[:, None], 0.0)
    factors = np.stack([np.ones(width), each, each * (each - 1.0)])
    return each, lowered, np.where(lowered % 2.0, -1.0, 1.0), factors
