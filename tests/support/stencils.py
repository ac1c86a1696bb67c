"""Derivatives of vectors by central differences of seven values, in many digits."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction

from exact_vectors import number
from mpmath import mpf

from validate.reference.vectors import Vector, minus, plus, times

STEP = mpf("1e-10")
# The weights at 1, 2, 3 steps ahead and behind, of the first and of the second derivative.
FIRST = (Fraction(3, 4), Fraction(-3, 20), Fraction(1, 60))
SECOND = (Fraction(3, 2), Fraction(-3, 20), Fraction(1, 90))
# They are off by STEP^6 of the seventh and eighth derivative, which are below 1e20 where this is used; the
# values' own rounding, below 1e-100, is divided by STEP^2.
OFF = mpf("1e-38")


def seven(at: Callable[[mpf], Vector]) -> list[Vector]:
    """The values at three steps behind, now and three ahead."""
    return [at(n * STEP) for n in range(-3, 4)]


def derivatives(values: Sequence[Vector]) -> tuple[Vector, Vector]:
    """x' and x'' from seven values."""
    zero = (mpf(0), mpf(0), mpf(0))
    rate, bend = zero, zero
    for n, (first, second) in enumerate(zip(FIRST, SECOND, strict=True), start=1):
        ahead, now, behind = values[3 + n], values[3], values[3 - n]
        rate = plus(rate, times(minus(ahead, behind), number(first) / STEP))
        bend = plus(bend, times(minus(plus(ahead, behind), times(now, 2)), number(second) / STEP**2))
    return rate, bend


def close(a: Vector, b: Vector, limit: mpf) -> bool:
    return all(abs(x) < limit for x in minus(a, b))
