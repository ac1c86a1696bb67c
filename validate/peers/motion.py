"""What a peer found: poses of a linkage at driven inputs, and how they change."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Poses:
    """Poses of a linkage, in its unit and from its origin.

    Attributes:
        coordinates: the peer's own, (N, ...).
        places: of every moving point, (N, 3).
        closed: of every moving point where the drawing is closed, (3,).
        last_step: the last correction of Newton's method, rad and car sizes, (N,).
        counts: what was done.
    """

    coordinates: Array
    places: Mapping[str, Array]
    closed: Mapping[str, Array]
    last_step: Array
    counts: Mapping[str, int]


@dataclass(frozen=True)
class Rates:
    """Velocities and accelerations of poses, in the linkage's unit.

    Attributes:
        velocity, acceleration: of every moving point, (N, 3).
        spin, spin_rate: angular velocity and acceleration of the knuckle, (N, 3), in the car's axes.
    """

    velocity: Mapping[str, Array]
    acceleration: Mapping[str, Array]
    spin: Array
    spin_rate: Array
