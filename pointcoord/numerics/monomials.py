r"""Powers of several variables at many places, and their time derivatives along any laws.

The powers of a total degree are those of the degree below times one variable each: s_1 times all of them, s_2
times those without s_1, and so on, the order of `itertools.combinations_with_replacement`. With batch last
every such product is one call on contiguous numbers, and its derivatives follow Leibniz' rule,
(s m)' = s m' + s' m, (s m)'' = s m'' + 2 s' m' + s'' m and so on.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import comb

import numpy as np
from numpy.typing import NDArray

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
    # By derivative d those of a variable times their part in Leibniz' rule.
    parts = [
        [comb(d, k) * states[k] if 0 < k < d else states[k] for k in range(d + 1)] for d in range(len(states))
    ]
    for step in steps(inputs, order):
        here, before, i = slice(step.low, step.high), slice(step.first, step.last), step.variable
        for d, (value, *rates) in enumerate(parts):
            np.multiply(value[i], found[d][before], out=found[d][here])
            for k, rate in enumerate(rates, 1):
                found[d][here] += np.multiply(rate[i], found[d - k][before], out=spare[here])
    return found
