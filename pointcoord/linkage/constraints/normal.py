"""The normal of a body's triangle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pointcoord.linkage.constraints.constraint import Constraint, per_axis
from pointcoord.linkage.drawing import Drawing, Placed
from pointcoord.linkage.layout import Layout
from pointcoord.numerics.quadratic import Product, Row


@dataclass(frozen=True)
class Normal(Constraint):
    r"""The normal of a body's triangle: n - (p_first - p_base) x (p_second - p_base) = 0. Three rows."""

    normal: str
    base: str
    first: str
    second: str

    @property
    def name(self) -> str:
        """The normal's own."""
        return self.normal

    @property
    def labels(self) -> tuple[str, ...]:
        """A row per axis."""
        return per_axis(self.name)

    @property
    def vectors(self) -> tuple[str, ...]:
        """The normal."""
        return (self.normal,)

    @property
    def holds_a_body(self) -> bool:
        """It does."""
        return True

    def rows(self, layout: Layout) -> tuple[Row, ...]:
        """Bilinear in the two edges."""
        n, o, p, q = (layout.vector(name) for name in (self.normal, self.base, self.first, self.second))
        return tuple(
            (
                Product(1.0, (n[i], layout.zero), (layout.one, layout.zero)),
                Product(-1.0, (p[j], o[j]), (q[k], o[k])),
                Product(1.0, (p[k], o[k]), (q[j], o[j])),
            )
            for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1))
        )

    def placed(self, layout: Layout, drawing: Drawing) -> tuple[Placed, ...]:
        """The normal of the drawn triangle."""
        base, first, second = (drawing.vectors[name] for name in (self.base, self.first, self.second))
        return (Placed(layout.vector(self.normal), np.cross(first - base, second - base)),)
