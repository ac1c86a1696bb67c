"""The driven height of a point over another."""

from __future__ import annotations

from dataclasses import dataclass

from pointcoord.linkage.constraints.constraint import Constraint, dot
from pointcoord.linkage.layout import Layout, Triple
from pointcoord.numerics.quadratic import Product, Row


@dataclass(frozen=True)
class Rise(Constraint):
    r"""Driven height of a point over another: (p - p_pivot) . e - rise = 0. One row.

    With rise = d cos(theta) this is the paper's arm angle, eq. (12).
    """

    point: str
    pivot: str
    direction: str
    rise: str

    @property
    def name(self) -> str:
        """Both points."""
        return f"rise of {self.point} over {self.pivot}"

    def rows(self, layout: Layout) -> tuple[Row, ...]:
        """Bilinear in the arm and the direction, minus the driven height."""
        p, o, e = (layout.vector(name) for name in (self.point, self.pivot, self.direction))
        zeros: Triple = (layout.zero, layout.zero, layout.zero)
        driven = Product(-1.0, (layout.scalar(self.rise), layout.zero), (layout.one, layout.zero))
        return ((*dot(p, o, e, zeros), driven),)
