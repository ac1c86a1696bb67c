"""What a solved motion holds: plain arrays by name, one row per instant."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from absolute.vectors import Array, Counts


@dataclass(frozen=True)
class Solution:
    """Motion of every point and body at N instants; all arrays are read-only.

    Attributes:
        position: point name -> (N, 3), mm, world axes; chassis, moving and carried points.
        velocity: point name -> (N, 3), mm/s; empty when no rates were asked for.
        acceleration: point name -> (N, 3), mm/s^2; empty when no rates were asked for.
        higher: the jerk and so on of points, each point name -> (N, 3), mm/s^3, mm/s^4: as many as the inputs
            were given with.
        angular_velocity: moving body name -> (N, 3), rad/s, world axes; empty without rates.
        angular_acceleration: moving body name -> (N, 3), rad/s^2, world axes; empty without rates.
        iterations: (N,) Newton corrections at each instant, from where it was predicted.
        residual: (N,) largest violation of any row, mm (rows of directions times the size of the
            mechanism).
        condition: (N,) condition number of the scaled Jacobian (1-norm).
        accuracy: (N,) mm: the rows hold for points within this of those given, so that it is what is left
            of the rows, and what rounds coordinates as large as the mechanism. What it makes of a number
            depends on the pose.
        effects: name -> (N,), those asked for, in their units (see `EFFECTS`).
        rod_force: name of a rod, or `damper` with its part in front -> (N,) axial force, N, tension positive;
            empty when no loads were asked for.
        joint_force: point of a ball joint, of a hinge, there across its line, or of a slide -> (N, 3), N,
            world axes: on the knuckle, or on the other body that moves and is named first, or on a point of
            no body; empty without loads.
        hinge_thrust: first point of a hinge -> (N,), N: likewise, at both along the line to the second.
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

    @property
    def derivatives(self) -> tuple[Mapping[str, Array], ...]:
        """Of points by order, that of order 0 their positions."""
        return self.position, self.velocity, self.acceleration, *self.higher
