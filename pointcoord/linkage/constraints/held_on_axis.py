"""A point that stays in its place on an axis of a body."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pointcoord.linkage.constraints.axis_in_body import AxisInBody, axis_square, scaled_axis
from pointcoord.linkage.constraints.constraint import Constraint, no_length, per_axis
from pointcoord.linkage.constraints.on_axis import OnAxis
from pointcoord.linkage.drawing import Drawing, Placed
from pointcoord.linkage.layout import Layout
from pointcoord.numerics.double_double import PAIRS, exact_square, two_product
from pointcoord.numerics.quadratic import Row


@dataclass(frozen=True)
class HeldOnAxis(Constraint):
    r"""A point held on an axis at its drawn distance from another: p - p_origin - r d = 0. Three rows.

    r |d| is the drawn distance, to the side of the origin on which the point is drawn. `tail` and `head` are
    the points that the axis is drawn by.
    """

    point: str
    origin: str
    axis: AxisInBody
    place: str

    @property
    def name(self) -> str:
        """The point and the axis."""
        return f"{self.point} on the {self.axis.axis}"

    @property
    def labels(self) -> tuple[str, ...]:
        """A row per axis."""
        return per_axis(self.name)

    @property
    def constants(self) -> tuple[str, ...]:
        """The place."""
        return (self.place,)

    @property
    def is_length(self) -> bool:
        """The point's distance from its place on the axis."""
        return True

    @property
    def segments(self) -> tuple[tuple[str, str], ...]:
        """From the other point to this one."""
        return ((self.origin, self.point),)

    def rows(self, layout: Layout) -> tuple[Row, ...]:
        """Linear in the direction, which is unknown; the place is known."""
        return OnAxis(self.point, self.origin, self.axis, self.place).rows(layout)

    def placed(self, layout: Layout, drawing: Drawing) -> tuple[Placed, ...]:
        """r with r^2 = |p - p_origin|^2 / |d|^2, and what it lacks by rounding.

        Raises:
            MechanismError: the two points are drawn in one place.
        """
        far, near = drawing.vectors[self.point], drawing.vectors[self.origin]
        reach, reach_rest = exact_square(far, near)
        if not (reach > 0.0).all():
            raise no_length(self.origin, self.point)
        square, square_rest = axis_square(drawing, self.axis.tail, self.axis.head)
        direction = scaled_axis(drawing, self.axis.tail, self.axis.head)[0]
        side = np.where(np.sum((far - near) * direction, axis=-1) < 0.0, -1.0, 1.0)
        place = np.sqrt(reach / square)
        own, own_rest = two_product(place, place)
        held, held_rest = two_product(own, square)
        rest = (reach - held) + (reach_rest - held_rest - own * square_rest - own_rest * square)
        lacks = rest / (2.0 * place * square)
        values = (side * place)[..., None]
        doubt = PAIRS * np.abs(values)
        return (Placed((layout.scalar(self.place),), values, (side * lacks)[..., None], doubt),)
