"""The driven turn of a body about a hinge, from the drawing on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pointcoord.errors import MechanismError
from pointcoord.linkage.constraints.constraint import Constraint, dot, per_axis
from pointcoord.linkage.constraints.in_body import (
    Normal,
    axis_scale,
    scaled_axis,
    weight_names,
    weighted_rows,
    weights_in_body,
)
from pointcoord.linkage.drawing import Drawing, Placed
from pointcoord.linkage.layout import Layout, Triple
from pointcoord.numerics.double_double import (
    PAIRS,
    Pair,
    pair_cross,
    pair_dot,
    pair_quotient,
    pair_root,
    two_sum,
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
        zero, one = layout.zero, (layout.one, layout.zero)
        zeros: Triple = (zero, zero, zero)
        p, o = layout.vector(self.point), layout.vector(self.tail)
        vectors = self._vectors(layout)
        alpha, beta = (layout.scalar(name) for name in self.slides)
        cosine, sine = layout.scalar(self.cosine), layout.scalar(self.sine)
        found: list[Row] = [
            (*dot(o, p, vector, zeros), Product(1.0, (part, zero), one))
            for vector, part in zip(vectors, (alpha, beta), strict=True)
        ]
        found.append((Product(1.0, (cosine, zero), (alpha, zero)), Product(-1.0, (sine, zero), (beta, zero))))
        if self.carrier is not None:
            for vector, first in zip(vectors, (0, 3), strict=True):
                found += weighted_rows(
                    layout, (vector, zeros), self.carrier, self.constants[first : first + 3]
                )
        return tuple(found)

    def placed(self, layout: Layout, drawing: Drawing) -> tuple[Placed, ...]:
        """The drawn vectors and parts.

        Raises:
            MechanismError: the point is drawn on the hinge.
        """
        across, along, v = self._drawn(drawing)
        parts = tuple(np.sum(v[0] * vector[0], axis=-1) for vector in (across, along))
        found = [Placed(tuple(layout.scalar(name) for name in self.slides), np.stack(parts, axis=-1))]
        for number, vector in enumerate((across, along)):
            places = tuple(layout.scalar(name) for name in self.constants[3 * number : 3 * number + 3])
            if self.carrier is None:
                # Products of vectors that are at most 1 long, and a quotient of one by another.
                found.append(Placed(places, vector[0], vector[1], 8.0 * PAIRS))
                continue
            values, lacks, doubt = weights_in_body(drawing, vector, self.carrier, self.turn)
            found.append(Placed(layout.vector(self._named[number]), vector[0]))
            found.append(Placed(places, values, lacks, doubt))
        return tuple(found)

    def _drawn(self, drawing: Drawing) -> tuple[Pair, Pair, Pair]:
        """N, M and v as drawn."""
        axis = scaled_axis(drawing, self.tail, self.head)
        scale = axis_scale(drawing, self.tail, self.point)[..., None]
        high, low = two_sum(drawing.vectors[self.point], -drawing.vectors[self.tail])
        v = high * scale, low * scale
        across = pair_cross(axis, v)
        square = np.sum(across[0] ** 2, axis=-1)
        if not (square > 1e-24).all():
            raise MechanismError(
                f"{self.point} is drawn on the hinge {self.tail} - {self.head}, so it does not tell how far "
                "its body has turned; draw it off the hinge",
                (self.point, self.tail, self.head),
            )
        length = pair_root(pair_dot(axis, axis))
        plain = pair_cross(across, axis)
        along = pair_quotient(plain, (length[0][..., None], length[1][..., None]))
        return across, along, v
