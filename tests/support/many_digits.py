"""Numbers and vectors of many digits."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import numpy as np
from mpmath import mpf, sqrt
from numpy.typing import NDArray

Array = NDArray[Any]
Points = dict[str, Array]
DIGITS = 45
fractions = np.vectorize(Fraction, otypes=[object])
"""Doubles of any shape as the numbers that they are."""


def number(value: Any) -> Any:
    """A number of the present digits; fractions are divided."""
    return mpf(value.numerator) / value.denominator if isinstance(value, Fraction) else mpf(value)


def vector(values: Sequence[Any]) -> Array:
    """Numbers of many digits."""
    return np.array([number(value) for value in values], dtype=object)


def unit(v: Array) -> Array:
    """A vector's direction."""
    return v / sqrt(v @ v)


def beside(axis: Array) -> Array:
    """A unit vector across a unit vector."""
    other = vector(np.eye(3)[np.argmin(np.abs(axis.astype(float)))])
    return unit(other - (other @ axis) * axis)


def size(v: Sequence[Any]) -> Any:
    """The length of a vector."""
    return sqrt(sum(x * x for x in v))
