"""The driven height of a point over where it is drawn."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pointcoord.linkage.constraints.constraint import Constraint, dot
from pointcoord.linkage.drawing import Drawing, Placed
from pointcoord.linkage.layout import Layout, Triple
from pointcoord.numerics.double_double import PAIRS, pair_dot
from pointcoord.numerics.quadratic import Product, Row


@dataclass(frozen=True)
class Height(Constraint):
    r"""p . e - h - rise = 0, with h = p . e of the drawing and the rise driven. One row."""

    point: str
    direction: str
    rise: str

    @property
    def name(self) -> str:
        """The point."""
        return f"height of {self.point}"

    @property
    def constants(self) -> tuple[str, ...]:
        """The drawn height."""
        return (f"drawn height of {self.point} {self.direction}",)

    def rows(self, layout: Layout) -> tuple[Row, ...]:
        """Bilinear in the point and the direction, minus the heights."""
        zeros: Triple = (layout.zero, layout.zero, layout.zero)
        p, e = layout.vector(self.point), layout.vector(self.direction)
        one = (layout.one, layout.zero)
        drawn = Product(-1.0, (layout.scalar(self.constants[0]), layout.zero), one)
        return (
            (*dot(p, zeros, e, zeros), drawn, Product(-1.0, (layout.scalar(self.rise), layout.zero), one)),
        )

    def placed(self, layout: Layout, drawing: Drawing) -> tuple[Placed, ...]:
        """The drawn height and what it lacks."""
        p, e = drawing.pair(self.point), drawing.pair(self.direction)
        high, low = pair_dot(p, e)
        size = np.sum(np.abs(p[0] * e[0]), axis=-1)
        place = (layout.scalar(self.constants[0]),)
        return (Placed(place, high[..., None], low[..., None], PAIRS * size[..., None]),)
