"""Two points at a fixed distance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pointcoord.linkage.constraints.constraint import Constraint, dot, no_length
from pointcoord.linkage.drawing import Drawing, Placed
from pointcoord.linkage.layout import Layout
from pointcoord.numerics.double_double import exact_square
from pointcoord.numerics.quadratic import Product, Row
from pointcoord.numerics.rounding import UNIT_ROUNDOFF


@dataclass(frozen=True)
class Link(Constraint):
    r"""Fixed distance: |p_start - p_end|^2 - d^2 = 0, d as drawn (paper eqs. 1-7). One row."""

    start: str
    end: str

    may_lock = True  # where it lies in line with another

    @property
    def name(self) -> str:
        return f"link {self.start} - {self.end}"

    @property
    def segments(self) -> tuple[tuple[str, str], ...]:
        return ((self.start, self.end),)

    def rows(self, layout: Layout) -> tuple[Row, ...]:
        start, end = layout.vector(self.start), layout.vector(self.end)
        square = layout.squared_length(self.start, self.end)
        length = Product(-1.0, (square, layout.zero), (layout.one, layout.zero))
        return ((*dot(start, end, start, end), length),)

    @property
    def squared_lengths(self) -> tuple[tuple[str, str], ...]:
        return ((self.start, self.end),)

    def placed(self, layout: Layout, drawing: Drawing) -> tuple[Placed, ...]:
        return self.placed_together((self,), layout, drawing)

    @classmethod
    def placed_together(
        cls, constraints: Sequence[Link], layout: Layout, drawing: Drawing
    ) -> tuple[Placed, ...]:
        """The squares of the drawn lengths; five units of rounding at most, which are measured."""
        starts = drawing.stacked([link.start for link in constraints])
        ends = drawing.stacked([link.end for link in constraints])
        squares = np.sum((starts - ends) ** 2, axis=-1)
        if not (squares > 0.0).all():
            short = constraints[int(np.argwhere(~(squares > 0.0))[0, -1])]
            raise no_length(short.start, short.end)
        exact, rest = exact_square(starts, ends)
        places = tuple(layout.squared_length(link.start, link.end) for link in constraints)
        return (Placed(places, squares, (exact - squares) + rest, 256 * UNIT_ROUNDOFF**2 * squares),)
