"""Two points at a fixed distance."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from pointcoord.linkage.constraints.constraint import Constraint, dot
from pointcoord.linkage.drawing import Drawing, Placed, no_length
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

    @property
    def squared_lengths(self) -> tuple[tuple[str, str], ...]:
        return ((self.start, self.end),)

    @property
    def constants(self) -> tuple[str, ...]:
        """d^2."""
        return (f"squared length of {self.name}",)

    def rows(self, layout: Layout) -> tuple[Row, ...]:
        edge = layout.edge(self.start, self.end)
        return ((*dot(edge, edge), Product(-1.0, layout.number(*self.constants), layout.number())),)

    def placed(self, drawing: Drawing) -> Mapping[str, Placed]:
        """The square of the drawn length; five units of rounding at most, which are measured.

        Raises:
            MechanismError: both points are in one place.
        """
        start, end = drawing.vectors[self.start], drawing.vectors[self.end]
        square = np.sum((start - end) ** 2, axis=-1)
        if not (square > 0.0).all():
            raise no_length(self.start, self.end)
        exact, rest = exact_square(start, end)
        doubt = 256 * UNIT_ROUNDOFF**2 * square
        return {self.constants[0]: Placed(square, (exact - square) + rest, doubt)}
