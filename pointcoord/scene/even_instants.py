"""Instants evenly between two others, each the number that a person would write."""

from __future__ import annotations

from fractions import Fraction
from math import lcm

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Whole numbers up to 2^53 are exact, so that their quotient is rounded once.
EXACT = 2**53


def even_instants(start: float, stop: float, samples: int) -> Array:
    """`samples` instants evenly from start to stop, shape (samples,), s.

    A start of 0, a stop of 2.6 and 131 samples mean 0.02, 0.04, 0.06: of the decimal numbers that start and
    stop are printed as, the instants are the exact ones, each rounded once, and are printed as short. With
    start = a / d, stop = b / d and n steps that is (a n + i (b - a)) / (d n), a quotient of whole numbers;
    where these are too large to be exact, the instants are rounded a few times more.
    """
    steps = samples - 1
    if steps < 1:
        return np.full(samples, start)
    first, last = Fraction(repr(start)), Fraction(repr(stop))
    common = lcm(first.denominator, last.denominator)
    a, b = int(first * common), int(last * common)
    if max(abs(a), abs(b), common) * steps > EXACT:
        # Steps below the smallest normal number are rounded so coarsely that they add up to more than all.
        return np.minimum(np.linspace(start, stop, samples), stop)
    return np.asarray((a * steps + np.arange(samples) * (b - a)) / (common * steps))
