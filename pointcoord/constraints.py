r"""The kinds of constraint, each as rows of the quadratic map.

A constraint is data: the names of the points, directions and coordinates it ties together. Its rows
hold no numbers of a particular car; those are in y. p_a is the position of point a.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from pointcoord.layout import Layout, Triple
from pointcoord.quadratic import Product, Row


class Constraint(Protocol):
    """Named rows over a layout."""

    @property
    def labels(self) -> tuple[str, ...]:
        """A name for each row, for messages."""
        ...

    def rows(self, layout: Layout) -> tuple[Row, ...]:
        """The rows, in the order of the labels."""
        ...


def _dot(a: Triple, b: Triple, c: Triple, d: Triple) -> Row:
    """(y_a - y_b) . (y_c - y_d) as products, for vectors given by their indices."""
    return tuple(Product(1.0, (a[i], b[i]), (c[i], d[i])) for i in range(3))


@dataclass(frozen=True)
class Link:
    r"""Fixed distance: |p_start - p_end|^2 - d^2 = 0, d as drawn (paper eqs. 1-7). One row."""

    start: str
    end: str

    @property
    def labels(self) -> tuple[str, ...]:
        """One row."""
        return (f"link {self.start} - {self.end}",)

    def rows(self, layout: Layout) -> tuple[Row, ...]:
        """Quadratic in the difference of the ends."""
        start, end = layout.vector(self.start), layout.vector(self.end)
        square = layout.squared_length(self.start, self.end)
        length = Product(-1.0, (square, layout.zero), (layout.one, layout.zero))
        return ((*_dot(start, end, start, end), length),)


@dataclass(frozen=True)
class OnLine:
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

    def rows(self, layout: Layout) -> tuple[Row, ...]:
        """Bilinear in the ratio and the line's direction."""
        p, a, b = (layout.vector(name) for name in (self.point, self.start, self.end))
        ratio, zero, one = layout.scalar(self.ratio), layout.zero, layout.one
        return tuple(
            (Product(1.0, (p[i], a[i]), (one, zero)), Product(-1.0, (ratio, zero), (b[i], a[i])))
            for i in range(3)
        )


@dataclass(frozen=True)
class Rack:
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

    def rows(self, layout: Layout) -> tuple[Row, ...]:
        """Bilinear in the travel and the direction, which both are known."""
        p, o, e = (layout.vector(name) for name in (self.point, self.origin, self.direction))
        travel, zero, one = layout.scalar(self.travel), layout.zero, layout.one
        return tuple(
            (Product(1.0, (p[i], o[i]), (one, zero)), Product(1.0, (travel, zero), (e[i], zero)))
            for i in range(3)
        )


@dataclass(frozen=True)
class Rise:
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
        return ((*_dot(p, o, e, zeros), driven),)


@dataclass(frozen=True)
class PrintedParallel:
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
