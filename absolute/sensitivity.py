"""How the equations of the rates change with the pose, and with the velocities in them.

First and second rate of a row a . e are (see `stack`)
    a1.e + a.e1,    a2.e + 2 a1.e1 + a.e2.
A displacement of the pose turns a, r1, r2 with their bodies and moves the origins, at fixed s and w; what
e changes by, counts with a1 and a2, of whatever kind a row is. The direction a of a distance does not turn
with its first body. Each derivative is again one vector per body of a row.
"""

import numpy as np

from absolute.solution import Array
from absolute.stack import RowMotion, RowStack
from absolute.vectors import cross


def rate_by_pose(stack: RowStack, m: RowMotion) -> Array:
    """(..., rows, 6 * moving bodies) change of the rows' rates J v per displacement of the pose."""
    turned = cross(m.a, cross(m.e, m.w1) + m.e1)
    moved = cross(m.r1, m.a1 + cross(m.a, m.w1))
    second = cross(m.r2, m.a1 + cross(m.a, m.w2))
    return _matrix(stack, m.a1, turned, moved, second)


def drift_by_pose(stack: RowStack, m: RowMotion) -> Array:
    """(..., rows, 6 * moving bodies) change of the drift per displacement of the pose."""
    turned = cross(m.a, cross(m.w1, cross(m.w1, m.e)) + 2.0 * cross(m.e1, m.w1) + m.e2)
    moved, second = (
        cross(r, m.a2 + 2.0 * cross(m.a1, w) + cross(w, cross(w, m.a)))
        for r, w in ((m.r1, m.w1), (m.r2, m.w2))
    )
    return _matrix(stack, m.a2, turned, moved, second)


def drift_by_velocity(stack: RowStack, m: RowMotion) -> Array:
    """(..., rows, 6 * moving bodies) change of the drift per change of the velocities."""
    turned = cross(m.a1, m.e) + cross(m.a, cross(m.e, m.w1) + 2.0 * m.e1)
    moved, second = (
        cross(r, 2.0 * m.a1 + cross(m.a, w)) + cross(cross(w, r), m.a)
        for r, w in ((m.r1, m.w1), (m.r2, m.w2))
    )
    return _matrix(stack, 2.0 * m.a1, turned, moved, second)


def _matrix(stack: RowStack, along: Array, turned: Array, moved: Array, second: Array) -> Array:
    """Vectors per body: of the first what a turns by, less what e moves by; of the second what e moves by."""
    turned[..., stack.distances, :] = 0.0
    lead = along.shape[:-2]
    turning = np.stack((turned - moved, second), -3).reshape(*lead, -1)
    return stack.matrix(along[..., stack.offset_rows, :].reshape(*lead, -1), turning)
