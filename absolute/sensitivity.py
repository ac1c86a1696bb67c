"""How the equations of the rates change with the pose, and with the velocities in them.

With the rows a . e, e = f - g (see `stack`), w1, w2 the angular velocities of their bodies, s1, s2 the
velocities of their origins, r1, r2 the arms of their points:
    rate    a'.e + a.e'             a' = w1 x a,   e' = s2 + w2 x r2 - s1 - w1 x r1
    drift   a''.e + 2 a'.e' + a.e'' a'' = w1 x a', e'' = w2 x (w2 x r2) - w1 x (w1 x r1)
A displacement of the pose turns a, r1, r2 with their bodies and moves the origins, at fixed s and w.
Each derivative is again one vector per body of a row; those of r1 drop out of it.
"""

from typing import NamedTuple

import numpy as np

from absolute.solution import Array
from absolute.stack import Placed, RowStack
from absolute.vectors import cross


class RowMotion(NamedTuple):
    """Vectors of every row at given rates of the bodies, each (..., rows, 3).

    Attributes:
        a, e, r1, r2: as above; r1 is zero and r2 the partner direction where the row is an angle.
        w1, w2, s1, s2: rates of both bodies; s1 and s2 are zero where the row is an angle.
        a1, e1: a' and e'.
    """

    a: Array
    e: Array
    r1: Array
    r2: Array
    w1: Array
    w2: Array
    s1: Array
    s2: Array
    a1: Array
    e1: Array


def row_motion(stack: RowStack, placed: Placed, rates: Array) -> RowMotion:
    """Rows at rates [o', w] of all bodies, (..., bodies, 2, 3)."""
    a, e, r2 = placed.parts[..., 0, :, :], placed.reach, placed.parts[..., 4, :, :]
    r1 = placed.parts[..., 3, :, :] - e
    first, second = rates.take(stack.first, -3), rates.take(stack.second, -3)
    s1, s2 = np.zeros_like(a), np.zeros_like(a)
    s1[..., stack.offset_rows, :] = first[..., stack.offset_rows, 0, :]
    s2[..., stack.offset_rows, :] = second[..., stack.offset_rows, 0, :]
    w1, w2 = first[..., 1, :], second[..., 1, :]
    return RowMotion(a, e, r1, r2, w1, w2, s1, s2, cross(w1, a), s2 + cross(w2, r2) - s1 - cross(w1, r1))


def rate_by_pose(stack: RowStack, m: RowMotion) -> Array:
    """(..., rows, 6 * moving bodies) change of the rows' rates J v per displacement of the pose."""
    first = cross(m.a, cross(m.e, m.w1) + m.e1)
    second = cross(m.r2, cross(m.w1 - m.w2, m.a))
    return _matrix(stack, m.a1, first, second)


def drift_by_pose(stack: RowStack, m: RowMotion) -> Array:
    """(..., rows, 6 * moving bodies) change of the drift per displacement of the pose."""
    a2 = cross(m.w1, m.a1)
    e2 = cross(m.w2, cross(m.w2, m.r2)) - cross(m.w1, cross(m.w1, m.r1))
    first = cross(m.a, cross(m.w1, cross(m.w1, m.e)) + 2.0 * cross(m.e1, m.w1) + e2)
    second = cross(m.r2, a2 + 2.0 * cross(m.a1, m.w2) + cross(m.w2, cross(m.w2, m.a)))
    return _matrix(stack, a2, first, second)


def drift_by_velocity(stack: RowStack, m: RowMotion) -> Array:
    """(..., rows, 6 * moving bodies) change of the drift per change of the velocities."""
    first = (
        cross(m.a1, m.e) + cross(m.a, cross(m.e, m.w1) + 2.0 * m.e1 + cross(m.w1, m.r1)) - cross(m.r1, m.a1)
    )
    second = cross(m.r2, 2.0 * m.a1 + cross(m.a, m.w2)) + cross(cross(m.w2, m.r2), m.a)
    return _matrix(stack, 2.0 * m.a1, first, second)


def _matrix(stack: RowStack, along: Array, first: Array, second: Array) -> Array:
    lead = along.shape[:-2]
    turning = np.stack((first, second), -3).reshape(*lead, -1)
    return stack.matrix(along[..., stack.offset_rows, :].reshape(*lead, -1), turning)
