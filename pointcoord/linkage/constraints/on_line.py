"""A point on a line of a body or of the chassis, where it slides, is driven or is held."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pointcoord.errors import MechanismError
from pointcoord.linkage.constraints.constraint import Constraint, no_length
from pointcoord.linkage.constraints.in_body import AxisInBody, scaled_axis
from pointcoord.linkage.drawing import Drawing, Placed
from pointcoord.linkage.layout import Layout
from pointcoord.numerics.double_double import (
    PAIRS,
    Pair,
    exact_square,
    pair_dot,
    pair_root,
    two_product,
    two_sum,
)
from pointcoord.numerics.quadratic import Product, Row

Array = NDArray[np.float64]

# How many lengths of its line a point may stand along it. With R of them, p_end turns by 1 / R of what the
# point goes, and R itself takes up the rest: X = C_u^-1 grows as R^2, X C_u bends as R^3 and the tangent as
# R, so that a proven step, 1 / sqrt(2 omega q) of `assembly`, shrinks as 1 / R^2. A turn of the paper's arm
# by 1 rad takes 0.036 R^2 steps; that is all of the 2000 that a path may have at R = 235.
FARTHEST = 235.0


class Sliding(Constraint):
    """p - p_origin - place d = 0, d a vector of the line. Three rows; the place is an unknown, or driven."""

    point: str
    origin: str
    place: str
    driven: bool

    along_axes = True

    @property
    def slides(self) -> tuple[str, ...]:
        return () if self.driven else (self.place,)

    @abstractmethod
    def direction(self, layout: Layout) -> tuple[Sequence[int], Sequence[int]]:
        """Coordinates of y whose difference is d."""

    @abstractmethod
    def drawn(self, drawing: Drawing) -> Pair:
        """d of the drawing as high and low, (..., 3)."""

    def length(self, drawing: Drawing) -> Pair:
        """|d| as high and low, (...,)."""
        d = self.drawn(drawing)
        return pair_root(pair_dot(d, d))

    def rows(self, layout: Layout) -> tuple[Row, ...]:
        p, o, (d, e) = layout.vector(self.point), layout.vector(self.origin), self.direction(layout)
        place, zero, one = layout.scalar(self.place), layout.zero, layout.one
        return tuple(
            (Product(1.0, (p[i], o[i]), (one, zero)), Product(-1.0, (place, zero), (d[i], e[i])))
            for i in range(3)
        )

    def placed(self, layout: Layout, drawing: Drawing) -> tuple[Placed, ...]:
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

    may_lock = True  # where what it holds lies square to the axis

    @property
    def name(self) -> str:
        return f"{self.point} on the {self.axis.axis}"

    @property
    def segments(self) -> tuple[tuple[str, str], ...]:
        return ((self.origin, self.point),)

    def direction(self, layout: Layout) -> tuple[Sequence[int], Sequence[int]]:
        return layout.vector(self.axis.axis), (layout.zero,) * 3

    def drawn(self, drawing: Drawing) -> Pair:
        return scaled_axis(drawing, self.axis.tail, self.axis.head)


@dataclass(frozen=True)
class HeldOnAxis(OnAxis):
    r"""A point held on an axis at its drawn distance from the origin: its place r is a constant.

    r |d| is the drawn distance, to the side of the origin on which the point is drawn.
    """

    may_lock = False
    is_length = True  # the point's distance from its place

    @property
    def slides(self) -> tuple[str, ...]:
        return ()

    @property
    def constants(self) -> tuple[str, ...]:
        return (self.place,)

    def placed(self, layout: Layout, drawing: Drawing) -> tuple[Placed, ...]:
        """r with r^2 = |p - p_origin|^2 / |d|^2, and what it lacks by rounding.

        Raises:
            MechanismError: the two points are drawn in one place.
        """
        far, near = drawing.vectors[self.point], drawing.vectors[self.origin]
        reach, reach_rest = exact_square(far, near)
        if not (reach > 0.0).all():
            raise no_length(self.origin, self.point)
        d = self.drawn(drawing)
        square, square_rest = pair_dot(d, d)
        side = np.where(np.sum((far - near) * d[0], axis=-1) < 0.0, -1.0, 1.0)
        place = np.sqrt(reach / square)
        own, own_rest = two_product(place, place)
        held, held_rest = two_product(own, square)
        rest = (reach - held) + (reach_rest - held_rest - own * square_rest - own_rest * square)
        lacks = rest / (2.0 * place * square)
        values = (side * place)[..., None]
        doubt = PAIRS * np.abs(values)
        return (Placed((layout.scalar(self.place),), values, (side * lacks)[..., None], doubt),)


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

    is_length = True  # the point's distance from the line

    @property
    def name(self) -> str:
        return f"{self.point} on the {self.line}"

    @property
    def constants(self) -> tuple[str, ...]:
        """The direction, where it is drawn between two points."""
        return tuple(f"{axis} of {self.line} at {self.point}" for axis in "xyz") if self.tail else ()

    @property
    def may_lock(self) -> bool:
        """Where what it holds lies square to the line, and nothing drives it."""
        return not self.driven

    def direction(self, layout: Layout) -> tuple[Sequence[int], Sequence[int]]:
        known = [layout.scalar(name) for name in self.constants] or layout.vector(self.head)
        return known, (layout.zero,) * 3

    def drawn(self, drawing: Drawing) -> Pair:
        return scaled_axis(drawing, self.tail, self.head) if self.tail else drawing.pair(self.head)

    def placed(self, layout: Layout, drawing: Drawing) -> tuple[Placed, ...]:
        own = super().placed(layout, drawing)
        if not self.tail:
            return own
        return (Placed(tuple(layout.scalar(name) for name in self.constants), *self.drawn(drawing)), *own)


@dataclass(frozen=True)
class OnLine(Sliding):
    r"""A point on the line through two others: p - p_start - ratio (p_end - p_start) = 0.

    No preferred axis, and ratio |p_end - p_start| is the distance along the line. Replaces the paper's
    eqs. (8)-(11).
    """

    point: str
    origin: str
    end: str
    place: str
    driven: bool = False

    is_length = True  # the point's distance from the line

    @property
    def name(self) -> str:
        return f"{self.point} on the line {self.origin} - {self.end}"

    @property
    def aligned(self) -> tuple[str, str, str]:
        return (self.origin, self.end, self.point)

    @property
    def segments(self) -> tuple[tuple[str, str], ...]:
        return ((self.origin, self.point),)

    def direction(self, layout: Layout) -> tuple[Sequence[int], Sequence[int]]:
        return layout.vector(self.end), layout.vector(self.origin)

    def drawn(self, drawing: Drawing) -> Pair:
        """The same as drawn.

        Raises:
            MechanismError: both points are in one place.
        """
        line = two_sum(drawing.vectors[self.end], -drawing.vectors[self.origin])
        if not ((line[0] ** 2).sum(axis=-1) > 0.0).all():
            raise no_length(self.origin, self.end)
        return line

    def placed(self, layout: Layout, drawing: Drawing) -> tuple[Placed, ...]:
        """The ratio of the point's foot on the drawn line.

        Raises:
            MechanismError: the line's two points are too close together for where the third one is.
        """
        ratio = np.abs(self.foot(drawing))
        if not (ratio > FARTHEST).any():
            return super().placed(layout, drawing)
        times = float(ratio.max())
        apart = float((drawing.distance(self.origin, self.end) * drawing.unit).flat[int(np.argmax(ratio))])
        raise MechanismError(
            f"{self.origin} and {self.end} are {apart:.3g} mm apart, and {self.point} is "
            f"{apart * times:.3g} mm along the line through them, {times:.3g} times as far, so that they do "
            f"not tell its direction well enough; allowed: at most {FARTHEST:g} times; draw {self.end} at "
            f"least {apart * times / FARTHEST:.2g} mm from {self.origin}",
            [self.origin, self.end, self.point],
        )
