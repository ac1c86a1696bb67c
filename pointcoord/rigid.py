r"""Rigid bodies seen through their points: carried points and rates of rotation.

The rates of a body come from all its points by least squares. With r_i from the points' centroid,

    J omega = sum r_i x v_i,    J alpha = sum r_i x (a_i - omega x (omega x r_i)),
    J = sum (|r_i|^2 I - r_i r_i^T),

and J is the inertia tensor of unit masses at the points: regular unless the points are in one line.
The paper's quotient v65 x v75 / (v65 . r75) is 0/0 whenever omega lies in the points' plane.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from pointcoord.errors import SingularConfiguration
from pointcoord.series import cross_series

Array = NDArray[np.float64]

EPS = float(np.finfo(float).eps)


def carried_series(weights: Array, base: Array, first: Array, second: Array) -> Array:
    """Series of a point that rides on three others: p = p_0 + a e1 + b e2 + c e1 x e2.

    Args:
        weights: (a, b, c), shape (..., 3).
        base, first, second: series of the carriers, shape (..., order + 1, 3).
    """
    e1, e2 = first - base, second - base
    a, b, c = (weights[..., i, None, None] for i in range(3))
    return np.asarray(base + a * e1 + b * e2 + c * cross_series(e1, e2))


def angular_velocity(position: Array, velocity: Array) -> Array:
    """Angular velocity of a body from its points, shapes (..., points, 3) to (..., 3), rad/s.

    Raises:
        SingularConfiguration: the points are in one line; the turn about it is free.
    """
    r, v = _about_centroid(position), _about_centroid(velocity)
    return _solve_inertia(r, np.cross(r, v).sum(axis=-2))


def angular_acceleration(position: Array, acceleration: Array, omega: Array) -> Array:
    """Angular acceleration of a body, shapes (..., points, 3) and (..., 3) to (..., 3), rad/s^2.

    Raises:
        SingularConfiguration: the points are in one line; the turn about it is free.
    """
    r, a = _about_centroid(position), _about_centroid(acceleration)
    spin = omega[..., None, :]
    tangential = a - np.cross(spin, np.cross(spin, r))
    return _solve_inertia(r, np.cross(r, tangential).sum(axis=-2))


def _about_centroid(vectors: Array) -> Array:
    return np.asarray(vectors - vectors.mean(axis=-2, keepdims=True))


def _solve_inertia(r: Array, moment: Array) -> Array:
    square = np.sum(r * r, axis=(-2, -1))
    inertia = square[..., None, None] * np.eye(3) - np.swapaxes(r, -2, -1) @ r
    values = np.linalg.eigvalsh(inertia)
    condition = np.divide(
        values[..., 2], values[..., 0], out=np.full(square.shape, np.inf), where=values[..., 0] > 0
    )
    if not (condition * 8 * EPS < 1.0).all():
        raise SingularConfiguration(
            "the points of a body are in one line, so its turn about that line is free",
            float(np.max(condition)),
        )
    return np.asarray(np.linalg.solve(inertia, moment[..., None])[..., 0])


def stack_points(points: Sequence[Array]) -> Array:
    """Points of shape (..., 3) as one array (..., points, 3)."""
    return np.stack(np.broadcast_arrays(*points), axis=-2)
