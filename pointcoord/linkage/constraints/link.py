"""Two points at a fixed distance."""

from __future__ import annotations

import numpy as np

from pointcoord.data_classes import dataclass
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

    @property
    def name(self) -> str:
        """Its ends."""
        return f"link {self.start} - {self.end}"

    @property
    def segments(self) -> tuple[tuple[str, str], ...]:
        """The link."""
        return ((self.start, self.end),)

    @property
    def may_lock(self) -> bool:
        """Where it lies in line with another."""
        return True

    def rows(self, layout: Layout) -> tuple[Row, ...]:
        """Quadratic in the difference of the ends."""
        start, end = layout.vector(self.start), layout.vector(self.end)
        square = layout.squared_length(self.start, self.end)
        length = Product(-1.0, (square, layout.zero), (layout.one, layout.zero))
        return ((*dot(start, end, start, end), length),)

    @property
    def squared_lengths(self) -> tuple[tuple[str, str], ...]:
        """Its own."""
        return ((self.start, self.end),)

    def placed(self, layout: Layout, drawing: Drawing) -> tuple[Placed, ...]:
        """The square of the drawn length; five units of rounding at most, which are measured."""
        start, end = drawing.vectors[self.start], drawing.vectors[self.end]
        square = np.sum((start - end) ** 2, axis=-1)
        if not (square > 0.0).all():
            raise no_length(self.start, self.end)
        exact, rest = exact_square(start, end)
        place = (layout.squared_length(self.start, self.end),)
        lacks = (exact - square) + rest
        doubt = 256 * UNIT_ROUNDOFF**2 * square
        return (Placed(place, square[..., None], lacks[..., None], doubt[..., None]),)
