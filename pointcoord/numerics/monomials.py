r"""Monomials of several variables at many places, and their time derivatives for any laws of the variables.

The monomials of a degree are those of the degree below times one variable each: s_1 times all of them, s_2
times those without s_1, and so on, in the order of `itertools.combinations_with_replacement`. With the batch
as the last dimension, every such product is one call on contiguous numbers. Derivatives follow Leibniz' rule,
(s m)' = s m' + s' m, (s m)'' = s m'' + 2 s' m' + s'' m and so on.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import comb

import numpy as np

from pointcoord.numerics.arrays import Array


@dataclass(frozen=True)
class Step:
    """Monomials low .. high are the variable `variable` times the monomials first .. last."""

    low: int
    high: int
    variable: int
    first: int
    last: int


@lru_cache(maxsize=32)
def steps(inputs: int, order: int) -> tuple[Step, ...]:
    """The products that make all monomials from each other, in the order of their degrees."""
    found, last = [], 1
    for degree in range(1, order + 1):
        place = last
        for variable in range(inputs):
            # In the degree below, the monomials without earlier variables come last.
            others = inputs - variable
            count = comb(degree - 1 + others - 1, others - 1)
            found.append(Step(place, place + count, variable, last - count, last))
            place += count
        last = place
    return tuple(found)


def monomials(states: Sequence[Array], order: int, room: Array | None = None) -> list[Array]:
    """Monomials of the variables, and their time derivatives.

    Args:
        states: the variables and as many of their derivatives as wanted, each (p, N).
        room: array for the results, with at least as many derivatives and instants, (derivatives + 2, powers,
            N); allocating a new array takes longer than filling it.
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
    # For each derivative d, the variables' derivatives times their binomial coefficients in Leibniz' rule.
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
