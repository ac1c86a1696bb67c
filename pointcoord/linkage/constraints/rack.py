"""A point driven along a line of the chassis."""

from __future__ import annotations

from pointcoord.data_classes import dataclass
from pointcoord.linkage.constraints.constraint import Constraint, per_axis
from pointcoord.linkage.layout import Layout
from pointcoord.numerics.quadratic import Product, Row


@dataclass(frozen=True)
class Rack(Constraint):
    r"""A point held on a line of the chassis and driven along it (paper eqs. 13-15, any direction):

    p - p_origin + travel e = 0, so that positive travel moves the point against e. Three rows.
    """

    point: str
    origin: str
    direction: str
    travel: str

    @property
    def name(self) -> str:
        """The point."""
        return f"{self.point} on the rack"

    @property
    def labels(self) -> tuple[str, ...]:
        """A row per axis."""
        return per_axis(self.name)

    @property
    def is_length(self) -> bool:
        """The point's distance from the line of the rack."""
        return True

    def rows(self, layout: Layout) -> tuple[Row, ...]:
        """Bilinear in the travel and the direction, which both are known."""
        p, o, e = (layout.vector(name) for name in (self.point, self.origin, self.direction))
        travel, zero, one = layout.scalar(self.travel), layout.zero, layout.one
        return tuple(
            (Product(1.0, (p[i], o[i]), (one, zero)), Product(1.0, (travel, zero), (e[i], zero)))
            for i in range(3)
        )
