"""The driven height of a wheel over the ground, which a moved chassis sees: where up is, how far it has gone.

The mechanism is solved in the chassis' own frame (see `chassis`). There a turn of the chassis by a about k
through P turns what is up the other way, and the height of a place x over the ground is

    x . u_0 + sum_i P_i . (u_i - u_(i-1)) + up . d,      u_m = up,   u_(i-1) = u_i turned by -a_i about k_i

after the turns 1 to m and a displacement d.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from pointcoord.errors import MechanismError
from pointcoord.linkage.constraints.constraint import Constraint, crossed, dot, per_axis
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
from pointcoord.numerics.vectors import cross


@dataclass(frozen=True)
class TurnedBack(Constraint):
    r"""A direction e turned back by the angle a of a turn about the unit vector k: u. Nine rows.

        t - e x k = 0,    w - k x t = 0,    u - e - sin(a) t + (1 - cos(a)) w = 0,

    since w is the part of e square to k. Cosine and sine are driven.

    Attributes:
        before: e, which is up at the drawing. about: P, a point of the chassis.
    """

    turn: str
    before: str
    axis: str
    about: str
    cosine: str
    sine: str

    @property
    def name(self) -> str:
        return f"up before {self.turn}"

    @property
    def labels(self) -> tuple[str, ...]:
        return tuple(label for vector in self.vectors for label in per_axis(vector))

    @property
    def vectors(self) -> tuple[str, ...]:
        """t, w and u."""
        return f"across {self.turn}", f"aside of {self.turn}", self.name

    def rows(self, layout: Layout) -> tuple[Row, ...]:
        """Bilinear in the direction and the axis, and in the driven pair and what they make."""
        e, k = layout.edge(self.before), layout.edge(self.axis)
        (t, zero), (w, _), (u, _) = map(layout.edge, self.vectors)
        versine = layout.one, layout.scalar(self.cosine)
        turned = tuple(
            (
                Product(1.0, (u[i], e[0][i]), layout.number()),
                Product(-1.0, layout.number(self.sine), (t[i], zero[i])),
                Product(1.0, versine, (w[i], zero[i])),
            )
            for i in range(3)
        )
        return (*crossed(layout, t, e, k), *crossed(layout, w, k, (t, zero)), *turned)

    def placed(self, drawing: Drawing) -> Mapping[str, Placed]:
        """As drawn, before any turn."""
        up, k = drawing.vectors["up"], drawing.vectors[self.axis]
        across = cross(up, k)
        vectors = across, cross(k, across), up
        return {name: Placed(vector) for name, vector in zip(self.vectors, vectors, strict=True)}

    def lifts(self, layout: Layout) -> Row:
        """P . (e - u), what the turn lifts by where its line is."""
        return dot(layout.edge(self.about), layout.edge(self.before, self.name))


@dataclass(frozen=True)
class Displaced(Constraint):
    """The displacement of the chassis, d - sum_i h_i e_i = 0. Three rows.

    Attributes:
        along: the driven coordinates, each with its direction.
    """

    along: tuple[tuple[str, str], ...]

    along_axes = True

    @property
    def name(self) -> str:
        return "displacement of the chassis"

    @property
    def vectors(self) -> tuple[str, ...]:
        return (self.name,)

    def rows(self, layout: Layout) -> tuple[Row, ...]:
        zero, d = layout.zero, layout.vector(self.name)
        ways = [(layout.number(value), layout.vector(direction)) for value, direction in self.along]
        return tuple(
            (
                Product(1.0, (d[i], zero), layout.number()),
                *(Product(-1.0, h, (e[i], zero)) for h, e in ways),
            )
            for i in range(3)
        )

    def placed(self, drawing: Drawing) -> Mapping[str, Placed]:
        """None, as drawn."""
        return {self.name: Placed(0.0 * drawing.vectors["up"])}

    def lifts(self, layout: Layout) -> Row:
        """Up . d."""
        return dot(layout.edge("up"), layout.edge(self.name))


@dataclass(frozen=True)
class Ground:
    """What heights over the ground are made of; of a chassis that stands still there is none.

    Attributes:
        turns: of the chassis, the last first.
    """

    turns: tuple[TurnedBack, ...] = ()
    moved: tuple[Displaced, ...] = ()

    @property
    def up(self) -> str:
        """The direction that is up, in the chassis' frame."""
        return self.turns[-1].name if self.turns else "up"

    @property
    def constraints(self) -> tuple[Constraint, ...]:
        """What makes these vectors."""
        return (*self.turns, *self.moved)

    def lifts(self, layout: Layout) -> Row:
        """By how much places are higher over the ground than along its up from the mechanism's origin."""
        parts = (*(one.lifts(layout) for one in self.turns), *(one.lifts(layout) for one in self.moved))
        return tuple(product for row in parts for product in row)


CHASSIS_ITSELF = Ground()
"""What heights over a chassis that stands still are over."""


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
