r"""Rigid bodies seen through their points: rates of rotation.

The rates of a body come from all its points by least squares. With r_i from the points' centroid,

    J omega = sum r_i x v_i,    J alpha = sum r_i x (a_i - omega x (omega x r_i)),
    J = sum (|r_i|^2 I - r_i r_i^T),

and J is the inertia tensor of unit masses at the points: regular unless the points are in one line. Of a thin
triangle J has the square of the condition number that the problem has, so each solution is refined twice with
its own residual, the velocities that it does not explain: J d = sum r_i x (v_i - omega x r_i), omega + d.
The paper's quotient v65 x v75 / (v65 . r75) is 0/0 whenever omega lies in the points' plane.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from pointcoord.errors import SingularConfiguration
from pointcoord.numerics.rounding import EPS

Array = NDArray[np.float64]

# Each multiplies what is left of the first solution's rounding by eps cond(J): some 1e-3 of a needle 1e-6 as
# thick as long, where after one refinement the rounding was still seen.
REFINEMENTS = 2


def body_rates(position: Array, velocity: Array, acceleration: Array) -> tuple[Array, Array]:
    """Angular velocity and acceleration of a body from its points.

    Args:
        position, velocity, acceleration: shape (..., points, 3); lengths in any unit.
    Returns:
        omega, rad/s, and alpha, rad/s^2, each of shape (..., 3).
    Raises:
        SingularConfiguration: the points are in one line; the turn about it is free.
    """
    r, v, a = (about_centroid(vectors) for vectors in (position, velocity, acceleration))
    # A power of two near the body's size, so that no product of lengths over- or underflows.
    size = np.abs(r).max(axis=(-2, -1), keepdims=True)
    scale = np.ldexp(1.0, -np.frexp(np.where(size > 0.0, size, 1.0))[1])
    r, v, a = r * scale, v * scale, a * scale
    compliance = _inverse_inertia(r)
    omega = _turning(compliance, r, v)
    # omega x (omega x r) = omega (omega . r) - r |omega|^2, and r x r = 0.
    pull = omega[..., None, :] * np.sum(r * omega[..., None, :], axis=-1, keepdims=True)
    return omega, _turning(compliance, r, a - pull)


def _turning(compliance: tuple[Array, ...], r: Array, v: Array) -> Array:
    """The least squares solution of v = omega x r, refined."""
    omega = _apply(compliance, _moment(r, v))
    for _ in range(REFINEMENTS):
        rest = v - np.cross(omega[..., None, :], r)
        omega = omega + _apply(compliance, _moment(r, rest))
    return omega


def about_centroid(vectors: Array) -> Array:
    """Vectors of points, shape (..., points, 3), less their mean."""
    return np.asarray(vectors - vectors.mean(axis=-2, keepdims=True))


def _moment(r: Array, f: Array) -> Array:
    """sum r x f over points, shapes (..., points, 3) to (..., 3)."""
    rx, ry, rz = np.moveaxis(r, -1, 0)
    fx, fy, fz = np.moveaxis(f, -1, 0)
    parts = (ry * fz - rz * fy, rz * fx - rx * fz, rx * fy - ry * fx)
    return np.stack([part.sum(axis=-1) for part in parts], axis=-1)


def _inverse_inertia(r: Array) -> tuple[Array, ...]:
    """The six different elements of J^-1, from cofactors: xx, yy, zz, yz, xz, xy; each of shape (...)."""
    x, y, z = np.moveaxis(r, -1, 0)
    xx, yy, zz = ((c * c).sum(axis=-1) for c in (x, y, z))
    f, e, d = -(y * z).sum(axis=-1), -(x * z).sum(axis=-1), -(x * y).sum(axis=-1)
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
    return elements


def _apply(elements: tuple[Array, ...], vector: Array) -> Array:
    xx, yy, zz, yz, xz, xy = elements
    x, y, z = np.moveaxis(vector, -1, 0)
    return np.stack([xx * x + xy * y + xz * z, xy * x + yy * y + yz * z, xz * x + yz * y + zz * z], axis=-1)


def stack_points(points: Sequence[Array]) -> Array:
    """Points of shape (..., 3) as one array (..., points, 3)."""
    return np.stack(np.broadcast_arrays(*points), axis=-2)
