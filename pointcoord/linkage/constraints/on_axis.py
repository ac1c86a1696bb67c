"""A point that slides along an axis of a body."""

from __future__ import annotations

import numpy as np

from pointcoord.data_classes import dataclass
from pointcoord.linkage.constraints.axis_in_body import scaled_axis
from pointcoord.linkage.constraints.constraint import Constraint, per_axis
from pointcoord.linkage.drawing import Drawing, Placed
from pointcoord.linkage.layout import Layout
from pointcoord.numerics.quadratic import Product, Row


@dataclass(frozen=True)
class OnAxis(Constraint):
    r"""A point that slides along an axis: p - p_origin - s d = 0. Three rows and one unknown, the place s."""

    point: str
    origin: str
    axis: str
    place: str

    @property
    def name(self) -> str:
        """The point and the axis."""
        return f"{self.point} on the {self.axis}"

    @property
    def labels(self) -> tuple[str, ...]:
        """A row per axis."""
        return per_axis(self.name)

    @property
    def slides(self) -> tuple[str, ...]:
        """The place."""
        return (self.place,)

    @property
    def segments(self) -> tuple[tuple[str, str], ...]:
        """From the origin of the axis to the point."""
        return ((self.origin, self.point),)

    @property
    def may_lock(self) -> bool:
        """Where what it holds lies square to the axis."""
        return True

    def rows(self, layout: Layout) -> tuple[Row, ...]:
        """Bilinear in the place and the direction."""
        p, o, d = (layout.vector(name) for name in (self.point, self.origin, self.axis))
        place, zero, one = layout.scalar(self.place), layout.zero, layout.one
        return tuple(
            (Product(1.0, (p[i], o[i]), (one, zero)), Product(-1.0, (place, zero), (d[i], zero)))
            for i in range(3)
        )

    def placed(self, layout: Layout, drawing: Drawing) -> tuple[Placed, ...]:
        """The place of the point's foot on the axis, which is drawn from the origin to the point."""
        high, _ = scaled_axis(drawing, self.origin, self.point)
        line = drawing.vectors[self.point] - drawing.vectors[self.origin]
        place = np.sum(line * high, axis=-1) / np.sum(high * high, axis=-1)
        return (Placed((layout.scalar(self.place),), place[..., None]),)
