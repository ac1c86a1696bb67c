r"""Sums of series in several inputs at many values, and their time derivatives along any laws.

With the powers of a pose's inputs and their time derivatives (see `numerics.monomials`),

    p = Y(a, b),  v = Y_a a' + Y_b b',  acceleration = Y_a a'' + Y_b b'' + Y_aa a'^2 + 2 Y_ab a' b' + Y_bb
    b'^2

are three products with one and the same matrix of coefficients.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.monomials import monomials
from pointcoord.numerics.multi_index import powers

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


@dataclass(frozen=True)
class _Exponents:
    """Of one pose's powers.

    Attributes:
        each: 0 .. order. which: exponents of every power but the first, by variable.
        lowered, factors: exponents and factors of x^k and of its first two derivatives, (3, order + 1).
        signs: of powers of negative numbers with these exponents, likewise.
    """

    each: Array
    which: tuple[NDArray[np.intp], ...]
    lowered: Array
    factors: Array
    signs: Array


def _powers(x: float, exponents: Array, signs: Array) -> Array:
    """Powers of a number; those of a negative one take three times as long as those of its magnitude."""
    if x >= 0.0:
        return np.asarray(x**exponents)
    return np.asarray((-x) ** exponents * signs)


@lru_cache(maxsize=32)
def exponents(inputs: int, order: int) -> _Exponents:
    """Of series in some inputs."""
    each = np.arange(order + 1.0)
    lowered = np.maximum(each - np.arange(3.0)[:, None], 0.0)
    factors = np.stack([np.ones(order + 1), each, each * (each - 1.0)])
    which = tuple(np.ascontiguousarray(k) for k in powers(inputs, order).exponents[1:].T)
    return _Exponents(each, which, lowered, factors, np.where(lowered % 2.0 == 1.0, -1.0, 1.0))


@dataclass(frozen=True)
class OnePatch:
    """A patch made ready for one pose at a time, with as few calls as possible.

    Attributes:
        places: middle and half width of each input. first: the first coefficient of each sum, (m,).
        later: the others, (powers - 1, m).
    """

    places: tuple[tuple[float, float], ...]
    first: Array
    later: Array
    exponents: _Exponents

    @classmethod
    def of(cls, coefficients: Array, middle: Array, half: Array, order: int) -> OnePatch:
        """From its coefficients, shape (powers, m), middle and half widths, (p,)."""
        places = tuple(zip(middle.tolist(), half.tolist(), strict=True))
        return cls(places, coefficients[0], coefficients[1:], exponents(len(middle), order))

    def at(self, values: Sequence[float]) -> Array:
        """The sums, (m,)."""
        row: Array | None = None
        each, signs = self.exponents.each, self.exponents.signs[0]
        for value, (middle, half), k in zip(values, self.places, self.exponents.which, strict=True):
            own = _powers((value - middle) / half, each, signs).take(k)
            row = own if row is None else row * own
        assert row is not None  # a map has an input
        found: Array = row.dot(self.later)
        found += self.first
        return found

    def moving(self, states: Sequence[Sequence[float]]) -> Array:
        """The sums and their time derivatives, (derivatives + 1, m), per s^d.

        By the chain rule f(x)' = f_x x' and f(x)'' = f_x x'' + f_xx x'^2 for the powers of each variable, and
        Leibniz' rule for their products.

        Args:
            states: inputs and their time derivatives, each (p,).
        """
        count = len(states)
        rows: list[Array] = []
        lowered, factors = self.exponents.lowered[:count], self.exponents.factors[:count]
        for i, ((middle, half), k) in enumerate(zip(self.places, self.exponents.which, strict=True)):
            by_x = _powers((states[0][i] - middle) / half, lowered, self.exponents.signs[:count])
            by_x *= factors
            rate = states[1][i] / half
            own = [by_x[0], rate * by_x[1]]
            if count > 2:
                own.append(states[2][i] / half * by_x[1] + rate * rate * by_x[2])
            here = [part.take(k) for part in own]
            if not rows:
                rows = here
                continue
            product = [rows[0] * here[0], rows[1] * here[0] + rows[0] * here[1]]
            if count > 2:
                product.append(rows[2] * here[0] + 2.0 * (rows[1] * here[1]) + rows[0] * here[2])
            rows = product
        found: Array = np.array(rows).dot(self.later)
        found[0] += self.first
        return found
