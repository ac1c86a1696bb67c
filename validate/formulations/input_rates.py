"""Inputs of a scene as value, rate and acceleration, evaluated apart from pointcoord's power series.

Polynomials and sines are rounded once: from a number of a longer format, or from many digits or fractions
where that does not tell, for terms may cancel, and an angle may be many turns. A table means scipy's cubic
spline, for every model and for the reference.
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
    """A polynomial and its rates by Horner's rule, each rounded once."""
    t, count = instants.astype(np.longdouble), len(coefficients)
    sums, doubts = [], []
    with np.errstate(all="ignore"):
        for d in range(3):
            total, size = np.zeros(t.shape, np.longdouble), np.zeros(t.shape, np.longdouble)
            for k in range(count - 1, d - 1, -1):
                term = np.longdouble(coefficients[k]) * math.perm(k, d)
                total, size = total * t + term, size * np.abs(t) + abs(term)
            sums.append(total)
            # Of each power two products and a sum are rounded; a little more for the size's own rounding.
            doubts.append(1.01 * 3.0 * count * LONG * size)
        return _rounded_once(sums, doubts, lambda i, d: _exact_sum(coefficients, float(instants[i]), d))


def _exact_sum(coefficients: tuple[float, ...], t: float, d: int) -> float:
    """The d-th derivative by Horner's rule in whole numbers: all of it times one power of two."""
    from flint import fmpz

    n, power = t.as_integer_ratio()
    ratios = [c.as_integer_ratio() for c in coefficients]
    common, step = max(below for _, below in ratios), power.bit_length() - 1
    exact, shift = fmpz(0), 0
    for k in range(len(coefficients) - 1, d - 1, -1):
        above, below = ratios[k]
        exact = exact * n + (fmpz(math.perm(k, d) * above * (common // below)) << shift)
        shift += step
    try:
        return int(exact) / (common << max(shift - step, 0))
    except OverflowError:
        return math.inf if exact > 0 else -math.inf


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
