"""Vectors of doubles."""

from collections.abc import Iterable, Sequence
from math import comb
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Counts = NDArray[np.int64]
Places = NDArray[np.intp]

# Distance from 1 to the next double.
EPS = float(np.finfo(float).eps)

NEXT = np.array([1, 2, 0])


def cross(a: Array, b: Array) -> Array:
    """a x b over the last axis; quicker than numpy's for a few vectors."""
    product: Array = (a * b.take(NEXT, -1) - a.take(NEXT, -1) * b).take(NEXT, -1)
    return product


def carried(vector: Array, spins: Sequence[Array], orders: int) -> list[Array]:
    """A vector fixed in a rotating body, and its time derivatives, from x' = w x x:

        x^(n+1) = sum_i C(n, i) w^(i) x x^(n-i),    i = 0 .. n.

    Args:
        vector: (..., 3). spins: w and its derivatives, (..., 3) each; missing ones are zero.
        orders: number of results, with the vector.
    """
    found = [vector]
    for n in range(orders - 1):
        found.append(product_rule(n, (cross(spins[i], found[n - i]) for i in range(min(n + 1, len(spins))))))
    return found


def product_rule(order: int, terms: Iterable[Any]) -> Any:
    """sum_i C(order, i) terms_i over the given terms."""
    total: Any = 0.0
    for i, term in enumerate(terms):
        share = term if i in (0, order) else comb(order, i) * term
        total = total + share if i else share
    return total
