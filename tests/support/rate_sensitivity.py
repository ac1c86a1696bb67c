"""How a displaced pose changes the rates that are solved for there."""

import numpy as np
from numpy.typing import NDArray

from pointcoord import Motion
from pointcoord.numerics.linear import factorise

Array = NDArray[np.float64]


def rate_sensitivities(motion: Motion) -> tuple[Array, Array]:
    """Largest change of a velocity, 1/s, and of an acceleration at given velocities, 1/s^2, each (N,).

    C_u v = ... with C_u moved by 2 B(d, .), |d_i| <= 1, moves v by max_i (|C_u^-1| sum_j |2 B(e_j, v)|)_i at
    most, and 2 B(e_j, v) are the columns of the Jacobian at v.
    """
    mechanism = motion.solved.readout.mechanism
    y, velocity, acceleration = motion.solved.coordinates(motion.times, 2)
    inverse = np.abs(factorise(mechanism.map.jacobian(y)).preconditioner)

    def change(rate: Array) -> Array:
        rows = np.abs(mechanism.map.jacobian(rate)).sum(axis=-1)
        return np.asarray((inverse @ rows[..., None])[..., 0].max(axis=-1))

    return change(velocity), change(acceleration)
