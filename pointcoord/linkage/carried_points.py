r"""Points that ride on a body, known by three points that carry them, with the edges e1 and e2:

    p = p_0 + a e1 + b e2 + c e1 x e2.

The weights a, b, c come from the drawing and stay; so the point needs no equation of its own.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pointcoord.errors import MechanismError
from pointcoord.linkage.drawing import Drawing
from pointcoord.numerics.power_series import cross_series
from pointcoord.numerics.rounding import EPS
from pointcoord.numerics.vectors import cross, lengths

Array = NDArray[np.float64]


def carrier_weights(name: str, drawing: Drawing, carriers: tuple[str, str, str]) -> Array:
    """(a, b, c) of a drawn point, shape (..., 3).

    Raises:
        MechanismError: the carriers lie in one line.
    """
    base, first, second = (drawing.vectors[point] for point in carriers)
    e1, e2 = first - base, second - base
    normal = cross(e1, e2)
    frame = np.stack([np.broadcast_to(edge, normal.shape) for edge in (e1, e2, normal)], axis=-1)
    if not (lengths(normal) > 8 * EPS * lengths(e1) * lengths(e2)).all():
        raise MechanismError(
            f"{', '.join(carriers)} lie in one line, so they cannot carry {name}; move one off the line",
            carriers,
        )
    offset = np.broadcast_to(drawing.vectors[name] - base, frame.shape[:-1])
    return np.asarray(np.linalg.solve(frame, offset[..., None])[..., 0])


def carried_gain(weights: Array, drawing: Drawing, carriers: tuple[str, str, str]) -> float:
    """How many times as far as the coordinates of its carriers those of a carried point may be off, at most.

    |dp| <= |1 - a - b| |dp_0| + |a| |dp_1| + |b| |dp_2| + |c| |d(e1 x e2)|. An edge is off by twice as much
    as its ends, and a component of the cross product by that times the edges' other components. Of a batch it
    is the largest.
    """
    base, first, second = (drawing.vectors[point] for point in carriers)
    sides = np.abs(first - base) + np.abs(second - base)
    others = (sides.sum(axis=-1, keepdims=True) - sides).max(axis=-1)
    a, b, c = (weights[..., i] for i in range(3))
    return float(np.max(np.abs(1.0 - a - b) + np.abs(a) + np.abs(b) + 2.0 * np.abs(c) * others))


def carried_place(weights: Array, base: Array, first: Array, second: Array) -> Array:
    """A carried point, shape (..., 3).

    Args:
        weights: (a, b, c), shape (..., 3).
        base, first, second: places of the carriers, shape (..., 3).
    """
    e1, e2 = first - base, second - base
    a, b, c = (weights[..., i, None] for i in range(3))
    return np.asarray(base + a * e1 + b * e2 + c * cross(e1, e2))


def carried_series(weights: Array, base: Array, first: Array, second: Array) -> Array:
    """Series of a carried point, shape (..., order + 1, 3).

    Args:
        weights: (a, b, c), shape (..., 3).
        base, first, second: series of the carriers, shape (..., order + 1, 3).
    """
    e1, e2 = first - base, second - base
    a, b, c = (weights[..., i, None, None] for i in range(3))
    return np.asarray(base + a * e1 + b * e2 + c * cross_series(e1, e2))
