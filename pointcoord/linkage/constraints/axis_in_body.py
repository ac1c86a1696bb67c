r"""An axis that is fixed in a body, and points on it.

The body is known by three points with the edges e1 and e2 and the normal n = e1 x e2, an unknown of its own.
The axis has a direction d, an unknown too, which keeps its place in the body:

    n - e1 x e2 = 0,      d - a e1 - b e2 - c n = 0,

with constants a, b, c of the drawing. A point on the axis through a point o of the body is p = o + s d. All
rows are quadratic, and they keep their rank as long as the three points are not in one line: wherever the
axis passes, also along an edge of the triangle, where links to a fourth point of the body would lose it.
The length of d is between 1/2 and 1 of the mechanism's size, however close the points that it is drawn by.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pointcoord.errors import MechanismError
from pointcoord.linkage.constraints.constraint import Constraint, no_length, per_axis
from pointcoord.linkage.constraints.normal import Normal
from pointcoord.linkage.drawing import Drawing, Placed
from pointcoord.linkage.layout import Layout, Triple
from pointcoord.numerics.double_double import (
    PAIRS,
    Pair,
    exact_square,
    minus_pair,
    pair_cross,
    pair_product,
    pair_root,
    pair_sum,
    two_sum,
)
from pointcoord.numerics.quadratic import Product, Row
from pointcoord.numerics.rounding import UNIT_ROUNDOFF

Array = NDArray[np.float64]

# A product with the inverse of a 3 x 3 matrix, and that inverse, round some twenty times relative.
SOLVED = 32.0 * UNIT_ROUNDOFF


@dataclass(frozen=True)
class AxisInBody(Constraint):
    r"""An axis drawn from `tail` to `head` that the body of a triangle carries. Three rows.

    d - a (p_first - p_base) - b (p_second - p_base) - c n = 0 with d along p_head - p_tail as drawn; without
    a tail, along the direction of the car that the head names.
    """

    axis: str
    tail: str
    head: str
    normal: Normal

    @property
    def name(self) -> str:
        """The axis' own."""
        return self.axis

    @property
    def labels(self) -> tuple[str, ...]:
        """A row per axis."""
        return per_axis(self.name)

    @property
    def vectors(self) -> tuple[str, ...]:
        """The direction."""
        return (self.axis,)

    @property
    def constants(self) -> tuple[str, ...]:
        """Its place in the body: a, b and c."""
        return weight_names(self.axis, self.normal)

    @property
    def holds_a_body(self) -> bool:
        """It does."""
        return True

    def rows(self, layout: Layout) -> tuple[Row, ...]:
        """Bilinear in the constants and the edges."""
        d, zero = layout.vector(self.axis), layout.zero
        return weighted_rows(layout, (d, (zero, zero, zero)), self.normal, self.constants)

    def placed(self, layout: Layout, drawing: Drawing) -> tuple[Placed, ...]:
        """The drawn direction and its constants, with what they lack by rounding.

        Raises:
            MechanismError: the axis has no direction, or the triangle is flat.
        """
        direction = scaled_axis(drawing, self.tail, self.head)
        places = tuple(layout.scalar(name) for name in self.constants)
        weights = weights_in_body(drawing, direction, self.normal, self.axis)
        return (Placed(layout.vector(self.axis), direction[0]), Placed(places, *weights))


def weight_names(name: str, body: Normal) -> tuple[str, ...]:
    """What the constants a, b and c of a vector in a body are called."""
    return tuple(f"{name} along {part}" for part in (body.first, body.second, body.normal))


def weighted_rows(
    layout: Layout, vector: tuple[Triple, Triple], body: Normal, constants: tuple[str, ...]
) -> tuple[Row, ...]:
    """v - a e1 - b e2 - c n = 0 for the difference v of two vectors; bilinear in the constants and edges."""
    o, p, q, n = (layout.vector(name) for name in (body.base, body.first, body.second, body.normal))
    (end, start), (a, b, c) = vector, (layout.scalar(name) for name in constants)
    zero, one = layout.zero, layout.one
    return tuple(
        (
            Product(1.0, (end[i], start[i]), (one, zero)),
            Product(-1.0, (a, zero), (p[i], o[i])),
            Product(-1.0, (b, zero), (q[i], o[i])),
            Product(-1.0, (c, zero), (n[i], zero)),
        )
        for i in range(3)
    )


def weights_in_body(drawing: Drawing, vector: Pair, body: Normal, what: str) -> tuple[Array, Array, Array]:
    """(a, b, c) of a drawn vector in a body, what they lack by rounding, and their doubt, each (..., 3).

    Raises:
        MechanismError: the body's triangle is flat.
    """
    base, first, second = (drawing.vectors[name] for name in (body.base, body.first, body.second))
    edges = (two_sum(first, -base), two_sum(second, -base))
    columns = (*edges, pair_cross(*edges))
    frame = np.stack(np.broadcast_arrays(*(high for high, _ in columns)), axis=-1)
    lengths = np.linalg.norm(edges[0][0], axis=-1) * np.linalg.norm(edges[1][0], axis=-1)
    area = np.linalg.norm(columns[2][0], axis=-1)
    if not (area > 16 * UNIT_ROUNDOFF * lengths).all():
        names = (body.base, body.first, body.second)
        raise MechanismError(
            f"{', '.join(names)} lie in one line, so they cannot carry the {what}; move one off the line",
            names,
        )
    inverse = np.linalg.inv(frame)
    weights = _applied(inverse, np.broadcast_to(vector[0], frame.shape[:-1]))
    rest, size = _unexplained(vector, columns, weights)
    weights = weights + _applied(inverse, rest)
    rest, size = _unexplained(vector, columns, weights)
    values, lacks = two_sum(weights, _applied(inverse, rest))
    spread = np.abs(inverse)
    again = _applied(np.abs(frame), _applied(spread, np.abs(rest)))
    doubt = _applied(spread, PAIRS * size + SOLVED * again) + PAIRS * np.abs(values)
    return values, lacks, doubt


def scaled_axis(drawing: Drawing, tail: str, head: str) -> Pair:
    """The drawn direction from tail to head, as high and low, of a length between 1/2 and 1.

    Without a tail, half the unit vector along a direction of the car.

    Raises:
        MechanismError: both points are in one place.
    """
    if not tail:
        high, low = drawing.pair(head)
        return 0.5 * high, 0.5 * low
    scale = axis_scale(drawing, tail, head)[..., None]
    high, low = two_sum(drawing.vectors[head], -drawing.vectors[tail])
    return high * scale, low * scale


def axis_scale(drawing: Drawing, tail: str, head: str) -> Array:
    """The power of two that brings the drawn distance between 1/2 and 1, shape (...,)."""
    length = drawing.distance(tail, head)
    if not (length > 0.0).all():
        raise no_length(tail, head)
    return np.ldexp(1.0, -np.frexp(length)[1])


def axis_square(drawing: Drawing, tail: str, head: str) -> Pair:
    """|d|^2 of the scaled axis, shape (...,)."""
    high, low = scaled_axis(drawing, tail, head)
    square, rest = exact_square(high, np.zeros_like(high))
    return square, rest + 2.0 * np.sum(high * low, axis=-1)


def axis_length(drawing: Drawing, tail: str, head: str) -> Pair:
    """|d| of the scaled axis, shape (...,)."""
    return pair_root(axis_square(drawing, tail, head))


def _applied(matrix: Array, vector: Array) -> Array:
    return np.asarray((matrix @ vector[..., None])[..., 0])


def _unexplained(vector: Pair, columns: tuple[Pair, Pair, Pair], weights: Array) -> tuple[Array, Array]:
    """vector - sum weights columns, rounded once, and the sum of the magnitudes it is made of; (..., 3)."""
    total, size = vector, np.abs(vector[0])
    for i, column in enumerate(columns):
        weight = weights[..., i, None]
        part = pair_product((weight, np.zeros_like(weight)), column)
        total, size = pair_sum(total, minus_pair(part)), size + np.abs(part[0])
    edges = np.abs(columns[0][0])[..., [1, 2, 0]], np.abs(columns[1][0])[..., [2, 0, 1]]
    others = np.abs(columns[0][0])[..., [2, 0, 1]], np.abs(columns[1][0])[..., [1, 2, 0]]
    crossed = edges[0] * edges[1] + others[0] * others[1]
    return total[0] + total[1], size + np.abs(weights[..., 2, None]) * crossed
