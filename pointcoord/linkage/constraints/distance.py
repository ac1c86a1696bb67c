"""The driven distance of two points."""

from __future__ import annotations

from dataclasses import dataclass

from pointcoord.linkage.constraints.constraint import Constraint, dot
from pointcoord.linkage.layout import Layout
from pointcoord.numerics.quadratic import Product, Row


@dataclass(frozen=True)
class Distance(Constraint):
    r"""|p_start - p_end|^2 - square = 0, the square driven. One row."""

    start: str
    end: str
    square: str

    @property
    def name(self) -> str:
        """Both points."""
        return f"distance of {self.start} and {self.end}"

    @property
    def segments(self) -> tuple[tuple[str, str], ...]:
        """The line between them."""
        return ((self.start, self.end),)

    def rows(self, layout: Layout) -> tuple[Row, ...]:
        """Quadratic in the difference."""
        start, end = layout.vector(self.start), layout.vector(self.end)
        driven = Product(-1.0, (layout.scalar(self.square), layout.zero), (layout.one, layout.zero))
        return ((*dot(start, end, start, end), driven),)
