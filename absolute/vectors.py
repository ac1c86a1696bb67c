"""Vectors of doubles."""

import numpy as np

from absolute.solution import Array

# From 1 to the next number.
EPS = float(np.finfo(float).eps)

NEXT = np.array([1, 2, 0])
LAST = np.array([2, 0, 1])


def cross(a: Array, b: Array) -> Array:
    """a x b over the last axis, quicker than numpy's for a few vectors."""
    product: Array = a.take(NEXT, -1) * b.take(LAST, -1) - a.take(LAST, -1) * b.take(NEXT, -1)
    return product
