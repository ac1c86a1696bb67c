"""The scalar product of two vectors: kept as drawn, or driven."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from pointcoord.linkage.constraints.constraint import Constraint, dot
from pointcoord.linkage.drawing import Drawing, Placed
from pointcoord.linkage.layout import Layout, Triple
from pointcoord.numerics.double_double import PAIRS, pair_dot
from pointcoord.numerics.quadratic import Product, Row

Edge = tuple[str, str]


@dataclass(frozen=True)
class ScalarProduct(Constraint):
    r"""u . v - k - x = 0, with k as drawn and x driven, where the row has such. One row.

    An edge runs from its second point to its first; with an empty second name it is a direction of the car
    or the place of a point. So x is the height of a point over another, with d cos(theta) the paper's arm
    angle, eq. (12), or over where it is drawn, with k; or the square of a distance.

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

    def placed(self, drawing: Drawing) -> Mapping[str, Placed]:
        if not self.drawn:
            return {}
        u, v = drawing.edge(*self.one), drawing.edge(*self.other)
        size = np.sum(np.abs(u[0] * v[0]), axis=-1)
        return {self.drawn: Placed(*pair_dot(u, v), PAIRS * size)}
