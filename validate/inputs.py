"""Inputs of a scene as value, rate and acceleration, evaluated apart from pointcoord's power series."""

from __future__ import annotations

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from pointcoord.scene import InputPart

Array = NDArray[np.float64]


def rates(part: InputPart, times: Array) -> Array:
    """Value, first and second time derivative at instants, shape (N, 3); rad or mm per s^d."""
    if part.table is not None:
        spline = CubicSpline(part.table.times, part.table.values)
        return np.stack([spline(times), spline(times, 1), spline(times, 2)], axis=-1)
    if part.sine is not None:
        wave, speed = part.sine, part.sine.angular_frequency
        angle = speed * times + wave.phase
        value = wave.offset + wave.amplitude * np.sin(angle)
        first = wave.amplitude * speed * np.cos(angle)
        return np.stack([value, first, -wave.amplitude * speed**2 * np.sin(angle)], axis=-1)
    law = Polynomial([part.constant or 0.0] if part.polynomial is None else part.polynomial)
    return np.stack([law(times), law.deriv(1)(times), law.deriv(2)(times)], axis=-1)
