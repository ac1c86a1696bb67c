"""The scalar product of two vectors, kept as drawn or driven: links, heights, distances, kept turns."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from pointcoord.linkage.constraints.constraint import Constraint, dot
from pointcoord.linkage.directions import unit_pair
from pointcoord.linkage.drawing import Drawing, Placed, no_length
from pointcoord.linkage.layout import Layout
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
from pointcoord.numerics.quadratic import Product, Row
from pointcoord.numerics.rounding import UNIT_ROUNDOFF

Edge = tuple[str, str]
ONE: Pair = np.array(1.0), np.array(0.0)


@dataclass(frozen=True)
class ScalarProduct(Constraint):
    r"""u . v - k - x = 0, with k as drawn and x driven, where the row has such; or u . u - x^2 = 0. One row.

    An edge runs from its second point to its first; with an empty second name it is a direction of the car
    or the place of a point. So x is the height of a point over another, with d cos(theta) the paper's arm
    angle, eq. (12), or over where it is drawn, with k. Of an edge with itself it is a distance, and k the
    square of one that is kept.

    Attributes:
        what: its name in messages.
        drawn: the name of k; empty for a row without.
        driven: the driven coordinate x; empty for a row without.
    """

    what: str
    one: Edge
    other: Edge
    drawn: str = ""
    driven: str = ""

    @property
    def name(self) -> str:
        return self.what

    @property
    def segments(self) -> tuple[Edge, ...]:
        return (self.one,) if self.one == self.other else ()

    @property
    def squared_lengths(self) -> tuple[Edge, ...]:
        return self.segments if self.drawn else ()

    @property
    def may_lock(self) -> bool:
        """Where it lies in line with another."""
        return bool(self.squared_lengths)

    @property
    def constants(self) -> tuple[str, ...]:
        """k."""
        return (self.drawn,) if self.drawn else ()

    def rows(self, layout: Layout) -> tuple[Row, ...]:
        less, one = list[Product](), layout.number()
        if self.drawn:
            less.append(Product(-1.0, layout.number(self.drawn), one))
        if self.driven:
            x = layout.number(self.driven)
            less.append(Product(-1.0, x, x if self.segments else one))
        return ((*dot(layout.edge(*self.one), layout.edge(*self.other)), *less),)

    def placed(self, drawing: Drawing) -> Mapping[str, Placed]:
        """K; of the square of a drawn length five units of rounding at most, which are measured.

        Raises:
            MechanismError: both points of a kept distance are in one place.
        """
        if not self.drawn:
            return {}
        if not self.segments:
            u, v = drawing.edge(*self.one), drawing.edge(*self.other)
            size = np.sum(np.abs(u[0] * v[0]), axis=-1)
            return {self.drawn: Placed(*pair_dot(u, v), PAIRS * size)}
        start, end = (drawing.vectors[name] for name in self.one)
        square = np.sum((start - end) ** 2, axis=-1)
        if not (square > 0.0).all():
            raise no_length(*self.one)
        exact, rest = exact_square(start, end)
        return {self.drawn: Placed(square, (exact - square) + rest, 256 * UNIT_ROUNDOFF**2 * square)}


def link(start: str, end: str) -> ScalarProduct:
    """Fixed distance: |p_start - p_end|^2 - d^2 = 0, d as drawn (paper eqs. 1-7)."""
    name, edge = f"link {start} - {end}", (start, end)
    return ScalarProduct(name, edge, edge, f"squared length of {name}")


@dataclass(frozen=True)
class KeptTurn(ScalarProduct):
    r"""u . v = k of an edge u of the one body and v of the other. One row.

    Where the second body's line is drawn off the first one's, closing the drawing turns it onto that, and by
    nothing about it: by the smallest rotation T of its unit vector m into that of the line l. With
    c = l . m and w = m x l,

        k = u . T v = c u . v + u . (w x v) + (u . w) (w . v) / (1 + c).

    About l the product changes as l . (v x u), so the three may not lie in one plane.

    Attributes:
        line: of the first body, l. own: of the second one, m, in either sense.
    """

    line: Edge = ("", "")
    own: Edge = ("", "")

    def placed(self, drawing: Drawing) -> Mapping[str, Placed]:
        u, v = drawing.edge(*self.one), drawing.edge(*self.other)
        line, own = (unit_pair(drawing.edge(*edge)) for edge in (self.line, self.own))
        sense = np.where(pair_dot(line, own)[0] < 0.0, -1.0, 1.0)[..., None]
        own = own[0] * sense, own[1] * sense
        cosine, w = pair_dot(line, own), pair_cross(own, line)
        along, across = pair_product(cosine, pair_dot(u, v)), pair_dot(u, pair_cross(w, v))
        more = pair_quotient(pair_product(pair_dot(u, w), pair_dot(w, v)), pair_sum(ONE, cosine))
        high, low = pair_sum(along, pair_sum(across, more))
        # Each of the three is at most |u| |v|, and so is what each of some ten steps rounds.
        size = np.linalg.norm(u[0], axis=-1) * np.linalg.norm(v[0], axis=-1)
        return {self.drawn: Placed(high, low, 10.0 * PAIRS * size)}
