"""The scalar product of two vectors, kept as drawn or driven: links, heights, distances, kept turns."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

import numpy as np

from pointcoord.linkage.constraints.constraint import (
    ONE,
    Constraint,
    Edge,
    Equation,
    Reading,
    Term,
    nothing,
)
from pointcoord.linkage.directions import unit_pair
from pointcoord.linkage.drawing import Drawing, Placed, no_length
from pointcoord.numerics.double_double import (
    PAIRS,
    Pair,
    exact_square,
    pair_cross,
    pair_dot,
    pair_product,
    pair_quotient,
    pair_sum,
)
from pointcoord.numerics.rounding import UNIT_ROUNDOFF

WHOLE: Pair = np.array(1.0), np.array(0.0)


def scalar_product(name: str, one: Edge, other: Edge, drawn: str = "", driven: str = "") -> Constraint:
    r"""u . v - k - x = 0, with drawn k and driven x, where the row has these; or u . u - x^2 = 0. One row.

    An edge runs from its second point to its first; with an empty second name it is a direction of the car
    or the place of a point. So x is the height of a point over another, as d cos(theta) of the paper's arm
    angle, eq. (12), or with k the height over its own drawn place. For an edge with itself the row is a
    distance: x is a driven one, and k the square of a fixed one.

    Args:
        drawn: the name of k; empty for a row without k.
        driven: the driven coordinate x; empty for a row without x.
    """
    read = partial(_square, drawn, one) if one == other else partial(_product, drawn, one, other)
    return _kept(name, one, other, drawn, driven, read if drawn else nothing)


def link(start: str, end: str) -> Constraint:
    """Fixed distance: |p_start - p_end|^2 - d^2 = 0, d as drawn (paper eqs. 1-7)."""
    name, edge = f"link {start} - {end}", (start, end)
    return scalar_product(name, edge, edge, f"squared length of {name}")


def kept_turn(name: str, one: Edge, other: Edge, drawn: str, line: Edge, own: Edge) -> Constraint:
    r"""u . v = k of an edge u of the one body and v of the other. One row.

    If the second body's line is drawn at an angle to the first one's, closing the drawing turns it onto that
    line, without rotation about it: by the smallest rotation T of its unit vector m into the line's l. With
    c = l . m and w = m x l,

        k = u . T v = c u . v + u . (w x v) + (u . w) (w . v) / (1 + c).

    With rotation about l the product changes at the rate l . (v x u), so the three must not be coplanar.

    Args:
        line: of the first body, l. own: of the second body, m, in either sense.
    """
    return _kept(name, one, other, drawn, "", partial(_turned, drawn, one, other, line, own))


def _kept(name: str, one: Edge, other: Edge, drawn: str, driven: str, read: Reading) -> Constraint:
    same = (one,) if one == other else ()
    terms = [Term(1.0, one, other)]
    terms += [Term(-1.0, drawn, ONE)] if drawn else []
    terms += [Term(-1.0, driven, driven if same else ONE)] if driven else []
    lengths = same if drawn else ()
    return Constraint(
        name,
        (Equation(name, tuple(terms)),),
        read,
        constants=(drawn,) if drawn else (),
        squared_lengths=lengths,
        segments=same,
    )


def _product(k: str, one: Edge, other: Edge, drawing: Drawing) -> Mapping[str, Placed]:
    u, v = drawing.edge(*one), drawing.edge(*other)
    return {k: Placed(*pair_dot(u, v), PAIRS * np.sum(np.abs(u[0] * v[0]), axis=-1))}


def _square(k: str, edge: Edge, drawing: Drawing) -> Mapping[str, Placed]:
    """The drawn square of a length and its rounding error, which is at most five units.

    Raises:
        MechanismError: both points of a fixed distance are at one place.
    """
    start, end = (drawing.vectors[name] for name in edge)
    square = np.sum((start - end) ** 2, axis=-1)
    if not (square > 0.0).all():
        raise no_length(*edge)
    exact, rest = exact_square(start, end)
    return {k: Placed(square, (exact - square) + rest, 256 * UNIT_ROUNDOFF**2 * square)}


def _turned(k: str, one: Edge, other: Edge, line: Edge, own: Edge, drawing: Drawing) -> Mapping[str, Placed]:
    u, v = drawing.edge(*one), drawing.edge(*other)
    to, m = (unit_pair(drawing.edge(*edge)) for edge in (line, own))
    sense = np.where(pair_dot(to, m)[0] < 0.0, -1.0, 1.0)[..., None]
    m = m[0] * sense, m[1] * sense
    cosine, w = pair_dot(to, m), pair_cross(m, to)
    along, across = pair_product(cosine, pair_dot(u, v)), pair_dot(u, pair_cross(w, v))
    more = pair_quotient(pair_product(pair_dot(u, w), pair_dot(w, v)), pair_sum(WHOLE, cosine))
    high, low = pair_sum(along, pair_sum(across, more))
    # Each of the three terms is at most |u| |v|; some ten steps each round by at most that.
    size = np.linalg.norm(u[0], axis=-1) * np.linalg.norm(v[0], axis=-1)
    return {k: Placed(high, low, 10.0 * PAIRS * size)}
