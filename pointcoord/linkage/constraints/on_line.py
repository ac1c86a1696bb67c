"""A point that slides along the line through two others."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pointcoord.errors import MechanismError
from pointcoord.linkage.constraints.constraint import Constraint, no_length, per_axis
from pointcoord.linkage.drawing import Drawing, Placed
from pointcoord.linkage.layout import Layout
from pointcoord.numerics.double_double import Pair, exact_square, pair_root
from pointcoord.numerics.quadratic import Product, Row

Array = NDArray[np.float64]

# How many lengths of its line a point may stand along it. With R of them, p_end turns by 1 / R of what the
# point goes, and R itself takes up the rest: X = C_u^-1 grows as R^2, X C_u bends as R^3 and the tangent as
# R, so that a proven step, 1 / sqrt(2 omega q) of `assembly`, shrinks as 1 / R^2. A turn of the paper's arm
# by 1 rad takes 0.036 R^2 steps; that is all of the 2000 that a path may have at R = 235.
FARTHEST = 235.0


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
    driven: bool = False

    @property
    def name(self) -> str:
        """The point and the line."""
        return f"{self.point} on the line {self.start} - {self.end}"

    @property
    def labels(self) -> tuple[str, ...]:
        """A row per axis."""
        return per_axis(self.name)

    @property
    def aligned(self) -> tuple[str, str, str]:
        """The line's start and end, and the point."""
        return (self.start, self.end, self.point)

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
        return () if self.driven else (self.ratio,)

    def length(self, drawing: Drawing) -> Pair:
        """|p_end - p_start| as high and low."""
        return pair_root(exact_square(drawing.vectors[self.end], drawing.vectors[self.start]))

    def foot(self, drawing: Drawing) -> Array:
        """The ratio of the point's foot on the drawn line, shape (...,)."""
        start = drawing.vectors[self.start]
        line = drawing.vectors[self.end] - start
        reach = np.sum((drawing.vectors[self.point] - start) * line, axis=-1)
        square = np.sum(line * line, axis=-1)
        if not (square > 0.0).all():
            raise no_length(self.start, self.end)
        return np.asarray(reach / square)

    def placed(self, layout: Layout, drawing: Drawing) -> tuple[Placed, ...]:
        """The ratio of the point's foot on the drawn line."""
        ratio = self.foot(drawing)
        if (np.abs(ratio) > FARTHEST).any():
            raise self._ill_drawn(drawing, ratio)
        if self.driven:
            return ()
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
