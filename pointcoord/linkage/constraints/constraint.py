r"""What every kind of constraint can say of itself; each kind has a file of its own beside this one.

A constraint is data: the names of the points, directions and coordinates that it ties together. Its rows
hold no numbers of a particular car; those are in y. p_a is the position of point a. What a kind needs in y
beside points, and how it reads that off a drawing, it knows itself: nobody else asks what kind it is.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping

from pointcoord.linkage.drawing import Drawing, Placed
from pointcoord.linkage.layout import Layout, Triple
from pointcoord.numerics.quadratic import Product, Row


class Constraint(ABC):
    """Named rows over a layout, and the coordinates of y that belong to them alone.

    Attributes:
        vectors, slides: unknown vectors and unknown numbers that it brings along.
        constants: numbers of the drawing that its rows need.
        squared_lengths: pairs of points that it keeps at their drawn distance.
        aligned: points that it puts on one line although they may be drawn beside it: two of the line and a
            third.
        segments: pairs of points that a picture of the linkage joins.
        pivots: points that its rows read as what the chassis turns about, and not as joined to anything.
        along_axes: whether its rows are the three components of one equation between vectors.
        may_lock: whether it can be what a motion ends at.
        holds_a_body: whether it only says how a body is made, and joins it to nothing.
        is_length: whether its rows at the drawing are the components of a distance that the drawing misses.
    """

    along_axes = False
    holds_a_body = False
    is_length = False

    @property
    def vectors(self) -> tuple[str, ...]:
        return ()

    @property
    def slides(self) -> tuple[str, ...]:
        return ()

    @property
    def constants(self) -> tuple[str, ...]:
        return ()

    @property
    def squared_lengths(self) -> tuple[tuple[str, str], ...]:
        return ()

    @property
    def aligned(self) -> tuple[()] | tuple[str, str, str]:
        return ()

    @property
    def segments(self) -> tuple[tuple[str, str], ...]:
        return ()

    @property
    def pivots(self) -> tuple[str, ...]:
        return ()

    @property
    def may_lock(self) -> bool:
        return False

    @property
    @abstractmethod
    def name(self) -> str:
        """What messages call it."""

    @property
    def labels(self) -> tuple[str, ...]:
        """A name for each row."""
        return per_axis(self.name) if self.along_axes else (self.name,)

    @abstractmethod
    def rows(self, layout: Layout) -> tuple[Row, ...]:
        """The rows, in the order of the labels."""

    def placed(self, drawing: Drawing) -> Mapping[str, Placed]:
        """Its own coordinates as drawn, by name.

        Raises:
            MechanismError: the drawing gives them no value.
        """
        return {}


def per_axis(name: str) -> tuple[str, ...]:
    """A name for each of three rows."""
    return tuple(f"{name} ({axis})" for axis in "xyz")


def crossed(
    layout: Layout, c: Triple, one: tuple[Triple, Triple], other: tuple[Triple, Triple]
) -> tuple[Row, ...]:
    """The rows c - (y_a - y_b) x (y_d - y_e) = 0, for vectors given by their indices."""
    (a, b), (d, e) = one, other
    return tuple(
        (
            Product(1.0, (c[i], layout.zero), layout.number()),
            Product(-1.0, (a[j], b[j]), (d[k], e[k])),
            Product(1.0, (a[k], b[k]), (d[j], e[j])),
        )
        for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1))
    )


def dot(one: tuple[Triple, Triple], other: tuple[Triple, Triple]) -> Row:
    """(y_a - y_b) . (y_c - y_d) as products, for vectors given by their indices."""
    (a, b), (c, d) = one, other
    return tuple(Product(1.0, (a[i], b[i]), (c[i], d[i])) for i in range(3))
