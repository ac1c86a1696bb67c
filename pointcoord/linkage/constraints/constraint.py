r"""The kinds of constraint, each as rows of the quadratic map.

A constraint is data: the names of the points, directions and coordinates it ties together. Its rows
hold no numbers of a particular car; those are in y. p_a is the position of point a. What a kind needs in y
beside points, and how it reads that off a drawing, it knows itself.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pointcoord.errors import MechanismError
from pointcoord.linkage.drawing import Drawing, Placed
from pointcoord.linkage.layout import Layout, Triple
from pointcoord.numerics.double_double import exact_square
from pointcoord.numerics.quadratic import UNIT_ROUNDOFF, Product, Row

Array = NDArray[np.float64]

# How many lengths of its line a point may stand along it. With R of them, p_end turns by 1 / R of what the
# point goes, and R itself takes up the rest: X = C_u^-1 grows as R^2, X C_u bends as R^3 and the tangent as
# R, so that a proven step, 1 / sqrt(2 omega q) of `assembly`, shrinks as 1 / R^2. A turn of the paper's arm
# by 1 rad takes 0.036 R^2 steps; that is all of the 2000 that a path may have at R = 235.
FARTHEST = 235.0


class Constraint(ABC):
    """Named rows over a layout, and the coordinates of y that belong to them alone."""

    @property
    @abstractmethod
    def labels(self) -> tuple[str, ...]:
        """A name for each row, for messages."""

    @abstractmethod
    def rows(self, layout: Layout) -> tuple[Row, ...]:
        """The rows, in the order of the labels."""

    @property
    def vectors(self) -> tuple[str, ...]:
        """Unknown vectors that it brings along."""
        return ()

    @property
    def slides(self) -> tuple[str, ...]:
        """Unknown places along a line that it brings along."""
        return ()

    @property
    def constants(self) -> tuple[str, ...]:
        """Numbers of the drawing that its rows need."""
        return ()

    @property
    def squared_lengths(self) -> tuple[tuple[str, str], ...]:
        """Ends of the links whose squared length its rows need."""
        return ()

    @property
    def segments(self) -> tuple[tuple[str, str], ...]:
        """Pairs of points that a picture of the linkage joins."""
        return ()

    @property
    def may_lock(self) -> bool:
        """Whether it can be what a motion ends at."""
        return False

    @property
    def holds_a_body(self) -> bool:
        """Whether it only says how a body is made, and joins it to nothing."""
        return False

    @property
    def is_length(self) -> bool:
        """Whether its rows at the drawing are the components of a distance that the drawing misses."""
        return False

    def placed(self, layout: Layout, drawing: Drawing) -> tuple[Placed, ...]:
        """Its own coordinates as drawn.

        Raises:
            MechanismError: the drawing gives them no value.
        """
        return ()


def dot(a: Triple, b: Triple, c: Triple, d: Triple) -> Row:
    """(y_a - y_b) . (y_c - y_d) as products, for vectors given by their indices."""
    return tuple(Product(1.0, (a[i], b[i]), (c[i], d[i])) for i in range(3))


@dataclass(frozen=True)
class Link(Constraint):
    r"""Fixed distance: |p_start - p_end|^2 - d^2 = 0, d as drawn (paper eqs. 1-7). One row."""

    start: str
    end: str

    @property
    def labels(self) -> tuple[str, ...]:
        """One row."""
        return (f"link {self.start} - {self.end}",)

    @property
    def segments(self) -> tuple[tuple[str, str], ...]:
        """The link."""
        return ((self.start, self.end),)

    @property
    def may_lock(self) -> bool:
        """Where it lies in line with another."""
        return True

    def rows(self, layout: Layout) -> tuple[Row, ...]:
        """Quadratic in the difference of the ends."""
        start, end = layout.vector(self.start), layout.vector(self.end)
        square = layout.squared_length(self.start, self.end)
        length = Product(-1.0, (square, layout.zero), (layout.one, layout.zero))
        return ((*dot(start, end, start, end), length),)

    @property
    def squared_lengths(self) -> tuple[tuple[str, str], ...]:
        """Its own."""
        return ((self.start, self.end),)

    def placed(self, layout: Layout, drawing: Drawing) -> tuple[Placed, ...]:
        """The square of the drawn length; five units of rounding at most, which are measured."""
        start, end = drawing.vectors[self.start], drawing.vectors[self.end]
        square = np.sum((start - end) ** 2, axis=-1)
        if not (square > 0.0).all():
            raise no_length(self.start, self.end)
        exact, rest = exact_square(start, end)
        place = (layout.squared_length(self.start, self.end),)
        lacks = (exact - square) + rest
        doubt = 256 * UNIT_ROUNDOFF**2 * square
        return (Placed(place, square[..., None], lacks[..., None], doubt[..., None]),)


@dataclass(frozen=True)
class OnLine(Constraint):
    r"""A point on the line through two others, with the place along it as a coordinate of its own:

    p - p_start - ratio (p_end - p_start) = 0. Three rows and one unknown, no preferred axis, and
    ratio |p_end - p_start| is the distance along the line. Replaces the paper's eqs. (8)-(11).
    """

    point: str
    start: str
    end: str
    ratio: str

    @property
    def labels(self) -> tuple[str, ...]:
        """A row per axis."""
        return tuple(f"{self.point} on the line {self.start} - {self.end} ({axis})" for axis in "xyz")

    @property
    def segments(self) -> tuple[tuple[str, str], ...]:
        """The piece of the line up to the point."""
        return ((self.start, self.point),)

    def rows(self, layout: Layout) -> tuple[Row, ...]:
        """Bilinear in the ratio and the line's direction."""
        p, a, b = (layout.vector(name) for name in (self.point, self.start, self.end))
        ratio, zero, one = layout.scalar(self.ratio), layout.zero, layout.one
        return tuple(
            (Product(1.0, (p[i], a[i]), (one, zero)), Product(-1.0, (ratio, zero), (b[i], a[i])))
            for i in range(3)
        )

    @property
    def is_length(self) -> bool:
        """The point's distance from the line."""
        return True

    @property
    def slides(self) -> tuple[str, ...]:
        """The ratio."""
        return (self.ratio,)

    def placed(self, layout: Layout, drawing: Drawing) -> tuple[Placed, ...]:
        """The ratio of the point's foot on the drawn line."""
        start = drawing.vectors[self.start]
        line = drawing.vectors[self.end] - start
        reach = np.sum((drawing.vectors[self.point] - start) * line, axis=-1)
        square = np.sum(line * line, axis=-1)
        if not (square > 0.0).all():
            raise no_length(self.start, self.end)
        ratio = reach / square
        if (np.abs(ratio) > FARTHEST).any():
            raise self._ill_drawn(drawing, ratio)
        return (Placed((layout.scalar(self.ratio),), ratio[..., None]),)

    def _ill_drawn(self, drawing: Drawing, ratio: Array) -> MechanismError:
        """The error for a line whose two points are too close together for where the third one is."""
        far = int(np.argmax(np.abs(ratio)))
        apart = float((drawing.distance(self.start, self.end) * drawing.unit).flat[far])
        times = abs(float(ratio.flat[far]))
        return MechanismError(
            f"{self.start} and {self.end} are {apart:.3g} mm apart, and {self.point} is "
            f"{apart * times:.3g} mm along the line through them, {times:.3g} times as far, so that they do "
            f"not tell its direction well enough; allowed: at most {FARTHEST:g} times; draw {self.end} at "
            f"least {apart * times / FARTHEST:.2g} mm from {self.start}",
            [self.start, self.end, self.point],
        )


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
    def labels(self) -> tuple[str, ...]:
        """A row per axis."""
        return tuple(f"{self.point} on the rack ({axis})" for axis in "xyz")

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
    def labels(self) -> tuple[str, ...]:
        """One row."""
        return (f"rise of {self.point} over {self.pivot}",)

    def rows(self, layout: Layout) -> tuple[Row, ...]:
        """Bilinear in the arm and the direction, minus the driven height."""
        p, o, e = (layout.vector(name) for name in (self.point, self.pivot, self.direction))
        zeros: Triple = (layout.zero, layout.zero, layout.zero)
        driven = Product(-1.0, (layout.scalar(self.rise), layout.zero), (layout.one, layout.zero))
        return ((*dot(p, o, e, zeros), driven),)


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
    def labels(self) -> tuple[str, ...]:
        """Named by the two coordinate planes."""
        return tuple(
            f"{self.start} - {self.end} parallel to {self.tail} - {self.head} ({plane})"
            for plane in ("yz", "xz")
        )

    def rows(self, layout: Layout) -> tuple[Row, ...]:
        """(y_e - y_s)(z_h - z_t) - (z_e - z_s)(y_h - y_t), then the same with x for y."""
        s, e, t, h = (layout.vector(name) for name in (self.start, self.end, self.tail, self.head))
        return tuple(
            (Product(1.0, (e[i], s[i]), (h[2], t[2])), Product(-1.0, (e[2], s[2]), (h[i], t[i])))
            for i in (1, 0)
        )


def no_length(start: str, end: str) -> MechanismError:
    """The error for two points in one place that a length or a line needs apart."""
    return MechanismError(
        f"link {start} - {end} has no length: both points are at the same place; move one", [start, end]
    )
