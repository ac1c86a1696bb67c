"""A point on a line of a body or of the chassis: free to slide, driven along the line, or held at a place."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Literal, NamedTuple

import numpy as np

from pointcoord.errors import MechanismError
from pointcoord.linkage.constraints.constraint import ONE, Constraint, Edge, Equation, Term
from pointcoord.linkage.constraints.in_body import Axis
from pointcoord.linkage.drawing import Drawing, Placed, no_length
from pointcoord.numerics.arrays import Array
from pointcoord.numerics.double_double import PAIRS, Pair, exact_square, pair_dot, pair_root, two_product

# How many lengths of its line a point may stand from the line's origin. With R lengths, p_end moves by 1 / R
# of the point's movement, and R itself must take up the rest: X = C_u^-1 grows as R^2, the curvature X C_u as
# R^3 and the tangent as R. So a proven step, 1 / sqrt(2 omega q) of `assembly`, shrinks as 1 / R^2. A
# rotation of the paper's arm by 1 rad takes 0.036 R^2 steps, which reaches the limit of 2000 steps at R =
# 235.
FARTHEST = 235.0


class Line(NamedTuple):
    """A line through the point `origin`, along d.

    If the line runs through two moving points, d = p_head - p_origin: no preferred axis, and place |d| is the
    distance along the line (replaces the paper's eqs. 8-11). Otherwise d is the vector named `head`: an axis
    of a body or a direction of the chassis.

    Attributes:
        name: in messages. between: whether it runs through the points `origin` and `head`.
        axis: the body's axis, if it is one. slide: name of the slide it belongs to.
    """

    name: str
    origin: str
    head: str
    between: bool = False
    axis: Axis | None = None
    slide: str = ""

    @property
    def along(self) -> Edge:
        """The vector d along the line, as an edge."""
        return self.head, self.origin if self.between else ""

    def drawn(self, drawing: Drawing) -> Pair:
        """The drawn d as high and low part, (..., 3).

        Raises:
            MechanismError: the line has no direction.
        """
        if self.axis:
            return drawing.axis(self.axis.tail, self.axis.head)
        line = drawing.edge(*self.along)
        if not ((line[0] ** 2).sum(axis=-1) > 0.0).all():
            raise no_length(self.origin, self.head)
        return line

    def length(self, drawing: Drawing) -> Pair:
        """|d| as high and low part, (...,)."""
        d = self.drawn(drawing)
        return pair_root(pair_dot(d, d))

    def foot(self, point: str, drawing: Drawing) -> Array:
        """Place of the foot of a drawn point on the line, in lengths of d, shape (...,)."""
        high, _ = self.drawn(drawing)
        line = drawing.vectors[point] - drawing.vectors[self.origin]
        return np.asarray(np.sum(line * high, axis=-1) / np.sum(high * high, axis=-1))


def on_line(point: str, line: Line, place: str, at: Literal["free", "driven", "held"] = "free") -> Constraint:
    r"""p - p_origin - place d = 0, d along the line. Three rows (paper eqs. 13-15, for any direction).

    Args:
        place: name of the point's place along the line, in lengths of d.
        at: whether the place is "free", an unknown; "driven"; or "held" as drawn, a constant.
    """
    name = f"{point} on the {line.name}"
    terms = Term(1.0, (point, line.origin), ONE), Term(-1.0, place, line.along)
    return Constraint(
        name,
        (Equation(name, terms),),
        partial(_placed, point, line, place, at),
        slides=(place,) if at == "free" else (),
        constants=(place,) if at == "held" else (),
        aligned=(line.origin, line.head, point) if line.between else (),
        segments=((line.origin, point),) if line.between or line.axis else (),
        slide=line.slide,
    )


def _placed(point: str, line: Line, place: str, at: str, drawing: Drawing) -> Mapping[str, Placed]:
    """The place of the point, if it is not driven.

    Raises:
        MechanismError: the line has no direction, or too uncertain a direction at the point's distance.
    """
    if at == "driven":
        return {}
    if at == "held":
        return {place: _held(point, line, drawing)}
    foot = line.foot(point, drawing)
    if line.between:
        _require_near(point, line, drawing, np.abs(foot))
    return {place: Placed(foot)}


def _held(point: str, line: Line, drawing: Drawing) -> Placed:
    """r with r^2 = |p - p_origin|^2 / |d|^2, with the sign of the side on which the point is drawn."""
    far, near = drawing.vectors[point], drawing.vectors[line.origin]
    reach, reach_rest = exact_square(far, near)
    if not (reach > 0.0).all():
        raise no_length(line.origin, point)
    d = line.drawn(drawing)
    square, square_rest = pair_dot(d, d)
    side = np.where(np.sum((far - near) * d[0], axis=-1) < 0.0, -1.0, 1.0)
    place = np.sqrt(reach / square)
    own, own_rest = two_product(place, place)
    held, held_rest = two_product(own, square)
    rest = (reach - held) + (reach_rest - held_rest - own * square_rest - own_rest * square)
    return Placed(side * place, side * rest / (2.0 * place * square), PAIRS * place)


def _require_near(point: str, line: Line, drawing: Drawing, ratio: Array) -> None:
    """Refuse a point that is too many lengths of its line away from the origin."""
    if not (ratio > FARTHEST).any():
        return
    times = float(ratio.max())
    apart = float((drawing.distance(line.origin, line.head) * drawing.unit).flat[int(np.argmax(ratio))])
    raise MechanismError(
        f"{line.origin} and {line.head} are {apart:.3g} mm apart, and {point} is "
        f"{apart * times:.3g} mm along the line through them, {times:.3g} times as far, so the line's "
        f"direction is too uncertain there; allowed: at most {FARTHEST:g} times; draw {line.head} at "
        f"least {apart * times / FARTHEST:.2g} mm from {line.origin}",
        [line.origin, line.head, point],
    )
