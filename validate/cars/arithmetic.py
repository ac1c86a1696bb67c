"""Arrays of vectors in floating point, or in as many digits as mpmath has been told to work with.

Vectors run along the last axis. Arrays of mpmath's numbers need at least one axis.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from validate.extras import MissingPackage

try:
    import mpmath
except ModuleNotFoundError as error:
    raise MissingPackage("validate.cars.arithmetic", error) from None

Array = NDArray[Any]  # of floats, or of mpmath's numbers


def dot(a: Array, b: Array) -> Array:
    """The scalar product."""
    return np.asarray((a * b).sum(axis=-1))


def length(vector: Array) -> Array:
    """The length of a vector."""
    return root(dot(vector, vector))


def unit(vector: Array) -> Array:
    """A vector of length 1."""
    return np.asarray(vector / length(vector)[..., None])


def across(vector: Array, along: Array) -> Array:
    """The part of a vector at right angles to a unit vector; twice, for the rounding of the first."""
    for _ in range(2):
        vector = vector - dot(vector, along)[..., None] * along
    return vector


def sign(value: Any) -> int:
    """1 from zero up, else -1."""
    return -1 if value < 0 else 1


def root(value: Array) -> Array:
    """Square root; not a number below zero, in either arithmetic."""
    if np.asarray(value).dtype != object:
        with np.errstate(invalid="ignore"):
            return np.asarray(np.sqrt(value))
    return np.asarray(_each(lambda x: mpmath.sqrt(x) if x >= 0 else mpmath.nan, value))


def cosine(angle: Array) -> Array:
    """Cosine of an angle, rad."""
    return np.asarray(np.cos(angle) if angle.dtype != object else _each(mpmath.cos, angle))


def _each(function: Callable[[Any], Any], values: Array) -> Array:
    flat = [function(value) for value in np.asarray(values, dtype=object).ravel()]
    found = np.empty(len(flat), dtype=object)
    found[:] = flat
    return found.reshape(np.shape(values))
