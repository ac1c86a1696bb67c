r"""Whether a step of a series ended on the branch that it started on.

Two branches meet in a fold, where det C_u changes its sign, so the sign tells neighbours apart: a series
that is too coarse to see a fold just ahead runs smoothly across it, and only the sign shows it. And with
X = C_u^-1 at the end and omega the Lipschitz constant of X C_u, no other assembly lies within 2 / omega of
the end: what the series left out and Newton's correction together must stay far below that.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.linear import Factors
from pointcoord.numerics.newton import Converged
from pointcoord.numerics.quadratic import QuadraticMap

Array = NDArray[np.float64]

# Share of the distance within which an assembly is alone that may lie between it and the series.
NEAR = 0.25


def orientation(factors: Factors) -> Array:
    """Sign of det C_u, shape (...,); its rows are scaled by positive numbers, which does not change it."""
    return factors.orientation


def on_branch(
    system: QuadraticMap, side: Array, series: Array, s: float, reached: Converged, factors: Factors
) -> NDArray[np.bool_]:
    """Whether a series leads to this end and not to another assembly, shape (...,).

    Args:
        side: orientation at the start, shape (...,).
        series: coefficients, shape (..., order + 1, size). s: its parameter at the end.
        reached: the end, as Newton's method found it from the series. factors: of C_u there.
    """
    last, order = np.abs(series[..., -2:, :]), series.shape[-2] - 1
    left_out = (last[..., 0, :] * s ** (order - 1) + last[..., 1, :] * s**order).max(axis=-1)
    omega = reached.lipschitz_with(system, factors)
    alone = omega * (reached.first_step + left_out) <= 2.0 * NEAR
    return np.asarray(alone & (orientation(factors) == side))
