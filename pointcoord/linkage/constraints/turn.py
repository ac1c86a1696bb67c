"""The driven turn of a body about a hinge, from the drawing on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from pointcoord.errors import MechanismError
from pointcoord.linkage.constraints.constraint import Constraint, dot, per_axis
from pointcoord.linkage.constraints.in_body import (
    Normal,
    by_component,
    weight_names,
    weighted_rows,
    weights_in_body,
)
from pointcoord.linkage.drawing import Drawing, Placed
from pointcoord.linkage.layout import Layout, Triple
from pointcoord.numerics.double_double import (
    PAIRS,
    pair_cross,
    pair_dot,
    pair_quotient,
    pair_root,
)
from pointcoord.numerics.quadratic import Product, Row


@dataclass(frozen=True)
class Turn(Constraint):
    r"""A body turned by an angle about a hinge from `tail` to `head`, right-handed, with v = p - p_tail.

    Two vectors of the other body are square to the hinge: N = d x v and M = N x d / |d| ... of the drawing,
    both of one length, M along v's part square to the hinge. Then

        alpha - v . N = 0,    beta - v . M = 0,    cosine alpha - sine beta = 0,

    so that (beta, alpha) points along (cosine, sine), which are driven. Three rows where the other body is
    the chassis, whose N and M are constants. Another carries them in its triangle: six rows more.

    Attributes:
        carrier: the triangle of the other body; None for the chassis.
    """

    turn: str
    point: str
    tail: str
    head: str
    cosine: str
    sine: str
    carrier: Normal | None = None

    @property
    def name(self) -> str:
        """The turn's own."""
        return self.turn

    @property
    def labels(self) -> tuple[str, ...]:
        """A row for each part of the point, one for the turn, and those of the vectors."""
        parts = (f"{self.turn}: across", f"{self.turn}: along", self.turn)
        return (*parts, *(label for vector in self.vectors for label in per_axis(vector)))

    @property
    def _named(self) -> tuple[str, str]:
        return f"across {self.turn}", f"along {self.turn}"

    @property
    def vectors(self) -> tuple[str, ...]:
        """N and M, where another body carries them."""
        return self._named if self.carrier else ()

    @property
    def slides(self) -> tuple[str, ...]:
        """alpha and beta."""
        return tuple(f"part {name}" for name in self._named)

    @property
    def constants(self) -> tuple[str, ...]:
        """N and M, or their places in the body that carries them."""
        if self.carrier is None:
            return tuple(label for name in self._named for label in per_axis(name))
        return tuple(name for vector in self._named for name in weight_names(vector, self.carrier))

    def _vectors(self, layout: Layout) -> tuple[Triple, Triple]:
        if self.carrier is not None:
            return layout.vector(self._named[0]), layout.vector(self._named[1])
        a, b, c, d, e, f = (layout.scalar(name) for name in self.constants)
        return (a, b, c), (d, e, f)

    def rows(self, layout: Layout) -> tuple[Row, ...]:
        """Bilinear in the point and the vectors, and in the parts and the driven pair."""
        none = layout.vector("")
        vectors = [(vector, none) for vector in self._vectors(layout)]
        alpha, beta, cosine, sine = map(layout.number, (*self.slides, self.cosine, self.sine))
        found: list[Row] = [
            (*dot(layout.edge(self.tail, self.point), vector), Product(1.0, part, layout.number()))
            for vector, part in zip(vectors, (alpha, beta), strict=True)
        ]
        found.append((Product(1.0, cosine, alpha), Product(-1.0, sine, beta)))
        if self.carrier is not None:
            for vector, first in zip(vectors, (0, 3), strict=True):
                found += weighted_rows(layout, vector, self.carrier, self.constants[first : first + 3])
        return tuple(found)

    def placed(self, drawing: Drawing) -> Mapping[str, Placed]:
        """The drawn vectors and parts.

        Raises:
            MechanismError: the point is drawn on the hinge.
        """
        axis, scale = drawing.axis(self.tail, self.head), drawing.scale(self.tail, self.point)[..., None]
        high, low = drawing.edge(self.point, self.tail)
        v = high * scale, low * scale
        across = pair_cross(axis, v)
        if not (np.sum(across[0] ** 2, axis=-1) > 1e-24).all():
            raise MechanismError(
                f"{self.point} is drawn on the hinge {self.tail} - {self.head}, so it does not tell how far "
                "its body has turned; draw it off the hinge",
                (self.point, self.tail, self.head),
            )
        length = pair_root(pair_dot(axis, axis))
        along = pair_quotient(pair_cross(across, axis), (length[0][..., None], length[1][..., None]))
        found: dict[str, Placed] = {}
        for i, vector in enumerate((across, along)):
            found[self.slides[i]] = Placed(np.sum(v[0] * vector[0], axis=-1))
            # Products of vectors that are at most 1 long, and a quotient of one by another.
            numbers = Placed(*vector, np.full_like(vector[0], 8.0 * PAIRS))
            if self.carrier is not None:
                found[self._named[i]] = Placed(vector[0])
                numbers = weights_in_body(drawing, vector, self.carrier, self.turn)
            found |= by_component(self.constants[3 * i : 3 * i + 3], numbers)
        return found
