r"""What every kind of constraint can say of itself; each kind has a file of its own beside this one.

A constraint is data: the names of the points, directions and coordinates that it ties together. Its rows
hold no numbers of a particular car; those are in y. p_a is the position of point a. What a kind needs in y
beside points, and how it reads that off a drawing, it knows itself: nobody else asks what kind it is.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Self

from pointcoord.errors import MechanismError
from pointcoord.linkage.drawing import Drawing, Placed
from pointcoord.linkage.layout import Layout, Triple
from pointcoord.numerics.quadratic import Product, Row


class Constraint(ABC):
    """Named rows over a layout, and the coordinates of y that belong to them alone."""

    along_axes = False
    """Whether its rows are the three components of one equation between vectors."""

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
        """Pairs of points that it keeps at their drawn distance; its rows need the square of that."""
        return ()

    @property
    def aligned(self) -> tuple[()] | tuple[str, str, str]:
        """Points that it puts on one line although they may be drawn beside it: two of the line, a third."""
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

    @classmethod
    def placed_together(
        cls, constraints: Sequence[Self], layout: Layout, drawing: Drawing
    ) -> tuple[Placed, ...]:
        """The same of several of one kind; one after the other unless the kind says otherwise."""
        return tuple(own for constraint in constraints for own in constraint.placed(layout, drawing))


def per_axis(name: str) -> tuple[str, ...]:
    """A name for each of three rows."""
    return tuple(f"{name} ({axis})" for axis in "xyz")


def dot(a: Triple, b: Triple, c: Triple, d: Triple) -> Row:
    """(y_a - y_b) . (y_c - y_d) as products, for vectors given by their indices."""
    return tuple(Product(1.0, (a[i], b[i]), (c[i], d[i])) for i in range(3))


def no_length(start: str, end: str) -> MechanismError:
    """The error for two points in one place that a length or a line needs apart."""
    return MechanismError(
        f"link {start} - {end} has no length: both points are at the same place; move one", [start, end]
    )
