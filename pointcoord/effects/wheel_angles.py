r"""Wheel and kingpin angles by the paper's definitions, for either side and any orientation of the car.

For the left wheel in the paper's axes these are eqs. (16) and (17); `inboard` and `outboard` make the
right wheel its mirror image. Angles are in radians.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def kingpin_angle(lower: Array, upper: Array, up: Array, outboard: Array) -> Array:
    """Inclination of the steering axis in the transverse plane, paper eq. (16), shape (...,).

    atan2(k . inboard, k . up) with k from a lower point of the axis to an upper one: positive when the axis
    leans inboard at the top.
    """
    axis = upper - lower
    return np.asarray(np.arctan2(-(axis @ outboard), axis @ up))


def camber_angle(inner: Array, centre: Array, up: Array, outboard: Array) -> Array:
    """Inclination of the wheel plane in the transverse plane, paper eq. (17), shape (...,).

    atan2(-(n . up), n . outboard) with n along the spin axis, from an inner point of it to the wheel's
    centre: positive when the wheel leans out at the top.
    """
    spindle = centre - inner
    return np.asarray(np.arctan2(-(spindle @ up), spindle @ outboard))
