r"""An axis that is fixed in a body, and points on it.

The body is known by three points with the edges e1 and e2 and the normal n = e1 x e2, an unknown of its own.
The axis has a direction d, an unknown too, which keeps its place in the body:

    n - e1 x e2 = 0,      d - a e1 - b e2 - c n = 0,

with constants a, b, c of the drawing. A point on the axis through a point o of the body is p = o + s d. All
rows are quadratic, and they keep their rank as long as the three points are not in one line: wherever the
axis passes, also along an edge of the triangle, where links to a fourth point of the body would lose it.
The length of d is between 1/2 and 1 of the mechanism's size, however close the points that it is drawn by.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pointcoord.errors import MechanismError
from pointcoord.linkage.constraints.constraint import Constraint, no_length
from pointcoord.linkage.drawing import Drawing, Placed
from pointcoord.linkage.layout import Layout
from pointcoord.numerics.double_double import exact_product, exact_square, exact_sum
from pointcoord.numerics.quadratic import UNIT_ROUNDOFF, Product, Row

Array = NDArray[np.float64]
Pair = tuple[Array, Array]
"""A number as high and low."""

# A product of pairs and a sum of four of them round some twenty times in units of u^2; three times that.
PAIRS = 64.0 * UNIT_ROUNDOFF**2
# A product with the inverse of a 3 x 3 matrix, and that inverse, round some twenty times relative.
SOLVED = 32.0 * UNIT_ROUNDOFF


@dataclass(frozen=True)
class Normal(Constraint):
    r"""The normal of a body's triangle: n - (p_first - p_base) x (p_second - p_base) = 0. Three rows."""

    normal: str
    base: str
    first: str
    second: str

    @property
    def labels(self) -> tuple[str, ...]:
        """A row per axis."""
        return tuple(f"{self.normal} ({axis})" for axis in "xyz")

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


@dataclass(frozen=True)
class AxisInBody(Constraint):
    r"""An axis drawn from `tail` to `head` that the body of a triangle carries. Three rows.

    d - a (p_first - p_base) - b (p_second - p_base) - c n = 0 with d along p_head - p_tail as drawn.
    """

    axis: str
    tail: str
    head: str
    normal: Normal

    @property
    def labels(self) -> tuple[str, ...]:
        """A row per axis."""
        return tuple(f"{self.axis} ({axis})" for axis in "xyz")

    @property
    def vectors(self) -> tuple[str, ...]:
        """The direction."""
        return (self.axis,)

    @property
    def constants(self) -> tuple[str, ...]:
        """Its place in the body: a, b and c."""
        body = self.normal
        return tuple(f"{self.axis} along {part}" for part in (body.first, body.second, body.normal))

    @property
    def holds_a_body(self) -> bool:
        """It does."""
        return True

    def rows(self, layout: Layout) -> tuple[Row, ...]:
        """Bilinear in the constants and the edges."""
        body = self.normal
        d, o, p, q, n = (
            layout.vector(name) for name in (self.axis, body.base, body.first, body.second, body.normal)
        )
        a, b, c = (layout.scalar(name) for name in self.constants)
        zero, one = layout.zero, layout.one
        return tuple(
            (
                Product(1.0, (d[i], zero), (one, zero)),
                Product(-1.0, (a, zero), (p[i], o[i])),
                Product(-1.0, (b, zero), (q[i], o[i])),
                Product(-1.0, (c, zero), (n[i], zero)),
            )
            for i in range(3)
        )

    def placed(self, layout: Layout, drawing: Drawing) -> tuple[Placed, ...]:
        """The drawn direction and its constants, with what they lack by rounding.

        Raises:
            MechanismError: the axis has no direction, or the triangle is flat.
        """
        body = self.normal
        direction = scaled_axis(drawing, self.tail, self.head)
        base, first, second = (drawing.vectors[name] for name in (body.base, body.first, body.second))
        edges = (exact_sum(first, -base), exact_sum(second, -base))
        columns = (*edges, _cross(*edges))
        frame = np.stack(np.broadcast_arrays(*(high for high, _ in columns)), axis=-1)
        lengths = np.linalg.norm(edges[0][0], axis=-1) * np.linalg.norm(edges[1][0], axis=-1)
        area = np.linalg.norm(columns[2][0], axis=-1)
        if not (area > 16 * UNIT_ROUNDOFF * lengths).all():
            names = (body.base, body.first, body.second)
            raise MechanismError(
                f"{', '.join(names)} lie in one line, so they cannot carry the {self.axis}; "
                "move one off the line",
                names,
            )
        inverse = np.linalg.inv(frame)
        high, _ = direction
        weights = _applied(inverse, np.broadcast_to(high, frame.shape[:-1]))
        rest, size = _unexplained(direction, columns, weights)
        weights = weights + _applied(inverse, rest)
        rest, size = _unexplained(direction, columns, weights)
        values, lacks = exact_sum(weights, _applied(inverse, rest))
        spread = np.abs(inverse)
        again = _applied(np.abs(frame), _applied(spread, np.abs(rest)))
        doubt = _applied(spread, PAIRS * size + SOLVED * again) + PAIRS * np.abs(values)
        places = tuple(layout.scalar(name) for name in self.constants)
        return (Placed(layout.vector(self.axis), high), Placed(places, values, lacks, doubt))


@dataclass(frozen=True)
class OnAxis(Constraint):
    r"""A point that slides along an axis: p - p_origin - s d = 0. Three rows and one unknown, the place s."""

    point: str
    origin: str
    axis: str
    place: str

    @property
    def labels(self) -> tuple[str, ...]:
        """A row per axis."""
        return tuple(f"{self.point} on the {self.axis} ({axis})" for axis in "xyz")

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
    def labels(self) -> tuple[str, ...]:
        """A row per axis."""
        return tuple(f"{self.point} on the {self.axis.axis} ({axis})" for axis in "xyz")

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
        return OnAxis(self.point, self.origin, self.axis.axis, self.place).rows(layout)

    def placed(self, layout: Layout, drawing: Drawing) -> tuple[Placed, ...]:
        """r with r^2 = |p - p_origin|^2 / |d|^2, and what it lacks by rounding."""
        tail, head = (drawing.vectors[name] for name in (self.axis.tail, self.axis.head))
        scale = _axis_scale(drawing, self.axis.tail, self.axis.head)
        far, near = drawing.vectors[self.point], drawing.vectors[self.origin]
        (reach, reach_rest), (square, square_rest) = exact_square(far, near), exact_square(head, tail)
        square, square_rest = square * scale * scale, square_rest * scale * scale
        side = np.where(np.sum((far - near) * (head - tail), axis=-1) < 0.0, -1.0, 1.0)
        place = np.sqrt(reach / square)
        own, own_rest = exact_product(place, place)
        held, held_rest = exact_product(own, square)
        rest = (reach - held) + (reach_rest - held_rest - own * square_rest - own_rest * square)
        with np.errstate(divide="ignore", invalid="ignore"):
            lacks = np.where(place > 0.0, rest / (2.0 * place * square), 0.0)
        values = (side * place)[..., None]
        doubt = PAIRS * np.abs(values)
        return (Placed((layout.scalar(self.place),), values, (side * lacks)[..., None], doubt),)


def scaled_axis(drawing: Drawing, tail: str, head: str) -> Pair:
    """The drawn direction from tail to head, as high and low, of a length between 1/2 and 1.

    Raises:
        MechanismError: both points are in one place.
    """
    scale = _axis_scale(drawing, tail, head)[..., None]
    high, low = exact_sum(drawing.vectors[head], -drawing.vectors[tail])
    return high * scale, low * scale


def _axis_scale(drawing: Drawing, tail: str, head: str) -> Array:
    """The power of two that brings the drawn distance between 1/2 and 1, shape (...,)."""
    length = drawing.distance(tail, head)
    if not (length > 0.0).all():
        raise no_length(tail, head)
    return np.ldexp(1.0, -np.frexp(length)[1])


def _applied(matrix: Array, vector: Array) -> Array:
    return np.asarray((matrix @ vector[..., None])[..., 0])


def _times(a: Pair, b: Pair) -> Pair:
    high, low = exact_product(*np.broadcast_arrays(a[0], b[0]))
    return high, low + (a[0] * b[1] + a[1] * b[0])


def _plus(a: Pair, b: Pair) -> Pair:
    high, low = exact_sum(*np.broadcast_arrays(a[0], b[0]))
    return high, low + (a[1] + b[1])


def _minus(a: Pair) -> Pair:
    return -a[0], -a[1]


def _cross(a: Pair, b: Pair) -> Pair:
    """a x b of vectors given as pairs, shape (..., 3)."""
    (ax, ay, az), (bx, by, bz) = ([(high[..., i], low[..., i]) for i in range(3)] for high, low in (a, b))
    parts = [
        _plus(_times(ay, bz), _minus(_times(az, by))),
        _plus(_times(az, bx), _minus(_times(ax, bz))),
        _plus(_times(ax, by), _minus(_times(ay, bx))),
    ]
    high, low = (np.stack([part[i] for part in parts], axis=-1) for i in (0, 1))
    # The sums of products may cancel, so their low parts are brought below the high ones again.
    return exact_sum(high, low)


def _unexplained(vector: Pair, columns: tuple[Pair, Pair, Pair], weights: Array) -> tuple[Array, Array]:
    """vector - sum weights columns, rounded once, and the sum of the magnitudes it is made of; (..., 3)."""
    total, size = vector, np.abs(vector[0])
    for i, column in enumerate(columns):
        weight = weights[..., i, None]
        part = _times((weight, np.zeros_like(weight)), column)
        total, size = _plus(total, _minus(part)), size + np.abs(part[0])
    edges = np.abs(columns[0][0])[..., [1, 2, 0]], np.abs(columns[1][0])[..., [2, 0, 1]]
    others = np.abs(columns[0][0])[..., [2, 0, 1]], np.abs(columns[1][0])[..., [1, 2, 0]]
    crossed = edges[0] * edges[1] + others[0] * others[1]
    return total[0] + total[1], size + np.abs(weights[..., 2, None]) * crossed
