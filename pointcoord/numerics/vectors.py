"""Products of vectors, with components mostly in the last dimension of arrays."""

from __future__ import annotations

import numpy as np

from pointcoord.numerics.arrays import Array

NEXT, LAST = np.array([1, 2, 0]), np.array([2, 0, 1])  # the next and the previous axis, cyclic


def components_first(array: Array) -> Array:
    """A view with components, the last dimension, first; takes a twentieth of the time of moveaxis."""
    return array.transpose(*range(-1, array.ndim - 1))


def components_last(array: Array) -> Array:
    """A view with components, the first dimension, last."""
    return array.transpose(*range(1, array.ndim), 0)


def cross(a: Array, b: Array) -> Array:
    """a x b of shapes (..., 3), as numpy's `cross`, in a quarter of its time for a few vectors."""
    return np.asarray(
        a.take(NEXT, axis=-1) * b.take(LAST, axis=-1) - a.take(LAST, axis=-1) * b.take(NEXT, axis=-1)
    )


def lengths(vectors: Array) -> Array:
    """|v| of vectors (..., 3), shape (...)."""
    return np.asarray(np.sqrt(np.vecdot(vectors, vectors)))
