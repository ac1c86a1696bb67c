"""Angles of the wheel and of the steering axis: each that of a direction projected on two axes of the car.

    angle = atan2(direction . sine, direction . cosine)

With n the spin axis outboard, k the steering axis upward, u up, o outboard, f = u x right forward and r = -f:
camber (n . -u, n . o), kingpin (k . -o, k . u), toe (n . f, n . o), caster (k . r, k . u).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Angle:
    """One angle.

    Attributes:
        of: the line that it is of. sine, cosine: names of axes of the car.
    """

    of: Literal["spin", "steering"]
    sine: str
    cosine: str


ANGLES: Mapping[str, Angle] = {
    "camber": Angle("spin", "down", "outboard"),
    "kingpin": Angle("steering", "inboard", "up"),
    "toe": Angle("spin", "forward", "outboard"),
    "caster": Angle("steering", "rearward", "up"),
}


def car_directions(up: Array, right: Array, side: str) -> dict[str, Array]:
    """The car's axes by name, (3,)."""
    outboard = -right if side == "left" else right
    forward = np.cross(up, right)
    return {
        "up": up,
        "down": -up,
        "outboard": outboard,
        "inboard": -outboard,
        "forward": forward,
        "rearward": -forward,
    }
