"""The scalar product of two vectors: kept as drawn, or driven."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pointcoord.linkage.constraints.constraint import Constraint, dot
from pointcoord.linkage.drawing import Drawing, Placed
from pointcoord.linkage.layout import Layout, Triple
from pointcoord.numerics.double_double import PAIRS, Pair, pair_dot, two_sum
from pointcoord.numerics.quadratic import Product, Row

Edge = tuple[str, str]


@dataclass(frozen=True)
class ScalarProduct(Constraint):
    r"""u . v - k - x = 0, with k as drawn and x driven, where the row has such. One row.

    An edge runs from its second point to its first; with an empty second name it is a direction of the car
    or the place of a point.

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

    @classmethod
    def rise(cls, point: str, pivot: str, direction: str, rise: str) -> ScalarProduct:
        """Driven height of a point over another; with d cos(theta) the paper's arm angle, eq. (12)."""
        return cls(f"rise of {point} over {pivot}", (point, pivot), (direction, ""), "", rise)

    @classmethod
    def height(cls, point: str, direction: str, rise: str) -> ScalarProduct:
        """Driven height of a point over where it is drawn."""
        drawn = f"drawn height of {point} {direction}"
        return cls(f"height of {point}", (point, ""), (direction, ""), drawn, rise)

    @classmethod
    def distance(cls, start: str, end: str, square: str) -> ScalarProduct:
        """Driven distance of two points."""
        return cls(f"distance of {start} and {end}", (start, end), (start, end), "", square)

    @classmethod
    def kept_from_turning(cls, line: str, one: Edge, other: Edge) -> ScalarProduct:
        """Two bodies, each with an edge of its own, that do not turn against each other about a line.

        About a line along d the product changes as d . (v x u), so the three may not lie in one plane.
        """
        return cls(f"turn about the {line}", one, other, f"product of edges across the {line}")

    @property
    def name(self) -> str:
        return self.what

    @property
    def segments(self) -> tuple[tuple[str, str], ...]:
        return (self.one,) if self.one == self.other else ()

    @property
    def constants(self) -> tuple[str, ...]:
        """k."""
        return (self.drawn,) if self.drawn else ()

    def rows(self, layout: Layout) -> tuple[Row, ...]:
        zeros: Triple = (layout.zero, layout.zero, layout.zero)
        a, b, c, d = (layout.vector(name) if name else zeros for name in (*self.one, *self.other))
        scalars = (layout.scalar(name) for name in (self.drawn, self.driven) if name)
        less = (Product(-1.0, (scalar, layout.zero), (layout.one, layout.zero)) for scalar in scalars)
        return ((*dot(a, b, c, d), *less),)

    def placed(self, layout: Layout, drawing: Drawing) -> tuple[Placed, ...]:
        if not self.drawn:
            return ()
        u, v = (_drawn(drawing, edge) for edge in (self.one, self.other))
        high, low = pair_dot(u, v)
        size = np.sum(np.abs(u[0] * v[0]), axis=-1)
        place = (layout.scalar(self.drawn),)
        return (Placed(place, high[..., None], low[..., None], PAIRS * size[..., None]),)


def _drawn(drawing: Drawing, edge: Edge) -> Pair:
    head, tail = edge
    return two_sum(drawing.vectors[head], -drawing.vectors[tail]) if tail else drawing.pair(head)
