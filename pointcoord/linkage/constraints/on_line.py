"""A point on a line of a body or of the chassis, where it slides, is driven or is held."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from pointcoord.errors import MechanismError
from pointcoord.linkage.constraints.constraint import Constraint
from pointcoord.linkage.constraints.in_body import AxisInBody
from pointcoord.linkage.drawing import Drawing, Placed, no_length
from pointcoord.linkage.layout import Layout
from pointcoord.numerics.double_double import PAIRS, Pair, exact_square, pair_dot, pair_root, two_product
from pointcoord.numerics.quadratic import Product, Row

Array = NDArray[np.float64]

# How many lengths of its line a point may stand along it. With R of them, p_end turns by 1 / R of what the
# point goes, and R itself takes up the rest: X = C_u^-1 grows as R^2, X C_u bends as R^3 and the tangent as
# R, so that a proven step, 1 / sqrt(2 omega q) of `assembly`, shrinks as 1 / R^2. A turn of the paper's arm
# by 1 rad takes 0.036 R^2 steps; that is all of the 2000 that a path may have at R = 235.
FARTHEST = 235.0


@dataclass(frozen=True)
class OnLine(Constraint):
    r"""p - p_origin - place d = 0, d along the line. Three rows (paper eqs. 13-15, for any direction).

    Of a line through two points that move, d = p_head - p_origin: no preferred axis, and place |d| is the
    distance along the line (replaces the paper's eqs. 8-11). Elsewhere d is a vector by the name of `head`,
    an axis that a body carries or a direction of the chassis.

    Attributes:
        line: its name in messages.
        between: whether it runs through the points `origin` and `head`.
        place: where along it the point is, in lengths of d.
        at: whether the place is free, an unknown; driven; or held as drawn, a constant.
        axis: the body's axis, if it is one.
    """

    point: str
    origin: str
    line: str
    head: str
    place: str
    at: Literal["free", "driven", "held"] = "free"
    between: bool = False
    axis: AxisInBody | None = None

    along_axes = True
    is_length = True  # the point's distance from the line or from its place on it

    @property
    def name(self) -> str:
        return f"{self.point} on the {self.line}"

    @property
    def slides(self) -> tuple[str, ...]:
        return (self.place,) if self.at == "free" else ()

    @property
    def constants(self) -> tuple[str, ...]:
        return (self.place,) if self.at == "held" else ()

    @property
    def aligned(self) -> tuple[()] | tuple[str, str, str]:
        return (self.origin, self.head, self.point) if self.between else ()

    @property
    def segments(self) -> tuple[tuple[str, str], ...]:
        return ((self.origin, self.point),) if self.between or self.axis else ()

    @property
    def may_lock(self) -> bool:
        """Where what it holds lies square to the line, and nothing drives it."""
        return self.at == "free" and not self.between

    def rows(self, layout: Layout) -> tuple[Row, ...]:
        p, o = layout.edge(self.point, self.origin)
        d, e = layout.edge(self.head, self.origin if self.between else "")
        one, place = layout.number(), layout.number(self.place)
        return tuple((Product(1.0, (p[i], o[i]), one), Product(-1.0, place, (d[i], e[i]))) for i in range(3))

    def placed(self, drawing: Drawing) -> Mapping[str, Placed]:
        """The place of the point, if it is not driven.

        Raises:
            MechanismError: the drawing does not tell the line, or not well enough for where the point is.
        """
        if self.at == "driven":
            return {}
        if self.at == "held":
            return {self.place: self._held(drawing)}
        place = self.foot(drawing)
        if self.between:
            self._require_near(drawing, np.abs(place))
        return {self.place: Placed(place)}

    def drawn(self, drawing: Drawing) -> Pair:
        """d of the drawing as high and low, (..., 3).

        Raises:
            MechanismError: the line has no direction.
        """
        if self.axis:
            return drawing.axis(self.axis.tail, self.axis.head)
        line = drawing.edge(self.head, self.origin if self.between else "")
        if not ((line[0] ** 2).sum(axis=-1) > 0.0).all():
            raise no_length(self.origin, self.head)
        return line

    def length(self, drawing: Drawing) -> Pair:
        """|d| as high and low, (...,)."""
        d = self.drawn(drawing)
        return pair_root(pair_dot(d, d))

    def foot(self, drawing: Drawing) -> Array:
        """The place at which the drawn point's foot on the line is, shape (...,)."""
        high, _ = self.drawn(drawing)
        line = drawing.vectors[self.point] - drawing.vectors[self.origin]
        return np.asarray(np.sum(line * high, axis=-1) / np.sum(high * high, axis=-1))

    def _held(self, drawing: Drawing) -> Placed:
        """r with r^2 = |p - p_origin|^2 / |d|^2, to the side of the origin on which the point is drawn."""
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
        return Placed(side * place, side * rest / (2.0 * place * square), PAIRS * place)

    def _require_near(self, drawing: Drawing, ratio: Array) -> None:
        """Refuse a point that is too many lengths of its line away."""
        if not (ratio > FARTHEST).any():
            return
        times = float(ratio.max())
        apart = float((drawing.distance(self.origin, self.head) * drawing.unit).flat[int(np.argmax(ratio))])
        raise MechanismError(
            f"{self.origin} and {self.head} are {apart:.3g} mm apart, and {self.point} is "
            f"{apart * times:.3g} mm along the line through them, {times:.3g} times as far, so that they do "
            f"not tell its direction well enough; allowed: at most {FARTHEST:g} times; draw {self.head} at "
            f"least {apart * times / FARTHEST:.2g} mm from {self.origin}",
            [self.origin, self.head, self.point],
        )
