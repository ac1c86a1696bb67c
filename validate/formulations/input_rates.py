"""Inputs of a scene as value, rate and acceleration, evaluated apart from pointcoord's power series.

Polynomials and sines are rounded once, polynomials from fractions and sines from many digits where a longer
format does not tell: terms may cancel, and an angle may be many turns. A table means scipy's cubic spline,
for every model and for the reference.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from pointcoord.scene.scene_file import InputPart, SinePart
from validate.extras import MissingPackage

try:
    import mpmath
except ModuleNotFoundError as error:
    raise MissingPackage("validate.formulations.input_rates", error) from None

Array = NDArray[np.float64]
Long = NDArray[np.longdouble]

DIGITS = 40  # of a sine, beside those that its angle has before the point
TRIED = (DIGITS, 4 * DIGITS)  # of a polynomial
# Rounding unit of the longer format that numbers are tried in first; without one nothing is sure.
LONG = float(np.finfo(np.longdouble).eps) / 2.0
# Of a sine or cosine of that format, in such units: twice what the C library's own tests allow it.
SINE = 4.0


def rates(part: InputPart, times: Array) -> Array:
    """Value, first and second time derivative at instants, shape (N, 3); rad or mm per s^d.

    What is too large for the arithmetic comes out infinite; whoever uses it must check.
    """
    instants = np.asarray(times, dtype=float)
    if part.table is not None:
        # Imported here: it takes several times as long as numpy, and few scenes have a table.
        from scipy.interpolate import CubicSpline

        with np.errstate(over="ignore", invalid="ignore"):
            spline = CubicSpline(part.table.times, part.table.values)
            return np.stack([spline(instants), spline(instants, 1), spline(instants, 2)], axis=-1)
    if part.sine is not None:
        return _of_sine(part.sine, instants)
    if part.polynomial is not None:
        return _of_polynomial(part.polynomial, instants)
    return np.outer(np.ones(len(instants)), [part.constant or 0.0, 0.0, 0.0])


def _of_sine(wave: SinePart, instants: Array) -> Array:
    """Offset + amplitude sin(angle) and its rates, each rounded once."""
    amplitude, speed, t = (np.longdouble(x) for x in (wave.amplitude, wave.angular_frequency, instants))
    with np.errstate(all="ignore"):
        angle = speed * t + np.longdouble(wave.phase)
        # The product and the sum are rounded once each.
        doubt = LONG * (2.0 * np.abs(speed * t) + abs(wave.phase)) + SINE * LONG
        cosine, sine = np.cos(angle), np.sin(angle)
        sums = [wave.offset + amplitude * sine, amplitude * speed * cosine, -amplitude * speed * speed * sine]
        # Three products at most, and a sum.
        sizes = [np.abs(amplitude * speed**d) * (doubt + 4.0 * LONG) for d in range(3)]
        sizes[0] += LONG * (abs(wave.offset) + np.abs(amplitude))
        return _rounded_once(sums, sizes, lambda i, d: _exact_sine(wave, float(instants[i]))[d])


def _exact_sine(wave: SinePart, t: float) -> list[float]:
    speed, instant, phase = (Fraction(x) for x in (wave.angular_frequency, t, wave.phase))
    angle = speed * instant + phase
    with mpmath.workdps(DIGITS + len(str(int(abs(angle))))):
        cosine, sine = mpmath.cos_sin(mpmath.mpf(angle.numerator) / angle.denominator)
        amplitude, w = mpmath.mpf(wave.amplitude), mpmath.mpf(wave.angular_frequency)
        return [
            float(wave.offset + amplitude * sine),
            float(amplitude * w * cosine),
            float(-amplitude * w * w * sine),
        ]


def _of_polynomial(coefficients: tuple[float, ...], instants: Array) -> Array:
    """A polynomial and its rates by Horner's rule, each rounded once."""
    derivatives = [[mpmath.mpf(c) for c in coefficients]]
    with mpmath.workdps(DIGITS):
        for _ in range(2):
            derivatives.append([k * c for k, c in enumerate(derivatives[-1])][1:])
    t = instants.astype(np.longdouble)
    sums: list[Long] = []
    sizes: list[Long] = []
    with np.errstate(all="ignore"):
        for d in range(3):
            total, size = (np.zeros(t.shape, np.longdouble) for _ in range(2))
            for k in range(len(coefficients) - 1, d - 1, -1):
                term = np.longdouble(coefficients[k]) * np.longdouble(math.perm(k, d))
                total, size = total * t + term, size * np.abs(t) + np.abs(term)
            sums.append(total)
            # A product and a sum of each power, and a coefficient, are rounded once each.
            sizes.append(2.0 * (len(coefficients) - d) * LONG * size)
    return _rounded_once(sums, sizes, lambda i, d: _sum(derivatives[d], float(instants[i])))


def _rounded_once(sums: Sequence[Long], doubts: Sequence[Long], exact: Callable[[int, int], float]) -> Array:
    """Numbers of a longer format as the doubles nearest to what they stand for, shape (N, 3).

    Where a number and what it may be off by could round to two doubles, many digits or fractions decide
    (Ziv, ACM Transactions on Mathematical Software 17, 1991).

    Args:
        sums: by derivative, (N,). doubts: how far they may be off. exact: one of them, by instant and
            derivative.
    """
    total, doubt = np.stack(sums, axis=-1), np.stack(doubts, axis=-1)
    with np.errstate(all="ignore"):
        found = np.asarray(total, dtype=float)
        # A little more makes up for the rounding of the doubt itself and of these two sums.
        room = 1.001 * doubt + LONG * np.abs(total)
        sure = ((total - room).astype(float) == found) & ((total + room).astype(float) == found)
    for i, d in np.argwhere(~sure).tolist():
        found[i, d] = exact(i, d)
    return found


def _sum(coefficients: Sequence[mpmath.mpf], t: float) -> float:
    """Horner's rule with as many digits as tell to which double it rounds.

    Digits, however many, leave a tie undecided that a tiny term decides: then in fractions.
    """
    for digits in TRIED:
        with mpmath.workdps(digits):
            total = size = mpmath.mpf(0)
            for c in reversed(coefficients):
                total, size = total * t + c, size * abs(t) + abs(c)
            # A product and a sum of each power, each rounded to less than a unit of the last digit.
            room = 2 * len(coefficients) * size * mpmath.mpf(10) ** (1 - digits)
            low, high = float(total - room), float(total + room)
        if low == high:
            return low
    exact, instant = Fraction(0), Fraction(t)
    for c in reversed(coefficients):
        exact = exact * instant + Fraction(*mpmath.libmp.to_rational(c._mpf_))
    try:
        return float(exact)
    except OverflowError:
        return math.inf if exact > 0 else -math.inf
