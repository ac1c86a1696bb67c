r"""Ends of series of many members, a member a column: solved by Newton's method, and held to what they end.

An end is confirmed where the first step is far smaller than the distance within which an assembly is alone,
the orientation is that of where the series begins (see `branch`), and what is left is proven to be small,
block by block (see `block_proof`).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pointcoord.data_classes import dataclass
from pointcoord.numerics.batch_last.elimination import Eliminated
from pointcoord.numerics.branch import NEAR
from pointcoord.solve.paths_together import Columns, Off
from pointcoord.solve.taylor import SOLVED

Array = NDArray[np.float64]

# Steps of Newton's method at an end, at most.
NEWTON = 4


@dataclass(frozen=True)
class Confirmed:
    """Ends of series.

    Attributes:
        good: who is confirmed. y: coordinates, shape (size, members). left: proven distance to the exact
        assembly, rounding apart; first_step: the largest component of Newton's first, (members,).
        steps: how many Newton's method took.
    """

    good: NDArray[np.bool_]
    y: Array
    left: Array
    first_step: Array
    steps: int


def confirm(columns: Columns, y: Array, begun: Eliminated, left_out: Array, tolerance: float) -> Confirmed:
    """Solve the ends of series.

    Args:
        y: what the series give there, with the known coordinates as they are, shape (size, members).
        begun: factors where the series begin. left_out: at most by these at the end, (members,).
        tolerance: that a chain is cut by; what is left is held to a share of it.
    """
    rows, proof, n = columns.map, columns.proof, columns.map.unknowns
    members, steps = y.shape[-1], 0
    good = np.ones(members, dtype=bool)
    left, first_step = np.full(members, np.inf), np.zeros(members)
    with np.errstate(all="ignore"):
        for number in range(NEWTON):
            d = rows.differences(y)
            factors = columns.factorise(d)
            step = columns.step(factors, d)
            size = np.abs(step).max(axis=0)
            y[:n] += step
            good &= factors.sound & (factors.orientation == begun.orientation)
            inverse = factors.inverse()
            np.abs(inverse, out=inverse)
            omega = proof.lipschitz(inverse)
            if number == 0:
                first_step = size
                alone = (omega * (first_step + left_out)).max(axis=0) / columns.least
                good &= alone <= 2.0 * NEAR
            off = Off(columns, proof.turning_of_all(inverse), size)
            jacobian = np.abs(rows.jacobian(rows.differences(y)))
            radius, _ = proof.radii(inverse, omega, off.missed(0.0), off.turns, jacobian)
            left = radius.max(axis=0)
            steps += 1
            if (left <= SOLVED * tolerance)[good].all() or not good.any():
                break
    good &= left <= SOLVED * tolerance
    return Confirmed(good, y, left, first_step, steps)


def noise(columns: Columns, y: Array, data: Array) -> Array:
    """Rounding of Newton's step, shape (members,).

    Args:
        y: shape (size, members). data: how uncertain each coordinate is, shape (size,) or (members, size).
    """
    system, here = columns.map.system, np.ascontiguousarray(y.T)
    rows = system.uncertainty(here, data)
    inverse = np.linalg.inv(system.jacobian(here))
    return np.asarray((np.abs(inverse) @ rows[..., None])[..., 0].max(axis=-1))
