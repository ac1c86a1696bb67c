r"""Points that ride on a body, known by three points that carry them, with the edges e1 and e2:

    p = p_0 + a e1 + b e2 + c e1 x e2.

The weights a, b, c come from the drawing (see `constraints.in_body`) and stay; so the point needs no equation
of its own.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from pointcoord.linkage.drawing import Drawing
from pointcoord.numerics.power_series import cross_series
from pointcoord.numerics.vectors import cross

Array = NDArray[np.float64]
Product = Callable[[Array, Array], Array]


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


def carried_place(
    weights: Array, base: Array, first: Array, second: Array, *, product: Product = cross
) -> Array:
    """A carried point, shape (..., 3).

    Args:
        weights: (a, b, c), shape (..., 3).
        base, first, second: places of the carriers, shape (..., 3).
        product: of two vectors.
    """
    e1, e2 = first - base, second - base
    a, b, c = (weights[..., i, None] for i in range(3))
    return np.asarray(base + a * e1 + b * e2 + c * product(e1, e2))


def carried_series(weights: Array, base: Array, first: Array, second: Array) -> Array:
    """Series of a carried point from those of its carriers, each of shape (..., order + 1, 3)."""
    return carried_place(weights[..., None, :], base, first, second, product=cross_series)
