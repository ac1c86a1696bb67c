"""Two bodies that do not turn against each other about a line."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pointcoord.linkage.constraints.constraint import Constraint, dot
from pointcoord.linkage.drawing import Drawing, Placed
from pointcoord.linkage.layout import Layout, Triple
from pointcoord.numerics.double_double import PAIRS, pair_dot, two_sum
from pointcoord.numerics.quadratic import Product, Row

Edge = tuple[str, str]


@dataclass(frozen=True)
class KeptFromTurning(Constraint):
    r"""u . v - k = 0 for an edge of one body and one of another, k as drawn. One row.

    About a line along d their product changes as d . (v x u), so it keeps the bodies from turning about it as
    long as the three are in no one plane. An edge runs from its second point to its first; that of the
    chassis is a direction of the car and an empty name.
    """

    line: str
    one: Edge
    other: Edge

    @property
    def name(self) -> str:
        """The line."""
        return f"turn about the {self.line}"

    @property
    def constants(self) -> tuple[str, ...]:
        """k."""
        return (f"product of edges across the {self.line}",)

    def rows(self, layout: Layout) -> tuple[Row, ...]:
        """Bilinear in the edges."""
        zeros: Triple = (layout.zero, layout.zero, layout.zero)
        a, b, c, d = (layout.vector(name) if name else zeros for name in (*self.one, *self.other))
        drawn = Product(-1.0, (layout.scalar(self.constants[0]), layout.zero), (layout.one, layout.zero))
        return ((*dot(a, b, c, d), drawn),)

    def placed(self, layout: Layout, drawing: Drawing) -> tuple[Placed, ...]:
        """k and what it lacks by rounding."""
        u, v = (
            two_sum(drawing.vectors[head], -drawing.vectors[tail]) if tail else drawing.pair(head)
            for head, tail in (self.one, self.other)
        )
        high, low = pair_dot(u, v)
        size = np.sum(np.abs(u[0] * v[0]), axis=-1)
        place = (layout.scalar(self.constants[0]),)
        return (Placed(place, high[..., None], low[..., None], PAIRS * size[..., None]),)
