r"""Whether a step of a series ended on the branch that it started on.

Two branches meet in a fold, where det C_u changes its sign, so the sign tells neighbours apart: a series
that is too coarse to see a fold just ahead runs smoothly across it, and only the sign shows it. C_u is block
triangular (see `structure`), and every block has a sign of its own: where loops that hang on each other all
fold at one pose, as coupled parallelograms do, an even number of them leaves the sign of det C_u as it was.
And with X = C_u^-1 at the end and omega the Lipschitz constant of X C_u, no other assembly lies within
2 / omega of the end: what the series left out and Newton's correction together must stay far below that.
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
# Binary digits that a double keeps of a whole number, and one to spare.
DIGITS = 52


def orientation(system: QuadraticMap, factors: Factors) -> Array:
    """The signs of the diagonal blocks of C_u as one number, shape (...,); NaN where one is singular.

    Rows are scaled by positive numbers, which changes no sign.
    """
    signs = np.empty((*factors.matrix.shape[:-2], len(system.structure.blocks)))
    for one in system.structure.diagonal:
        blocks = factors.matrix[..., one.rows[:, :, None], one.unknowns[:, None, :]]
        single = blocks.shape[-1] == 1
        signs[..., one.numbers] = np.sign(blocks[..., 0, 0]) if single else np.linalg.slogdet(blocks)[0]
    return sides(signs)


def sides(signs: Array) -> Array:
    """Signs, shape (..., blocks), as one number, shape (...,); NaN where one of them is none.

    Of more than 52 blocks, as many as a double has digits, every 52nd ones share a digit.
    """
    digits = np.where(signs < 0.0, 1, 0) << (np.arange(signs.shape[-1]) % DIGITS)
    whole = np.isfinite(signs).all(axis=-1) & (signs != 0.0).all(axis=-1)
    return np.where(whole, np.bitwise_xor.reduce(digits, axis=-1), np.nan)


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
    return np.asarray(alone & (orientation(system, factors) == side))
