"""What a solved motion holds: plain arrays by name, one row per instant."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Counts = NDArray[np.int64]


@dataclass(frozen=True)
class Solution:
    """Motion of every point and body at N instants; all arrays are read-only.

    Attributes:
        position: point name -> (N, 3), mm, world axes; chassis, moving and carried points.
        velocity: point name -> (N, 3), mm/s; empty when no rates were asked for.
        acceleration: point name -> (N, 3), mm/s^2; empty when no rates were asked for.
        angular_velocity: moving body name -> (N, 3), rad/s, world axes; empty without rates.
        angular_acceleration: moving body name -> (N, 3), rad/s^2, world axes; empty without rates.
        iterations: (N,) Newton corrections spent on the way to each instant.
        residual: (N,) largest violation of any row, mm (rows of directions times the size of the
            mechanism).
        condition: (N,) 2-norm condition number of the scaled Jacobian, or None if not asked for. Of long
            motions with errors some per cent larger at most, and no smaller (see `sampled_estimate`).
        position_error, velocity_error, acceleration_error: point name -> (N, 3): how far each component
            may be from the motion of the drawing given, for rounding and for what `input_errors` say;
            infinite where rounding alone reaches a dead point. Empty if not asked for; those of rates
            empty without rates.
        angular_velocity_error, angular_acceleration_error: moving body name -> (N, 3), likewise.
        rotation_error: moving body name -> (N, 3), rad: how far each body may be turned about each axis.
        effects: name -> (N,), those asked for, in their units (see `EFFECTS`).
        effect_errors: name -> (N,) how far each may be off, likewise; empty if errors were not asked for.
    """

    position: Mapping[str, Array]
    velocity: Mapping[str, Array]
    acceleration: Mapping[str, Array]
    angular_velocity: Mapping[str, Array]
    angular_acceleration: Mapping[str, Array]
    iterations: Counts
    residual: Array
    condition: Array | None
    position_error: Mapping[str, Array]
    velocity_error: Mapping[str, Array]
    acceleration_error: Mapping[str, Array]
    rotation_error: Mapping[str, Array]
    angular_velocity_error: Mapping[str, Array]
    angular_acceleration_error: Mapping[str, Array]
    effects: Mapping[str, Array]
    effect_errors: Mapping[str, Array]
