"""The directions of a car by name, from its axes `up` and `right`."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.double_double import Pair, pair_cross

Array = NDArray[np.float64]

DIRECTIONS = ("up", "right", "down", "left", "forward", "rearward")


def car_directions(up: Array, right: Array) -> dict[str, Pair]:
    """Each direction as a high and a low part, shape (..., 3); forward is up x right, rounded twice over."""
    none = np.zeros_like(up), np.zeros_like(right)
    high, low = pair_cross((up, none[0]), (right, none[1]))
    return {
        "up": (up, none[0]),
        "right": (right, none[1]),
        "down": (-up, none[0]),
        "left": (-right, none[1]),
        "forward": (high, low),
        "rearward": (-high, -low),
    }
