"""The result of a solved motion: plain arrays by name, one row per instant."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from absolute.vectors import Array, Counts


@dataclass(frozen=True)
class Solution:
    """Motion of every point and body at N instants; all arrays are read-only.

    Attributes:
        position: point name -> (N, 3), mm, world axes; chassis, moving and carried points.
        velocity: point name -> (N, 3), mm/s; empty if rates were not requested.
        acceleration: point name -> (N, 3), mm/s^2; empty if rates were not requested.
        higher: jerk and higher rates of points, each point name -> (N, 3), mm/s^3, mm/s^4 and so on, up to
            the order of the given inputs.
        angular_velocity: moving body name -> (N, 3), rad/s, world axes; empty without rates.
        angular_acceleration: moving body name -> (N, 3), rad/s^2, world axes; empty without rates.
        iterations: (N,) Newton corrections at each instant, from its prediction.
        residual: (N,) largest violation of a row, mm (rows of directions: times the mechanism's size).
        condition: (N,) condition number of the scaled Jacobian (1-norm).
        accuracy: (N,) mm: the rows hold exactly for points within this distance of the given ones: residual
            plus rounding of coordinates as large as the mechanism. Its effect depends on the pose.
        effects: name -> (N,), the requested ones, in their units (see `EFFECTS`).
        rod_force: name of a rod, or `damper` with its part in front -> (N,) axial force, N, tension positive;
            empty if loads were not requested.
        joint_force: point of a ball joint, a hinge (only across its line) or a slide -> (N, 3), N, world
            axes: the force on the body that `Model.reported_joints` names; empty without loads.
        hinge_thrust: first point of a hinge -> (N,), N: on the same body, the sum of both forces along the
            line to the second point.
    """

    position: Mapping[str, Array]
    velocity: Mapping[str, Array]
    acceleration: Mapping[str, Array]
    higher: tuple[Mapping[str, Array], ...]
    angular_velocity: Mapping[str, Array]
    angular_acceleration: Mapping[str, Array]
    iterations: Counts
    residual: Array
    condition: Array
    accuracy: Array
    effects: Mapping[str, Array]
    rod_force: Mapping[str, Array] = field(default_factory=dict)
    joint_force: Mapping[str, Array] = field(default_factory=dict)
    hinge_thrust: Mapping[str, Array] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for of in (*vars(self).values(), *self.higher):
            for array in of.values() if isinstance(of, dict) else (of,):
                if isinstance(array, np.ndarray):
                    array.setflags(write=False)

    @property
    def derivatives(self) -> tuple[Mapping[str, Array], ...]:
        """The points' positions and rates, by order of the derivative."""
        return self.position, self.velocity, self.acceleration, *self.higher
