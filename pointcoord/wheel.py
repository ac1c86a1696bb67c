r"""Wheel and kingpin angles by the paper's definitions, for either side and any orientation of the car.

For the left wheel in the paper's axes these are eqs. (16) and (17); `inboard` and `outboard` make the
right wheel its mirror image. Angles are in radians.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def kingpin_angle(lower_ball_joint: Array, strut_lower: Array, up: Array, outboard: Array) -> Array:
    """Inclination of the steering axis in the transverse plane, paper eq. (16), shape (...,).

    atan2((p7 - p5) . inboard, (p7 - p5) . up): positive when the axis leans inboard at the top.
    """
    axis = strut_lower - lower_ball_joint
    return np.asarray(np.arctan2(-(axis @ outboard), axis @ up))


def camber_angle(strut_lower: Array, wheel_centre: Array, up: Array, outboard: Array) -> Array:
    """Inclination of the wheel plane in the transverse plane, paper eq. (17), shape (...,).

    atan2((p7 - p10) . up, (p10 - p7) . outboard): positive when the wheel leans out at the top. The
    line from point 7 to point 10 is the spin axis.
    """
    spindle = wheel_centre - strut_lower
    return np.asarray(np.arctan2(-(spindle @ up), spindle @ outboard))
