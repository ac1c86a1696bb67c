"""Named directions of a car, computed from its axes `up` and `right`."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.double_double import Pair, pair_cross, pair_dot, pair_quotient, pair_root

Array = NDArray[np.float64]

DIRECTIONS = ("up", "right", "down", "left", "forward", "rearward")
AXIS = "axis "


def axis_along(direction: str) -> str:
    """Name of a rotation axis along a direction, which has unit length to twice the working precision.

    Direction vectors in doubles have unit length to one rounding only, and rotations would change lengths.
    """
    return f"{AXIS}{direction}"


def car_directions(up: Array, right: Array) -> dict[str, Pair]:
    """Each direction as high and low part, shape (..., 3); forward is up x right, to twice the precision."""
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


def direction_of(car: Mapping[str, Pair], name: str) -> Pair:
    """A direction of the car, or the axis along one (see `axis_along`)."""
    return car[name] if name in car else unit_pair(car[name.removeprefix(AXIS)])


def unit_pair(vector: Pair) -> Pair:
    """A vector divided by its length, (..., 3), to twice the precision."""
    high, low = pair_root(pair_dot(vector, vector))
    return pair_quotient(vector, (high[..., None], low[..., None]))
