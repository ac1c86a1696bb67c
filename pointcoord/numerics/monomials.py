r"""Powers of several variables at many places, and their time derivatives along any laws.

The powers of a total degree are those of the degree below times one variable each: s_1 times all of them, s_2
times those without s_1, and so on, the order of `itertools.combinations_with_replacement`. With batch last
every such product is one call on contiguous numbers, and its rates follow Leibniz' rule,
(s m)' = s' m + s m' and (s m)'' = s'' m + 2 s' m' + s m''.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from math import comb

import numpy as np
from numpy.typing import NDArray

from pointcoord.data_classes import dataclass
from pointcoord.numerics.multi_index import powers

Array = NDArray[np.float64]


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
    """How the powers are made of each other, in the order of their degrees."""
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


@dataclass(frozen=True)
class _Exponents:
    """Of one place's powers.

    Attributes:
        which: exponents of every power, by variable.
        lowered, factors: exponents and factors of x^k and of its first two derivatives, (3, order + 1).
        signed: factors of the powers of a negative number's magnitude, likewise.
    """

    which: tuple[NDArray[np.intp], ...]
    lowered: Array
    factors: Array
    signed: Array


@lru_cache(maxsize=32)
def _exponents(inputs: int, order: int) -> _Exponents:
    each = np.arange(order + 1.0)
    lowered = np.maximum(each - np.arange(3.0)[:, None], 0.0)
    factors = np.stack([np.ones(order + 1), each, each * (each - 1.0)])
    which = tuple(np.ascontiguousarray(k) for k in powers(inputs, order).exponents.T)
    return _Exponents(which, lowered, factors, factors * np.where(lowered % 2.0, -1.0, 1.0))


def monomials_of_one(states: Sequence[Sequence[float]], order: int) -> list[Array]:
    """The same at one place, in a tenth of the time: one call for the powers of each variable.

    By the chain rule f(x)' = f_x x' and f(x)'' = f_x x'' + f_xx x'^2 for the powers of each variable, and by
    Leibniz' rule for their products.

    Args:
        states: the variables and as many of their derivatives as are wanted, each (p,).
    Returns:
        As many arrays of shape (powers,).
    """
    exponents = _exponents(len(states[0]), order)
    if len(states) == 1:
        return [_values_of_one(states[0], exponents)]
    bends = len(states) > 2
    rows: list[Array] = []
    for i, (x, which) in enumerate(zip(states[0], exponents.which, strict=True)):
        by_x = abs(x) ** exponents.lowered * (exponents.factors if x >= 0.0 else exponents.signed)
        rate = states[1][i]
        own = [by_x[0].take(which), (rate * by_x[1]).take(which)]
        if bends:
            own.append((states[2][i] * by_x[1] + rate * rate * by_x[2]).take(which))
        if not rows:
            rows = own
            continue
        product = [rows[0] * own[0], rows[1] * own[0] + rows[0] * own[1]]
        if bends:
            product.append(rows[2] * own[0] + 2.0 * (rows[1] * own[1]) + rows[0] * own[2])
        rows = product
    return rows


def _values_of_one(values: Sequence[float], exponents: _Exponents) -> Array:
    """The powers alone, with as few calls as possible."""
    each, signs = exponents.lowered[0], exponents.signed[0]
    row: Array | None = None
    for x, which in zip(values, exponents.which, strict=True):
        # Powers of a negative number take three times as long as those of its magnitude.
        own = (x**each if x >= 0.0 else (-x) ** each * signs).take(which)
        row = own if row is None else row * own
    assert row is not None  # a series has a variable
    return row
