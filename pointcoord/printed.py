r"""The paper's formulas exactly as printed, so that a reader can see which of them fail.

Used with the constraint rows of `constraints.PrintedParallel`. Two formulas differ from ours:

- eq. (23): the rows (8)-(11) lack the factor 2 of a product's second derivative, and row (11) repeats
  row (9), with the points 7, 5 where 7, 4 belong.
- omega = v65 x v75 / (v65 . r75) and alpha = a^65 x a^75 / (a^65 . r75), a^ = a - omega x (omega x r),
  which are 0/0 whenever omega (or alpha) lies in the plane of the points 5, 6, 7.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.quadratic import QuadraticMap
from pointcoord.solve.pointwise import square_velocity_term
from pointcoord.suspensions.macpherson import PRINTED

Array = NDArray[np.float64]

# A quotient that loses more than two digits is at fault itself, and not its rounding.
MOST_LOST = 100.0

_PARALLEL = [i for i, label in enumerate(PRINTED.labels) if "parallel" in label]


def printed_square_velocity_term(system: QuadraticMap, velocity: Array) -> Array:
    """Eq. (23) as printed, shape (..., rows)."""
    term = square_velocity_term(system, velocity)
    row_8, row_9, row_10, row_11 = _PARALLEL
    term[..., [row_8, row_9, row_10]] *= 0.5
    term[..., row_11] = term[..., row_9]
    return term


def printed_body_rates(
    position: Mapping[str, Array], velocity: Mapping[str, Array], acceleration: Mapping[str, Array]
) -> tuple[Array, Array]:
    """The printed quotients for omega and alpha; not finite where their denominator is zero.

    Args:
        position, velocity, acceleration: of the points 5, 6, 7 in this order, shape (..., 3).
    """
    r_65, r_75 = _from_first(position)
    v_65, v_75 = _from_first(velocity)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        omega = _quotient(v_65, v_75, r_75)
        hat_65, hat_75 = (
            a - np.cross(omega, np.cross(omega, r))
            for a, r in zip(_from_first(acceleration), (r_65, r_75), strict=True)
        )
        return omega, _quotient(hat_65, hat_75, r_75)


def printed_body_loss(edges: tuple[Array, Array], rates: tuple[Array, Array]) -> Array:
    """How many times what least squares loses the quotient may lose, shape (..., 1), at most MOST_LOST.

    A product of vectors a x b or a . r is off by about |a| |b| times their relative error, so the quotient
    loses |a| |b| / |a x b| and |a| |r| / |a . r| times as much as its factors are off.
    """
    a, b, r = *rates, edges[1]
    length = np.linalg.norm(a, axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        above = length * np.linalg.norm(b, axis=-1) / np.linalg.norm(np.cross(a, b), axis=-1)
        below = length * np.linalg.norm(r, axis=-1) / np.abs(np.sum(a * r, axis=-1))
        return np.asarray(np.fmin(above + 2.0 * below, MOST_LOST)[..., None])


def _from_first(states: Mapping[str, Array]) -> tuple[Array, Array]:
    first, second, third = states.values()
    return second - first, third - first


def _quotient(a: Array, b: Array, r: Array) -> Array:
    return np.asarray(np.cross(a, b) / np.sum(a * r, axis=-1, keepdims=True))
