r"""A proof that an assembly lies near a computed pose, and how near.

Because C is quadratic, C_u changes linearly and its Lipschitz constant is known exactly, so Newton and
Kantorovich's theorem can be checked with numbers. With X close to C_u(y)^-1, the map T(x) = x - X C(x)
takes the ball of radius r about u into itself and contracts there if

    eta + z r + omega r^2 / 2 <= r   and   z + omega r < 1,

    eta   >= |X C(y)|               the remaining step,
    z     >= |I - X C_u(y)|         the defect of the inverse,
    omega  = Lipschitz constant of X C_u,

in the maximum norm over the unknowns. Then exactly one assembly lies in the ball; the smallest such r
is the error bound.

Floating point: eta and z are inflated by bounds of their own rounding (gamma_n of Higham's book, and
`QuadraticMap.uncertainty`, which also covers the rounding of the known coordinates), so that r holds
for the numbers that the user gave. Not covered: the rounding of the bound's own last operations, made
up for by a factor of 1 + 1e-6; it is evaluated in ordinary rounding, not in interval arithmetic.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pointcoord.linear import EPS, Factors
from pointcoord.quadratic import QuadraticMap

Array = NDArray[np.float64]

INFLATION = 1.0 + 1e-6


@dataclass(frozen=True)
class Certificate:
    """Error bound of each pose of a batch; lengths in the units of y.

    Attributes:
        radius: exactly one assembly lies within it; infinite where nothing could be proven.
        unique_within: no other assembly lies within this distance.
        newton_constant: h = 2 omega eta / (1 - z)^2, proven where it is at most 1.
    """

    radius: Array
    unique_within: Array
    newton_constant: Array


def certify(system: QuadraticMap, y: Array, factors: Factors, data: Array) -> Certificate:
    """Bound the distance from y to the assembly near it.

    Args:
        y: computed coordinates, shape (..., size).
        factors: factorisation of C_u at or very near y.
        data: uncertainty of each known coordinate, shape (..., size).
    """
    n = system.unknowns
    inverse = factors.preconditioner
    magnitude = np.abs(inverse)
    matrix = system.jacobian(y)
    gamma = (n + 2) * EPS
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
        residual = system.residual(y)
        doubt = system.uncertainty(y, data) + gamma * np.abs(residual)
        eta = (np.abs(inverse @ residual[..., None]) + magnitude @ doubt[..., None])[..., 0].max(axis=-1)
        defect = np.abs(np.eye(n) - inverse @ matrix) + gamma * (magnitude @ np.abs(matrix))
        z = defect.sum(axis=-1).max(axis=-1)
        omega = system.lipschitz(inverse, np.ones((*y.shape[:-1], n)))
        room = 1.0 - z
        constant = 2.0 * omega * eta / room**2
        root = np.sqrt(np.maximum(1.0 - constant, 0.0))
        radius = INFLATION * 2.0 * eta / (room * (1.0 + root))
        outer = room * (1.0 + root) / omega / INFLATION
        proven = (room > 0.0) & (constant < 1.0) & np.isfinite(radius)
    return Certificate(
        radius=np.where(proven, radius, np.inf),
        unique_within=np.where(proven, outer, 0.0),
        newton_constant=np.where(room > 0.0, constant, np.inf),
    )
