r"""Sums of series in several inputs at many values, and their time derivatives along any laws.

The powers of a total degree are those of the degree below times one variable each: s_1 times all of them, s_2
times those without s_1, and so on. With batch last every such product is one call on contiguous numbers, and
its rates follow Leibniz' rule, (s m)' = s' m + s m' and (s m)'' = s'' m + 2 s' m' + s m''. So

    p = Y(a, b),  v = Y_a a' + Y_b b',  acceleration = Y_a a'' + Y_b b'' + Y_aa a'^2 + 2 Y_ab a' b' + Y_bb
    b'^2

are three products with one and the same matrix of coefficients.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache
from math import comb

import numpy as np
from numpy.typing import NDArray

from pointcoord.data_classes import dataclass
from pointcoord.patches.multi_index import powers

Array = NDArray[np.float64]
Whole = NDArray[np.int64]

# Poses per matrix product: their powers, 90 in two inputs, stay in a second-level cache.
BLOCK = 512


@dataclass(frozen=True)
class Step:
    """Powers low .. high are variable `variable` times the powers first .. last."""

    low: int
    high: int
    variable: int
    first: int
    last: int


@lru_cache(maxsize=32)
def steps(inputs: int, order: int) -> tuple[Step, ...]:
    """How the powers are made of each other, in the order of `multi_index.powers`."""
    found, last = [], 1
    for degree in range(1, order + 1):
        place = last
        for variable in range(inputs):
            # Of the degree below, those without the variables before this one come last.
            others = inputs - variable
            count = comb(degree - 1 + others - 1, others - 1)
            found.append(Step(place, place + count, variable, last - count, last))
            place += count
        last = place
    return tuple(found)


def monomials(states: Sequence[Array], order: int, room: Array | None = None) -> list[Array]:
    """Powers of the variables, and their time derivatives.

    Args:
        states: the variables and as many of their derivatives as are wanted, each (p, N).
        room: where they go, of at least so many derivatives and instants, (derivatives + 2, powers, N); a
            new array has to be mapped by the system, which takes longer than filling it.
    Returns:
        As many arrays of shape (powers, N).
    """
    inputs, count = states[0].shape
    every = comb(order + inputs, inputs)
    if room is None:
        room = np.empty((len(states) + 1, every, count))
    *found, spare = (part[:, :count] for part in room[: len(states) + 1])
    found[0][0] = 1.0
    for rates in found[1:]:
        rates[0] = 0.0
    twice = 2.0 * states[1] if len(states) > 2 else states[0]
    for step in steps(inputs, order):
        here, before, i = slice(step.low, step.high), slice(step.first, step.last), step.variable
        np.multiply(states[0][i], found[0][before], out=found[0][here])
        if len(states) > 1:
            product = spare[here]
            np.multiply(states[0][i], found[1][before], out=found[1][here])
            found[1][here] += np.multiply(states[1][i], found[0][before], out=product)
            if len(states) > 2:
                np.multiply(states[0][i], found[2][before], out=found[2][here])
                found[2][here] += np.multiply(twice[i], found[1][before], out=product)
                found[2][here] += np.multiply(states[2][i], found[0][before], out=product)
    return found


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
