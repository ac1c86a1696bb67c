"""A point that slides along a line, of a body or of the chassis, driven or free."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pointcoord.linkage.constraints.axis_in_body import AxisInBody, axis_length, scaled_axis
from pointcoord.linkage.constraints.constraint import Constraint, per_axis
from pointcoord.linkage.drawing import Drawing, Placed
from pointcoord.linkage.layout import Layout
from pointcoord.numerics.double_double import Pair
from pointcoord.numerics.quadratic import Product, Row

Array = NDArray[np.float64]


class Sliding(Constraint):
    """A point on a line: p - p_origin - place d = 0, three rows. A place that is not driven is an unknown."""

    point: str
    origin: str
    place: str
    driven: bool

    @property
    def labels(self) -> tuple[str, ...]:
        """A row per axis."""
        return per_axis(self.name)

    @property
    def slides(self) -> tuple[str, ...]:
        """The place, unless it is driven."""
        return () if self.driven else (self.place,)

    @abstractmethod
    def direction(self, layout: Layout) -> Sequence[int]:
        """The places of d in y."""

    @abstractmethod
    def drawn(self, drawing: Drawing) -> Pair:
        """d of the drawing as high and low."""

    def rows(self, layout: Layout) -> tuple[Row, ...]:
        """Bilinear in the place and the direction."""
        p, o, d = layout.vector(self.point), layout.vector(self.origin), self.direction(layout)
        place, zero, one = layout.scalar(self.place), layout.zero, layout.one
        return tuple(
            (Product(1.0, (p[i], o[i]), (one, zero)), Product(-1.0, (place, zero), (d[i], zero)))
            for i in range(3)
        )

    def placed(self, layout: Layout, drawing: Drawing) -> tuple[Placed, ...]:
        """The place of the point's foot on the line, where that is free."""
        return tuple(Placed((layout.scalar(s),), self.foot(drawing)[..., None]) for s in self.slides)

    def foot(self, drawing: Drawing) -> Array:
        """The place at which the drawn point's foot on the line is, shape (...,)."""
        high, _ = self.drawn(drawing)
        line = drawing.vectors[self.point] - drawing.vectors[self.origin]
        return np.asarray(np.sum(line * high, axis=-1) / np.sum(high * high, axis=-1))


@dataclass(frozen=True)
class OnAxis(Sliding):
    """A point that slides along an axis of a body."""

    point: str
    origin: str
    axis: AxisInBody
    place: str
    driven: bool = False

    @property
    def name(self) -> str:
        """The point and the axis."""
        return f"{self.point} on the {self.axis.axis}"

    @property
    def segments(self) -> tuple[tuple[str, str], ...]:
        """From the origin of the axis to the point."""
        return ((self.origin, self.point),)

    @property
    def may_lock(self) -> bool:
        """Where what it holds lies square to the axis."""
        return True

    def direction(self, layout: Layout) -> Sequence[int]:
        """The axis' own coordinates."""
        return layout.vector(self.axis.axis)

    def drawn(self, drawing: Drawing) -> Pair:
        """From the tail of the axis to its head."""
        return scaled_axis(drawing, self.axis.tail, self.axis.head)

    def length(self, drawing: Drawing) -> Pair:
        """|d| as high and low."""
        return axis_length(drawing, self.axis.tail, self.axis.head)


@dataclass(frozen=True)
class OnChassisLine(Sliding):
    """A point on a line of the chassis (paper eqs. 13-15, any direction).

    d is a direction of the car (with no `tail`, `head` names it), or runs from where the tail is drawn to
    where the head is, as constants.
    """

    point: str
    origin: str
    line: str
    tail: str
    head: str
    place: str
    driven: bool

    @property
    def name(self) -> str:
        """The point and the line."""
        return f"{self.point} on the {self.line}"

    @property
    def constants(self) -> tuple[str, ...]:
        """The direction, where it is drawn between two points."""
        return tuple(f"{axis} of {self.line} at {self.point}" for axis in "xyz") if self.tail else ()

    @property
    def is_length(self) -> bool:
        """The point's distance from the line."""
        return True

    @property
    def may_lock(self) -> bool:
        """Where what it holds lies square to the line, and nothing drives it."""
        return not self.driven

    def direction(self, layout: Layout) -> Sequence[int]:
        """Known coordinates."""
        return [layout.scalar(name) for name in self.constants] or layout.vector(self.head)

    def drawn(self, drawing: Drawing) -> Pair:
        """From the tail to the head, or the direction of the car."""
        return scaled_axis(drawing, self.tail, self.head) if self.tail else drawing.pair(self.head)

    def placed(self, layout: Layout, drawing: Drawing) -> tuple[Placed, ...]:
        """The direction too, where it is drawn."""
        own = super().placed(layout, drawing)
        if not self.tail:
            return own
        return (Placed(tuple(layout.scalar(name) for name in self.constants), *self.drawn(drawing)), *own)

    def length(self, drawing: Drawing) -> Pair:
        """|d| as high and low; of a direction of the car exactly 1."""
        if self.tail:
            return axis_length(drawing, self.tail, self.head)
        return np.ones_like(drawing.unit), np.zeros_like(drawing.unit)
