"""Evenly spaced instants, each the number that a person would write."""

from __future__ import annotations

from fractions import Fraction
from math import lcm

import numpy as np

from pointcoord.numerics.arrays import Array

# Whole numbers up to 2^53 are exact, so that their quotient is rounded once.
EXACT = 2**53


def even_instants(start: float, stop: float, samples: int, first: int = 0, last: int | None = None) -> Array:
    """`samples` even instants from start to stop, s, or only those from number `first` to before `last`.

    A start of 0, a stop of 2.6 and 131 samples give 0.02, 0.04, 0.06. Start and stop are taken as the decimal
    numbers that are printed for them. Each instant is then computed exactly and rounded once, so that it is
    printed with few digits. With start = a / d, stop = b / d and n steps, instant i is
    (a n + i (b - a)) / (d n), a quotient of whole numbers. If these are too large to be exact, the instants
    are rounded a few times more.
    """
    steps, numbers = samples - 1, np.arange(first, samples if last is None else last)
    if steps < 1:
        return np.full(len(numbers), start)
    exact_start, exact_stop = Fraction(repr(start)), Fraction(repr(stop))
    common = lcm(exact_start.denominator, exact_stop.denominator)
    a, b = int(exact_start * common), int(exact_stop * common)
    if max(abs(a), abs(b), common) * steps > EXACT:
        step = (stop - start) / steps
        # A step below the smallest number is zero. A step below the smallest normal number is rounded so
        # coarsely that all steps together may exceed the whole time.
        instants = start + (numbers * step if step else numbers / steps * (stop - start))
        return np.minimum(np.where(numbers == steps, stop, instants), stop)
    return np.asarray((a * steps + numbers * (b - a)) / (common * steps))
