r"""A constraint: named equations between points, directions and coordinates of y, as data.

The equations contain no dimensions of a particular car; these are in y. A constraint names the coordinates of
y that it needs in addition to points, and computes them from a drawing, so no other code depends on its kind.
Each kind is a function that makes a `Constraint`, in a module of this package.

An equation is a sum of terms that is zero. A term is a product of two numbers, of a number and a vector, or
the scalar or vector product of two vectors; a vector is an edge, p_head - p_tail.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from pointcoord.linkage.drawing import Drawing, Placed
from pointcoord.linkage.layout import Layout, Triple, per_axis
from pointcoord.numerics.quadratic import Product, Row

Edge = tuple[str, str]
Names = tuple[str, ...]
Factor = str | Edge
Reading = Callable[[Drawing], Mapping[str, Placed]]
ONE = ""
"""The name of the number 1."""


class Term(NamedTuple):
    """A product of two factors; each is the name of a number, or an edge.

    Attributes:
        coefficient: 1 or -1. cross: whether it is the vector product of two edges.
        less: a number subtracted from the first factor, which is a number too.
    """

    coefficient: float
    one: Factor
    other: Factor
    cross: bool = False
    less: str = ""

    def rows(self, layout: Layout) -> tuple[Row, ...]:
        """The products by component: one row for a number, three rows for a vector."""
        c = self.coefficient
        (a, b), (d, e) = _components(layout, self.one, self.less), _components(layout, self.other)
        if self.cross:
            return tuple(
                (Product(c, (a[j], b[j]), (d[k], e[k])), Product(-c, (a[k], b[k]), (d[j], e[j])))
                for j, k in ((1, 2), (2, 0), (0, 1))
            )
        products = tuple(Product(c, (a[i], b[i]), (d[i], e[i])) for i in range(3))
        if isinstance(self.one, str) and isinstance(self.other, str):
            return (products[:1],)
        if isinstance(self.one, str) or isinstance(self.other, str):
            return tuple((product,) for product in products)
        return (products,)


def _components(layout: Layout, factor: Factor, less: str = "") -> tuple[Triple, Triple]:
    """The coordinates whose differences are a vector's components; for a number, the same for all three."""
    if isinstance(factor, tuple):
        return layout.vector(factor[0]), layout.vector(factor[1])
    place = layout.scalar(factor) if factor else layout.one
    zero = layout.scalar(less) if less else layout.zero
    return (place, place, place), (zero, zero, zero)


class Equation(NamedTuple):
    """A sum of terms that is zero.

    Attributes:
        label: name in messages; vector equations append the component.
    """

    label: str
    terms: tuple[Term, ...]

    @property
    def labels(self) -> Names:
        """A name for each row."""
        first = self.terms[0]
        numbers = isinstance(first.one, str) + isinstance(first.other, str)
        return per_axis(self.label) if numbers == 1 else (self.label,)

    def rows(self, layout: Layout) -> tuple[Row, ...]:
        terms = (term.rows(layout) for term in self.terms)
        return tuple(tuple(p for row in rows for p in row) for rows in zip(*terms, strict=True))


def nothing(drawing: Drawing) -> Mapping[str, Placed]:
    """Reads nothing off a drawing: for constraints without coordinates of their own."""
    return {}


@dataclass(frozen=True)
class Constraint:
    """Named equations, and the coordinates of y that belong to them alone.

    Attributes:
        name: name in messages.
        placed: drawing -> its own coordinates by name; raises MechanismError if the drawing defines no value.
        vectors, slides: unknown vectors and unknown numbers that the constraint adds.
        constants: numbers of the drawing that its equations need.
        squared_lengths: pairs of points that it keeps at their drawn distance.
        aligned: three points that it puts on one line, two of the line and a third, though the third may be
            drawn off the line.
        segments: pairs of points to be joined in a picture of the linkage.
        pivots: points that it reads only as centres of rotation of the chassis, without joining them.
        slide: the slide whose line it puts a point on. In the drawing, its rows are the components of the
            point's distance from the line, the slide's closure error.
    """

    name: str
    equations: tuple[Equation, ...]
    placed: Reading = field(default=nothing, compare=False)
    vectors: Names = ()
    slides: Names = ()
    constants: Names = ()
    squared_lengths: tuple[Edge, ...] = ()
    aligned: tuple[()] | tuple[str, str, str] = ()
    segments: tuple[Edge, ...] = ()
    pivots: Names = ()
    slide: str = ""

    @property
    def labels(self) -> Names:
        """A name for each row."""
        return tuple(label for equation in self.equations for label in equation.labels)

    def rows(self, layout: Layout) -> tuple[Row, ...]:
        """The rows of the map, in the order of the labels."""
        return tuple(row for equation in self.equations for row in equation.rows(layout))
