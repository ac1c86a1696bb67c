r"""A knuckle's pose as eight homogeneous numbers, and what holds it as quadratic forms of them.

A pose is a dual quaternion (e, g) with <e, g> = 0, up to a factor (Study 1891; M. Husty, *An algorithm for
solving the direct kinematics of general Stewart-Gough platforms*, Mechanism and Machine Theory 31, 1996).
With vectors as quaternions without a real part it turns x into e x e* / |e|^2 and then moves it by
2 g e* / |e|^2, so that e = 1, g = 0 is the pose as drawn. Times |e|^2 each way to hold a point of the body is
a quadratic form:

    x at the distance d of y
        (|x|^2 + |y|^2 - d^2) |e|^2 - 2 <y e, e x> + 4 <g, e x> - 4 <y e, g> + 4 |g|^2
    x on a plane, n . place = c
        <n e, e x> + 2 <n e, g> - c |e|^2
    y on a plane of the body, b . (y seen from it) = k
        <e b, y e> - 2 <e b, g> - k |e|^2

and <e, g> = 0 is one more. Solutions with <e, e> = 0 are no poses.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

UNIT = np.eye(4)


def _before(vector: Array) -> Array:
    """The matrix of q -> v q."""
    x, y, z = vector
    return np.array([[0, -x, -y, -z], [x, 0, -z, y], [y, z, 0, -x], [z, -y, x, 0]])


def _after(vector: Array) -> Array:
    """The matrix of q -> q v."""
    x, y, z = vector
    return np.array([[0, -x, -y, -z], [x, 0, z, -y], [y, -z, 0, x], [z, y, -x, 0]])


def _form(turns: Array, both: Array, moves: Array) -> Array:
    """The symmetric matrix of e^T turns e + e^T both g + g^T moves g, (8, 8)."""
    return np.block([[(turns + turns.T) / 2, both / 2], [both.T / 2, moves]])


STUDY = _form(np.zeros((4, 4)), UNIT, np.zeros((4, 4)))
"""<e, g>."""


def at_distance(point: Array, fixed: Array) -> Array:
    """A point of the body keeps its distance from a fixed one."""
    x, y = _after(point), _before(fixed)
    away = point - fixed
    return _form((point @ point + fixed @ fixed - away @ away) * UNIT - 2 * y.T @ x, 4 * (x - y).T, 4 * UNIT)


def on_plane(point: Array, normal: Array) -> Array:
    """A point of the body stays on the plane through it with a fixed normal."""
    n = _before(normal)
    return _form(n.T @ _after(point) - (normal @ point) * UNIT, 2 * n.T, np.zeros((4, 4)))


def on_plane_of_body(fixed: Array, normal: Array) -> Array:
    """A fixed point stays on the plane through it that the body carries, with a normal of the body."""
    b = _after(normal)
    return _form(b.T @ _before(fixed) - (normal @ fixed) * UNIT, -2 * b.T, np.zeros((4, 4)))
