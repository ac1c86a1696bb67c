"""Two parallel lines, as the paper prints the condition."""

from __future__ import annotations

from dataclasses import dataclass

from pointcoord.linkage.constraints.constraint import Constraint
from pointcoord.linkage.layout import Layout
from pointcoord.numerics.quadratic import Product, Row


@dataclass(frozen=True)
class PrintedParallel(Constraint):
    r"""Two lines parallel as the paper prints it, eqs. (8), (9) and again (10), (11):

    the x and y components only of (p_end - p_start) x (p_head - p_tail) = 0, with z as the preferred
    axis. The rows lose rank where the line tail - head is horizontal. Two rows.
    """

    start: str
    end: str
    tail: str
    head: str

    @property
    def name(self) -> str:
        """Both lines."""
        return f"{self.start} - {self.end} parallel to {self.tail} - {self.head}"

    @property
    def labels(self) -> tuple[str, ...]:
        """Told apart by the two coordinate planes."""
        return tuple(f"{self.name} ({plane})" for plane in ("yz", "xz"))

    def rows(self, layout: Layout) -> tuple[Row, ...]:
        """(y_e - y_s)(z_h - z_t) - (z_e - z_s)(y_h - y_t), then the same with x for y."""
        s, e, t, h = (layout.vector(name) for name in (self.start, self.end, self.tail, self.head))
        return tuple(
            (Product(1.0, (e[i], s[i]), (h[2], t[2])), Product(-1.0, (e[2], s[2]), (h[i], t[i])))
            for i in (1, 0)
        )
