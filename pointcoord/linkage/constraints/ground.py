"""The ground as the moved chassis sees it: where up is, and how far it has gone.

The mechanism is solved in the chassis' own frame (see `chassis`). There a turn of the chassis by a about k
through P turns what is up the other way, and the height of a place x over the ground is

    x . u_0 + sum_i P_i . (u_i - u_(i-1)) + up . d,      u_m = up,   u_(i-1) = u_i turned by -a_i about k_i

after the turns 1 to m and a displacement d.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from pointcoord.linkage.constraints.constraint import Constraint, crossed, dot, per_axis
from pointcoord.linkage.drawing import Drawing, Placed
from pointcoord.linkage.layout import Layout
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
