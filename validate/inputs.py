"""Inputs of a scene as value, rate and acceleration, evaluated apart from pointcoord's power series."""

from __future__ import annotations

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from pointcoord.scene import InputPart

Array = NDArray[np.float64]


def rates(part: InputPart, times: Array) -> Array:
    """Value, first and second time derivative at instants, shape (N, 3); rad or mm per s^d.

    What is too large for the arithmetic comes out infinite; whoever uses it must check.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        return _rates(part, times)


def _rates(part: InputPart, times: Array) -> Array:
    if part.table is not None:
        spline = CubicSpline(part.table.times, part.table.values)
        return np.stack([spline(times), spline(times, 1), spline(times, 2)], axis=-1)
    if part.sine is not None:
        wave, speed = part.sine, part.sine.angular_frequency
        # The phase is a factor of its own: added to the angle, a large one would swallow the digits of time.
        turn = wave.amplitude * np.exp(1j * wave.phase) * np.exp(1j * speed * times)
        return np.stack([wave.offset + turn.imag, speed * turn.real, -(speed**2) * turn.imag], axis=-1)
    law = Polynomial([part.constant or 0.0] if part.polynomial is None else part.polynomial)
    return np.stack([law(times), law.deriv(1)(times), law.deriv(2)(times)], axis=-1)
