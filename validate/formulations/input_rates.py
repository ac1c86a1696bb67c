"""Inputs of a scene as value, rate and acceleration, evaluated apart from pointcoord's power series.

Polynomials and sines are taken in many digits and rounded once: their terms may cancel, and an angle may be
many turns. A table means scipy's cubic spline, for every model and for the reference.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from pointcoord.scene.scene_file import InputPart, SinePart
from validate.extras import MissingPackage

try:
    import mpmath
except ModuleNotFoundError as error:
    raise MissingPackage("validate.formulations.input_rates", error) from None

Array = NDArray[np.float64]

DIGITS = 40  # of a sine, beside those that its angle has before the point; half of them of a polynomial
MOST_DIGITS = 1000  # terms that cancel further than this cancel to zero


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
    derivatives = [[mpmath.mpf(c) for c in coefficients]]
    with mpmath.workdps(DIGITS):
        for _ in range(2):
            derivatives.append([k * c for k, c in enumerate(derivatives[-1])][1:])
    return np.array([[_sum(law, t) for law in derivatives] for t in instants.tolist()])


def _sum(coefficients: list[mpmath.mpf], t: float) -> float:
    """Horner's rule with as many digits as the terms cancel, and `DIGITS` more."""
    digits = DIGITS
    while True:
        with mpmath.workdps(digits):
            total = size = mpmath.mpf(0)
            for c in reversed(coefficients):
                total, size = total * t + c, size * abs(t) + abs(c)
            if digits >= MOST_DIGITS or abs(total) * mpmath.mpf(10) ** (digits - DIGITS // 2) >= size:
                return float(total)
            digits *= 2
