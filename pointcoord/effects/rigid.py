r"""Rigid bodies seen through their points: rates of rotation.

The rates of a body come from all its points by least squares. With r_i from the points' centroid,

    J omega = sum r_i x v_i,    J alpha = sum r_i x (a_i - omega x (omega x r_i)),
    J = sum (|r_i|^2 I - r_i r_i^T),

and J is the inertia tensor of unit masses at the points: regular unless the points are in one line. Of a thin
triangle J has the square of the condition number that the problem has, so each solution is refined with its
own residual, the velocities that it does not explain: J d = sum r_i x (v_i - omega x r_i), omega + d.
The paper's quotient v65 x v75 / (v65 . r75) is 0/0 whenever omega lies in the points' plane.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from pointcoord.errors import SingularConfiguration
from pointcoord.numerics.rounding import EPS
from pointcoord.numerics.vectors import LAST, NEXT, axes_first_cross

Array = NDArray[np.float64]

# Each multiplies what is left of the first solution's rounding by eps cond(J): some 1e-3 of a needle 1e-6 as
# thick as long, where after one refinement the rounding was still seen.
MOST_REFINEMENTS = 2
# Of eps cond(J), up to which one is enough: its square is then a thousandth of a rounding.
ROUGH = (1e-3 * EPS) ** 0.5


def body_rates(position: Array, velocity: Array, acceleration: Array) -> tuple[Array, Array]:
    """Angular velocity and acceleration of a body from its points.

    Args:
        position, velocity, acceleration: shape (..., points, 3); lengths in any unit. Quickest as
            `stack_points` lays them out.
    Returns:
        omega, rad/s, and alpha, rad/s^2, each of shape (..., 3).
    Raises:
        SingularConfiguration: the points are in one line; the turn about it is free.
    """
    r, v, a = (_about_centroid(vectors) for vectors in (position, velocity, acceleration))
    # A power of two near the body's size, so that no product of lengths over- or underflows.
    size = np.maximum(r.max(axis=(0, 1)), -r.min(axis=(0, 1)))
    scale = np.ldexp(1.0, -np.frexp(np.where(size > 0.0, size, 1.0))[1])
    for vectors in (r, v, a):
        vectors *= scale
    compliance, condition = _inverse_inertia(r)
    refinements = MOST_REFINEMENTS if (8 * EPS * condition > ROUGH).any() else 1
    omega = _turning(compliance, r, v, refinements)
    # omega x (omega x r) = omega (omega . r) - r |omega|^2. The last term turns nothing, r x r = 0; but left
    # in, it is what the moments are rounded from, and refining would not help.
    a -= omega[:, None] * (r * omega[:, None]).sum(axis=0)
    a += r * (omega * omega).sum(axis=0)
    alpha = _turning(compliance, r, a, refinements)
    return np.moveaxis(omega, 0, -1), np.moveaxis(alpha, 0, -1)


def stack_points(points: Sequence[Array]) -> Array:
    """Points of shape (..., 3) as one array (..., points, 3), each component of each contiguous in memory."""
    shape = np.broadcast_shapes(*(point.shape for point in points))
    stacked = np.moveaxis(np.empty((3, len(points), *shape[:-1])), (0, 1), (-1, -2))
    for i, point in enumerate(points):
        stacked[..., i, :] = point
    return stacked


def _about_centroid(vectors: Array) -> Array:
    """Vectors of points, shape (..., points, 3), less their mean; as components (3, points, ...)."""
    components = np.moveaxis(vectors, (-1, -2), (0, 1))
    mean = np.add.reduce(components, axis=1, keepdims=True)
    mean /= components.shape[1]
    return np.asarray(components - mean)


def _turning(compliance: tuple[Array, ...], r: Array, v: Array, refinements: int) -> Array:
    """The least squares solution of v = omega x r, refined; shape (3, ...)."""
    omega = _apply(compliance, _moment(r, v))
    for _ in range(refinements):
        omega += _apply(compliance, _moment(r, v - axes_first_cross(omega[:, None], r)))
    return omega


def _moment(r: Array, f: Array) -> Array:
    """sum r x f over points, shapes (3, points, ...) to (3, ...)."""
    return np.asarray(np.add.reduce(axes_first_cross(r, f), axis=1))


def _inverse_inertia(r: Array) -> tuple[tuple[Array, ...], Array]:
    """The six different elements of J^-1, from cofactors: xx, yy, zz, yz, xz, xy; and the condition number.

    Each of shape (...).
    """
    xx, yy, zz = np.add.reduce(r * r, axis=1)
    f, e, d = -np.add.reduce(r[NEXT] * r[LAST], axis=1)
    a, b, c = yy + zz, xx + zz, xx + yy
    cofactors = (b * c - f * f, a * c - e * e, a * b - d * d, d * e - a * f, d * f - b * e, e * f - c * d)
    determinant = a * cofactors[0] + d * cofactors[5] + e * cofactors[4]
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        elements = tuple(cofactor / determinant for cofactor in cofactors)
        # Largest eigenvalue <= trace, of J and of its inverse, which are positive definite.
        condition = (a + b + c) * (elements[0] + elements[1] + elements[2])
    if not ((condition > 0.0) & (condition * 8 * EPS < 1.0)).all():
        raise SingularConfiguration(
            "the points of a body are in one line, so its turn about that line is free",
            float(np.max(np.abs(condition))),
        )
    return elements, condition


def _apply(elements: tuple[Array, ...], vector: Array) -> Array:
    xx, yy, zz, yz, xz, xy = elements
    x, y, z = vector
    return np.stack([xx * x + xy * y + xz * z, xy * x + yy * y + yz * z, xz * x + yz * y + zz * z])
