"""The vector product of many vectors, quicker than numpy's for a few."""

import numpy as np

from absolute.solution import Array

NEXT = np.array([1, 2, 0])
LAST = np.array([2, 0, 1])


def cross(a: Array, b: Array) -> Array:
    """a x b over the last axis."""
    product: Array = a.take(NEXT, -1) * b.take(LAST, -1) - a.take(LAST, -1) * b.take(NEXT, -1)
    return product
