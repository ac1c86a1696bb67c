"""The driven height of the lowest point of a wheel."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from pointcoord.errors import MechanismError
from pointcoord.linkage.constraints.constraint import Constraint, dot
from pointcoord.linkage.constraints.ground import CHASSIS_ITSELF, Ground
from pointcoord.linkage.drawing import Drawing, Placed
from pointcoord.linkage.layout import Layout
from pointcoord.numerics.double_double import (
    PAIRS,
    exact_square,
    minus_pair,
    pair_dot,
    pair_product,
    pair_quotient,
    pair_root,
    pair_sum,
    two_product,
)
from pointcoord.numerics.quadratic import Product, Row


@dataclass(frozen=True)
class ContactHeight(Constraint):
    r"""The lowest point of a thin disc of radius r about the axis from `inner` to `centre`. Three rows.

    With the axis w = p_centre - p_inner of drawn length L, a = w . e and q the part of w square to e,

        a - w . e = 0,    q^2 + a^2 - L^2 = 0,    p_centre . e - (r / L) q - k - rise = 0,

    since the lowest point lies r q / L below the centre. k is the height of the drawing's. Over the ground e
    is its up, and the last row has what lifts the chassis besides.

    Attributes:
        radius: mm.
        ground: that the height is over; the chassis' own up unless given.
    """

    inner: str
    centre: str
    rise: str
    radius: float
    ground: Ground = CHASSIS_ITSELF

    @property
    def name(self) -> str:
        return f"height of the contact point of {self.centre}"

    @property
    def labels(self) -> tuple[str, ...]:
        return (f"lean of {self.centre}", f"length of the axis to {self.centre}", self.name)

    @property
    def slides(self) -> tuple[str, ...]:
        return (f"rise of the axis to {self.centre}", f"reach of the axis to {self.centre}")

    @property
    def constants(self) -> tuple[str, ...]:
        """L^2, r / L and k."""
        what = ("squared length of the axis", "radius by the length of the axis", "drawn contact height")
        return tuple(f"{each} of {self.centre}" for each in what)

    @property
    def pivots(self) -> tuple[str, ...]:
        return tuple(turn.about for turn in self.ground.turns)

    def rows(self, layout: Layout) -> tuple[Row, ...]:
        one, up = layout.number(), layout.edge(self.ground.up)
        names = (*self.slides, *self.constants, self.rise)
        a, q, square, share, drawn, rise = map(layout.number, names)
        height = (*dot(layout.edge(self.centre), up), *self.ground.lifts(layout), Product(-1.0, share, q))
        return (
            (*dot(layout.edge(self.inner, self.centre), up), Product(1.0, a, one)),
            (Product(1.0, a, a), Product(1.0, q, q), Product(-1.0, square, one)),
            (*height, Product(-1.0, drawn, one), Product(-1.0, rise, one)),
        )

    def placed(self, drawing: Drawing) -> Mapping[str, Placed]:
        """The drawn lean and the constants, with what they lack by rounding.

        Raises:
            MechanismError: the axis has no length, or is drawn upright.
        """
        centre, e = drawing.vectors[self.centre], drawing.edge("up")
        square = exact_square(centre, drawing.vectors[self.inner])
        lean = pair_dot(drawing.edge(self.centre, self.inner), e)
        reach2 = pair_sum(square, minus_pair(pair_product(lean, lean)))
        if not (reach2[0] > 1e-12 * square[0]).all() or not (square[0] > 0.0).all():
            names = (self.inner, self.centre)
            raise MechanismError(
                f"the wheel's axis from {self.inner} to {self.centre} has no length or is drawn upright, so "
                "the wheel has no lowest point; draw it across the car",
                names,
            )
        reach = pair_root(reach2)
        radius = two_product(np.asarray(self.radius / drawing.unit), np.ones_like(square[0]))
        share = pair_quotient(radius, pair_root(square))
        drop = pair_product(share, reach)
        drawn = pair_sum(pair_dot((centre, np.zeros_like(centre)), e), minus_pair(drop))
        # The root loses what the difference under it cancels to; roots, quotients and products round a few
        # times as often as one product of pairs.
        lost = 8.0 * PAIRS * (1.0 + square[0] / reach2[0])
        size = np.sum(np.abs(centre * e[0]), axis=-1) + np.abs(drop[0])
        constants = (
            Placed(*square, PAIRS * square[0]),
            Placed(*share, 8.0 * PAIRS * share[0]),
            Placed(*drawn, lost * size),
        )
        slides = (Placed(lean[0]), Placed(reach[0]))
        return dict(zip((*self.slides, *self.constants), (*slides, *constants), strict=True))
