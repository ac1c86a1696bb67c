r"""Vectors and points that are fixed in a body.

The body is known by three points with the edges e1 and e2 and the normal n, an unknown of its own:

    n - e1 x e2 = 0,      v - a e1 - b e2 - c n = 0,

with constants a, b, c of the drawing for a further point of the body, v = p - p_base, or for the direction d
of an axis, an unknown too. All rows are quadratic, and they keep their rank as long as the three points are
not in one line: wherever an axis passes, also along an edge of the triangle, where links to a fourth point of
the body would lose it. The length of d is between 1/2 and 1 of the mechanism's size, however close the points
that it is drawn by.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pointcoord.errors import MechanismError
from pointcoord.linkage.constraints.constraint import Constraint, crossed
from pointcoord.linkage.drawing import Drawing, Placed
from pointcoord.linkage.layout import Layout, Triple
from pointcoord.numerics.double_double import (
    PAIRS,
    Pair,
    minus_pair,
    pair_cross,
    pair_product,
    pair_sum,
    two_sum,
)
from pointcoord.numerics.quadratic import Product, Row
from pointcoord.numerics.rounding import UNIT_ROUNDOFF
from pointcoord.numerics.vectors import cross, lengths

Array = NDArray[np.float64]

# A product with the inverse of a 3 x 3 matrix, and that inverse, round some twenty times relative.
SOLVED = 32.0 * UNIT_ROUNDOFF


@dataclass(frozen=True)
class Normal(Constraint):
    r"""The normal of a body's triangle: n - (p_first - p_base) x (p_second - p_base) = 0. Three rows."""

    normal: str
    base: str
    first: str
    second: str

    along_axes = True
    holds_a_body = True

    @property
    def name(self) -> str:
        return self.normal

    @property
    def vectors(self) -> tuple[str, ...]:
        return (self.normal,)

    def rows(self, layout: Layout) -> tuple[Row, ...]:
        edges = (layout.edge(name, self.base) for name in (self.first, self.second))
        return crossed(layout, layout.vector(self.normal), *edges)

    def placed(self, drawing: Drawing) -> Mapping[str, Placed]:
        base, first, second = (drawing.vectors[name] for name in (self.base, self.first, self.second))
        return {self.normal: Placed(cross(first - base, second - base))}


@dataclass(frozen=True)
class AxisInBody(Constraint):
    """An axis drawn from `tail` to `head` that the body of a triangle carries. Three rows.

    Without a tail it is drawn along the direction of the car that the head names.
    """

    axis: str
    tail: str
    head: str
    normal: Normal

    along_axes = True
    holds_a_body = True

    @property
    def name(self) -> str:
        return self.axis

    @property
    def vectors(self) -> tuple[str, ...]:
        return (self.axis,)

    @property
    def constants(self) -> tuple[str, ...]:
        """Its place in the body: a, b and c."""
        return weight_names(self.axis, self.normal)

    def rows(self, layout: Layout) -> tuple[Row, ...]:
        return weighted_rows(layout, layout.edge(self.axis), self.normal, self.constants)

    def placed(self, drawing: Drawing) -> Mapping[str, Placed]:
        """The drawn direction and its constants, with what they lack by rounding.

        Raises:
            MechanismError: the axis has no direction, or the triangle is flat.
        """
        direction = drawing.axis(self.tail, self.head)
        weights = weights_in_body(drawing, direction, self.normal, self.axis)
        return {self.axis: Placed(direction[0]), **by_component(self.constants, weights)}


@dataclass(frozen=True)
class PointInBody(Constraint):
    """A further point of a body, held in its triangle. Three rows."""

    point: str
    body: str
    normal: Normal

    along_axes = True
    holds_a_body = True

    @property
    def name(self) -> str:
        return f"{self.point} in {self.body}"

    @property
    def constants(self) -> tuple[str, ...]:
        """Its place in the body: a, b and c."""
        return weight_names(self.name, self.normal)

    @property
    def segments(self) -> tuple[tuple[str, str], ...]:
        return ((self.normal.base, self.point),)

    def rows(self, layout: Layout) -> tuple[Row, ...]:
        return weighted_rows(layout, layout.edge(self.point, self.normal.base), self.normal, self.constants)

    def placed(self, drawing: Drawing) -> Mapping[str, Placed]:
        return by_component(self.constants, carrier_weights(drawing, self.point, self.normal))


def by_component(names: Sequence[str], vector: Placed) -> dict[str, Placed]:
    """The components of vectors (..., 3) as numbers with names of their own."""
    values, lacks, doubt = (np.asarray(part) for part in vector)
    return {name: Placed(values[..., i], lacks[..., i], doubt[..., i]) for i, name in enumerate(names)}


def weight_names(name: str, body: Normal) -> tuple[str, ...]:
    """What the constants a, b and c of a vector in a body are called."""
    return tuple(f"{name} along {part}" for part in (body.first, body.second, body.normal))


def weighted_rows(
    layout: Layout, vector: tuple[Triple, Triple], body: Normal, constants: tuple[str, ...]
) -> tuple[Row, ...]:
    """v - a e1 - b e2 - c n = 0 for the difference v of two vectors; bilinear in the constants and edges."""
    edges = layout.edge(body.first, body.base), layout.edge(body.second, body.base), layout.edge(body.normal)
    parts = [(layout.number(name), head, tail) for name, (head, tail) in zip(constants, edges, strict=True)]
    end, start = vector
    return tuple(
        (
            Product(1.0, (end[i], start[i]), layout.number()),
            *(Product(-1.0, weight, (head[i], tail[i])) for weight, head, tail in parts),
        )
        for i in range(3)
    )


def weights_in_body(drawing: Drawing, vector: Pair, body: Normal, what: str) -> Placed:
    """(a, b, c) of a drawn vector in a body, what they lack by rounding, and their doubt, each (..., 3).

    Raises:
        MechanismError: the body's triangle is flat.
    """
    edges = drawing.edge(body.first, body.base), drawing.edge(body.second, body.base)
    columns = (*edges, pair_cross(*edges))
    frame = np.stack(np.broadcast_arrays(*(high for high, _ in columns)), axis=-1)
    sides = lengths(edges[0][0]) * lengths(edges[1][0])
    if not (lengths(columns[2][0]) > 16 * UNIT_ROUNDOFF * sides).all():
        names = (body.base, body.first, body.second)
        raise MechanismError(
            f"{', '.join(names)} lie in one line, so they cannot carry {what}; move one off the line",
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
    return Placed(values, lacks, doubt)


def carrier_weights(drawing: Drawing, point: str, body: Normal) -> Placed:
    """The same of a drawn point from the base of the body."""
    return weights_in_body(drawing, drawing.edge(point, body.base), body, point)


def _applied(matrix: Array, vector: Array) -> Array:
    return np.asarray((matrix @ vector[..., None])[..., 0])


def _unexplained(vector: Pair, columns: tuple[Pair, Pair, Pair], weights: Array) -> tuple[Array, Array]:
    """vector - sum weights columns, rounded once, and the sum of the magnitudes it is made of; (..., 3)."""
    total, size = vector, np.abs(vector[0])
    for i, column in enumerate(columns):
        weight = weights[..., i, None]
        part = pair_product((weight, np.zeros_like(weight)), column)
        total, size = pair_sum(total, minus_pair(part)), size + np.abs(part[0])
    # Both products of a component of e1 x e2 are together no larger than |e1| |e2|.
    crossed = lengths(columns[0][0]) * lengths(columns[1][0])
    return total[0] + total[1], size + np.abs(weights[..., 2] * crossed)[..., None]
