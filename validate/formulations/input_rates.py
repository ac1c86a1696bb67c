"""Inputs of a scene as value, rate and acceleration, evaluated apart from pointcoord's power series.

Polynomials and sines are rounded once: polynomials from two numbers of a longer format, sines from one, and
either from many digits or fractions where these do not tell, for terms may cancel, and an angle may be many
turns. A table means scipy's cubic spline, for every model and for the reference.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from fractions import Fraction
from importlib.util import find_spec

import numpy as np
from numpy.typing import NDArray

from pointcoord.scene.scene_file import InputPart, SinePart
from validate.extras import MissingPackage

# It takes half as long to import as numpy, and few laws need it; but it is missed before a scene is solved.
if find_spec("mpmath") is None:
    raise MissingPackage("validate.formulations.input_rates", ModuleNotFoundError(name="mpmath"))

Array = NDArray[np.float64]
Long = NDArray[np.longdouble]

DIGITS = 40  # of a sine, beside those that its angle has before the point
TRIED = (DIGITS, 4 * DIGITS)  # of a polynomial
# Rounding unit of the longer format that numbers are tried in first; without one nothing is sure.
LONG = float(np.finfo(np.longdouble).eps) / 2.0
# Of a sine or cosine of that format, in such units: twice what the C library's own tests allow it.
SINE = 4.0
# Splits a number of that format into two of half its digits each.
SPLITTER = np.longdouble(2.0 ** ((np.finfo(np.longdouble).nmant + 2) // 2)) + 1
# A smaller product may have lost digits that are below the smallest number of the format.
LEAST = np.finfo(np.longdouble).tiny / np.longdouble(LONG) ** 2


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
    import mpmath

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
    """A polynomial and its rates, each rounded once.

    Horner's rule, and by Horner's rule too what its products and sums leave out (Graillat, Langlois and
    Louvet, Japan Journal of Industrial and Applied Mathematics 26, 2009). Where nothing is left out that is
    known: a rate of two terms often lies halfway between two doubles.
    """
    t = instants.astype(np.longdouble)
    found = np.zeros((len(instants), 3))
    derivatives = [[Fraction(c) for c in coefficients]]
    for _ in range(2):
        derivatives.append([k * c for k, c in enumerate(derivatives[-1])][1:])
    with np.errstate(all="ignore"):
        for d in range(3):
            total, rest, size = (np.zeros(t.shape, np.longdouble) for _ in range(3))
            for k in range(len(coefficients) - 1, d - 1, -1):
                term, lost_1 = _product(np.longdouble(coefficients[k]), np.longdouble(math.perm(k, d)))
                product, lost_2 = _product(total, t)
                total, lost_3 = _sum_of_two(product, term)
                rest = rest * t + (lost_1 + (lost_2 + lost_3))
                size = _not_lost(size * np.abs(t), size, t) + (
                    np.abs(lost_1) + np.abs(lost_2) + np.abs(lost_3)
                )
            # Of each power a product and three sums are rounded; a little more for the size's own rounding.
            doubt = 1.01 * 4.0 * (len(coefficients) - d) * LONG * size
            found[:, d], sure = _of_two(total, rest, doubt)
            for i in np.flatnonzero(~sure).tolist():
                found[i, d] = _sum(derivatives[d], float(instants[i]))
    return found


def _product(a: Long | np.longdouble, b: Long | np.longdouble) -> tuple[Long, Long]:
    """A product and what its rounding leaves out (Dekker, Numerische Mathematik 18, 1971).

    The latter is not finite where a factor is too large to be split, or the product too small.
    """
    product = np.asarray(a * b)
    a_high, b_high = (SPLITTER * x - (SPLITTER * x - x) for x in (a, b))
    a_low, b_low = a - a_high, b - b_high
    lost = ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low
    return product, _not_lost(lost, a, b, product)


def _not_lost(
    number: Long, a: Long | np.longdouble, b: Long | np.longdouble, product: Long | None = None
) -> Long:
    """A number, or NaN where the product a b, itself unless given, lost digits at the format's lower end."""
    small = np.abs(number if product is None else product) < LEAST
    return np.asarray(np.where(small & (a != 0.0) & (b != 0.0), np.longdouble(np.nan), number))


def _sum_of_two(a: Long, b: Long) -> tuple[Long, Long]:
    """A sum and what its rounding leaves out (Knuth, The Art of Computer Programming 2, 4.2.2)."""
    total = a + b
    part = total - a
    return total, (a - (total - part)) + (b - part)


def _of_two(total: Long, rest: Long, doubt: Long) -> tuple[Array, NDArray[np.bool_]]:
    """The doubles nearest to total + rest, which may be off by `doubt`, and where that is sure."""
    # Where terms cancelled, the rest is more than a unit of the total's last digit.
    total, rest = _sum_of_two(total, rest)
    found = total.astype(float)
    beyond = (total - found) + rest
    room = doubt + 2.0 * LONG * (np.abs(beyond) + np.abs(rest))
    # Half the way to both neighbours. A tie has to be exact: then the format itself rounds it to even.
    above, below = (
        (np.nextafter(found, end).astype(np.longdouble) - found) / 2.0 for end in (np.inf, -np.inf)
    )
    inside = np.isfinite(above - below) & (beyond + room < above) & (beyond - room > below)
    exact = np.isfinite(total) & (rest == 0.0) & (doubt == 0.0)
    return found, np.asarray(inside | exact)


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


def _sum(coefficients: Sequence[Fraction], t: float) -> float:
    """Horner's rule with as many digits as tell to which double it rounds.

    Digits, however many, leave a tie undecided that a tiny term decides: then in fractions.
    """
    import mpmath

    for digits in TRIED:
        with mpmath.workdps(digits):
            total = size = mpmath.mpf(0)
            for c in reversed(coefficients):
                term = mpmath.mpf(c.numerator) / c.denominator  # of few digits: nothing is rounded
                total, size = total * t + term, size * abs(t) + abs(term)
            # A product and a sum of each power, each rounded to less than a unit of the last digit.
            room = 2 * len(coefficients) * size * mpmath.mpf(10) ** (1 - digits)
            low, high = float(total - room), float(total + room)
        if low == high:
            return low
    exact, instant = Fraction(0), Fraction(t)
    for c in reversed(coefficients):
        exact = exact * instant + c
    try:
        return float(exact)
    except OverflowError:
        return math.inf if exact > 0 else -math.inf
