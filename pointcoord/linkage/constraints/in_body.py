r"""Vectors and points that are fixed in a body.

A body is known by three points, with the edges e1 and e2 between them and the normal n, an unknown vector:

    n - e1 x e2 = 0,      v - a e1 - b e2 - c n = 0,

with constants a, b, c of the drawing. Here v = p - p_base for a further point of the body, or v = d for the
direction d of an axis, an unknown vector too. All rows are quadratic, and keep their rank as long as the
three points are not in one line, for any place of the axis. Links to a fourth point would lose their rank for
an axis along an edge of the triangle. The length of d is between 1/2 and 1 of the mechanism's size, however
close the two points that define the axis are.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import NamedTuple

import numpy as np

from pointcoord.errors import MechanismError
from pointcoord.linkage.constraints.constraint import ONE, Constraint, Edge, Equation, Names, Term
from pointcoord.linkage.drawing import Drawing, Placed
from pointcoord.numerics.arrays import Array
from pointcoord.numerics.double_double import (
    PAIRS,
    Pair,
    minus_pair,
    pair_cross,
    pair_product,
    pair_sum,
    two_sum,
)
from pointcoord.numerics.rounding import UNIT_ROUNDOFF
from pointcoord.numerics.vectors import cross, lengths

Triangle = tuple[str, str, str]

# Relative error of a product with the inverse of a 3 x 3 matrix and of the inverse: about 20 roundings.
SOLVED = 32.0 * UNIT_ROUNDOFF


class Axis(NamedTuple):
    """An axis fixed to a body, drawn from `tail` to `head`.

    Without a tail, `head` names the direction of the car along which it is drawn.
    """

    name: str
    tail: str
    head: str
    body: str


def normal_name(body: str) -> str:
    """Name of a body's normal vector."""
    return f"normal of the {body}"


def normal_of(body: str, triangle: Triangle) -> Constraint:
    r"""The normal of a body's triangle: n - (p_first - p_base) x (p_second - p_base) = 0. Three rows."""
    (base, first, second), name = triangle, normal_name(body)
    terms = Term(1.0, (name, ""), ONE), Term(-1.0, (first, base), (second, base), cross=True)
    read = partial(_normal, name, triangle)
    return Constraint(name, (Equation(name, terms),), read, vectors=(name,))


def axis_in_body(axis: Axis, triangle: Triangle) -> Constraint:
    """An axis fixed to the body of a triangle; its direction is unknown. Three rows."""
    name = axis.name
    equation, constants = held_in_body(name, (name, ""), axis.body, triangle)
    read = partial(_axis, axis, triangle, constants)
    return Constraint(name, (equation,), read, vectors=(name,), constants=constants)


def point_in_body(point: str, body: str, triangle: Triangle) -> Constraint:
    """A further point of a body, fixed to its triangle. Three rows."""
    name, edge = f"{point} in {body}", (point, triangle[0])
    equation, constants = held_in_body(name, edge, body, triangle)
    read, segment = partial(_point, point, triangle, constants), (triangle[0], point)
    return Constraint(name, (equation,), read, constants=constants, segments=(segment,))


def held_in_body(label: str, vector: Edge, body: str, triangle: Triangle) -> tuple[Equation, Names]:
    """v - a e1 - b e2 - c n = 0, bilinear in the constants and edges; and the names of a, b and c."""
    base, first, second = triangle
    edges = (first, base), (second, base), (normal_name(body), "")
    weights = tuple(f"{label} along {head}" for head, _ in edges)
    parts = (Term(-1.0, weight, edge) for weight, edge in zip(weights, edges, strict=True))
    return Equation(label, (Term(1.0, vector, ONE), *parts)), weights


def by_component(names: Names, vector: Placed) -> dict[str, Placed]:
    """The components of vectors (..., 3) as numbers by name."""
    values, lacks, doubt = (np.asarray(part) for part in vector)
    return {name: Placed(values[..., i], lacks[..., i], doubt[..., i]) for i, name in enumerate(names)}


def weights_in_body(drawing: Drawing, vector: Pair, triangle: Triangle, what: str) -> Placed:
    """(a, b, c) of a drawn vector in a body, their rounding error, and their uncertainty, each (..., 3).

    Raises:
        MechanismError: the body's triangle is flat.
    """
    base, first, second = triangle
    edges = drawing.edge(first, base), drawing.edge(second, base)
    columns = (*edges, pair_cross(*edges))
    frame = np.stack(np.broadcast_arrays(*(high for high, _ in columns)), axis=-1)
    sides = lengths(edges[0][0]) * lengths(edges[1][0])
    if not (lengths(columns[2][0]) > 16 * UNIT_ROUNDOFF * sides).all():
        raise MechanismError(
            f"{', '.join(triangle)} lie in one line, so they cannot carry {what}; move one off the line",
            triangle,
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


def carrier_weights(drawing: Drawing, point: str, triangle: Triangle) -> Placed:
    """(a, b, c) of a drawn point, measured from the base of the body's triangle."""
    return weights_in_body(drawing, drawing.edge(point, triangle[0]), triangle, point)


def _normal(name: str, triangle: Triangle, drawing: Drawing) -> Mapping[str, Placed]:
    base, first, second = (drawing.vectors[point] for point in triangle)
    return {name: Placed(cross(first - base, second - base))}


def _axis(axis: Axis, triangle: Triangle, constants: Names, drawing: Drawing) -> Mapping[str, Placed]:
    """The drawn direction and its constants, with their rounding errors.

    Raises:
        MechanismError: the axis has no direction, or the triangle is flat.
    """
    direction = drawing.axis(axis.tail, axis.head)
    weights = weights_in_body(drawing, direction, triangle, axis.name)
    return {axis.name: Placed(direction[0]), **by_component(constants, weights)}


def _point(point: str, triangle: Triangle, constants: Names, drawing: Drawing) -> Mapping[str, Placed]:
    return by_component(constants, carrier_weights(drawing, point, triangle))


def _applied(matrix: Array, vector: Array) -> Array:
    return np.asarray((matrix @ vector[..., None])[..., 0])


def _unexplained(vector: Pair, columns: tuple[Pair, Pair, Pair], weights: Array) -> tuple[Array, Array]:
    """vector - sum weights columns, rounded once, and the sum of the magnitudes of its terms; (..., 3)."""
    total, size = vector, np.abs(vector[0])
    for i, column in enumerate(columns):
        weight = weights[..., i, None]
        part = pair_product((weight, np.zeros_like(weight)), column)
        total, size = pair_sum(total, minus_pair(part)), size + np.abs(part[0])
    # The two products in a component of e1 x e2 are together at most |e1| |e2|.
    crossed = lengths(columns[0][0]) * lengths(columns[1][0])
    return total[0] + total[1], size + np.abs(weights[..., 2] * crossed)[..., None]
