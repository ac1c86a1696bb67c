"""A further point of a body, held in the triangle of three others."""

from __future__ import annotations

from dataclasses import dataclass

from pointcoord.linkage.constraints.axis_in_body import weight_names, weighted_rows, weights_in_body
from pointcoord.linkage.constraints.constraint import Constraint, per_axis
from pointcoord.linkage.constraints.normal import Normal
from pointcoord.linkage.drawing import Drawing, Placed
from pointcoord.linkage.layout import Layout
from pointcoord.numerics.double_double import two_sum
from pointcoord.numerics.quadratic import Row


@dataclass(frozen=True)
class PointInBody(Constraint):
    r"""p - p_base - a e1 - b e2 - c n = 0, with a, b, c as drawn (see `axis_in_body`). Three rows."""

    point: str
    body: str
    normal: Normal

    @property
    def name(self) -> str:
        """The point and the body."""
        return f"{self.point} in {self.body}"

    @property
    def labels(self) -> tuple[str, ...]:
        """A row per axis."""
        return per_axis(self.name)

    @property
    def constants(self) -> tuple[str, ...]:
        """Its place in the body: a, b and c."""
        return weight_names(self.name, self.normal)

    @property
    def segments(self) -> tuple[tuple[str, str], ...]:
        """From the body's first point."""
        return ((self.normal.base, self.point),)

    @property
    def holds_a_body(self) -> bool:
        """It joins the body to nothing."""
        return True

    def rows(self, layout: Layout) -> tuple[Row, ...]:
        """Bilinear in the constants and the edges."""
        vector = layout.vector(self.point), layout.vector(self.normal.base)
        return weighted_rows(layout, vector, self.normal, self.constants)

    def placed(self, layout: Layout, drawing: Drawing) -> tuple[Placed, ...]:
        """The constants, with what they lack by rounding."""
        vector = two_sum(drawing.vectors[self.point], -drawing.vectors[self.normal.base])
        places = tuple(layout.scalar(name) for name in self.constants)
        return (Placed(places, *weights_in_body(drawing, vector, self.normal, self.point)),)
