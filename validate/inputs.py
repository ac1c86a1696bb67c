"""Inputs of a scene as value, rate and acceleration, evaluated apart from pointcoord's power series.

Polynomials are summed in fractions and sines taken in many digits, then rounded once: their terms may cancel,
and an angle may be many turns. What differs between two models is then not the law that they were given.
"""

from __future__ import annotations

import math
from fractions import Fraction

import mpmath
import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from pointcoord.scene import InputPart, SinePart

Array = NDArray[np.float64]

DIGITS = 40  # of a sine, beside those that its angle has before the point


def rates(part: InputPart, times: Array) -> Array:
    """Value, first and second time derivative at instants, shape (N, 3); rad or mm per s^d.

    What is too large for the arithmetic comes out infinite; whoever uses it must check.
    """
    instants = np.asarray(times, dtype=float)
    if part.table is not None:
        with np.errstate(over="ignore", invalid="ignore"):
            spline = CubicSpline(part.table.times, part.table.values)
            return np.stack([spline(instants), spline(instants, 1), spline(instants, 2)], axis=-1)
    if part.sine is not None:
        return np.array([_of_sine(part.sine, t) for t in instants.tolist()])
    if part.polynomial is not None:
        return _of_polynomial(part.polynomial, instants)
    return np.outer(np.ones(len(instants)), [part.constant or 0.0, 0.0, 0.0])


def _of_sine(wave: SinePart, t: float) -> list[float]:
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
    derivatives = [[Fraction(c) for c in coefficients]]
    for _ in range(2):
        derivatives.append([k * c for k, c in enumerate(derivatives[-1])][1:])
    return np.array([[_sum(law, Fraction(t)) for law in derivatives] for t in instants.tolist()])


def _sum(coefficients: list[Fraction], t: Fraction) -> float:
    total = Fraction(0)
    for c in reversed(coefficients):
        total = total * t + c
    try:
        return float(total)
    except OverflowError:
        return math.inf if total > 0 else -math.inf
