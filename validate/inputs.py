"""Inputs of a scene as value, rate and acceleration, evaluated apart from pointcoord's power series."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from pointcoord.scene import InputPart

Array = NDArray[np.float64]


def rates(part: InputPart, times: Array) -> Array:
    """Value, first and second time derivative at instants, shape (N, 3); rad or mm per s^d.

    Polynomials are evaluated exactly and rounded once, sines in long double: their terms may cancel.
    What is too large for the arithmetic comes out infinite; whoever uses it must check.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        return _rates(part, np.asarray(times, float)).astype(float)


def _rates(part: InputPart, times: Array) -> NDArray[np.floating]:
    if part.table is not None:
        spline = CubicSpline(part.table.times, part.table.values)
        return np.stack([spline(times), spline(times, 1), spline(times, 2)], axis=-1)
    if part.sine is not None:
        wave, speed = part.sine, np.longdouble(part.sine.angular_frequency)
        # The phase is a factor of its own: added to the angle, a large one would swallow the digits of time.
        phase = np.exp(1j * np.longdouble(wave.phase))
        turn = wave.amplitude * phase * np.exp(1j * speed * times.astype(np.longdouble))
        return np.stack([wave.offset + turn.imag, speed * turn.real, -(speed**2) * turn.imag], axis=-1)
    if part.polynomial is None:
        return np.outer(np.ones(len(times)), [part.constant or 0.0, 0.0, 0.0])
    law = [Fraction(c) for c in part.polynomial]
    derivatives = [law]
    for _ in range(2):
        derivatives.append([k * c for k, c in enumerate(derivatives[-1])][1:])
    return np.array([[_rounded(_sum(d, Fraction(t))) for d in derivatives] for t in times.tolist()])


def _sum(coefficients: list[Fraction], t: Fraction) -> Fraction:
    total = Fraction(0)
    for c in reversed(coefficients):
        total = total * t + c
    return total


def _rounded(value: Fraction) -> float:
    try:
        return float(value)
    except OverflowError:
        return math.copysign(math.inf, value)
