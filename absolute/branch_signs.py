"""Which side of its folds a linkage is on: the signs that tell its assemblies apart."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from absolute.description import Carried, Model, Vector
from absolute.drawing import Drawing
from absolute.features import Features, Pick
from absolute.precision import EPS
from absolute.rows import Angle
from absolute.solution import Array, Counts
from absolute.vectors import cross

# Drawn vectors have relative errors of two roundings, and a product of three of them adds nine: a
# smaller share than this many roundings has no sign.
ROUNDINGS = 16


class SignVector(NamedTuple):
    """A vector from one feature to another, and what it is in the drawing, in units of size."""

    start: Pick
    end: Pick
    drawn: Array


def sign_vectors(
    model: Model, drawing: Drawing, senses: tuple[Angle, ...], features: Features
) -> dict[str, list[SignVector]]:
    """The vectors of each branch sign, put into the table of features.

    Between two points of one body the vector itself is a feature, so that its relative error is
    that of a rotation however short it is. Those of the model come first, then one per pair of
    joint axes that must keep its sense.
    """
    nothing = features.add(0, np.zeros(3), False)
    holders = {
        point: [body for body in drawing.bodies if point in model.bodies[body]] for point in model.points
    }

    def fixed(body: int, line: Array) -> SignVector:
        return SignVector(nothing, features.add(body, line, False), line)

    def vector_of(vector: tuple[str, str] | Vector | Carried) -> SignVector:
        if isinstance(vector, Carried):
            return fixed(drawing.bodies[vector.body], drawing.line(vector.start, vector.end))
        if len(vector) == 3:
            line = np.array(vector) / np.abs(vector).max()
            return fixed(0, line / np.linalg.norm(line))
        line = drawing.line(*vector)
        shared = [body for body in holders[vector[0]] if body in holders[vector[1]]]
        if shared:
            return fixed(drawing.bodies[shared[0]], line)
        start, end = (
            features.add(drawing.bodies[body], drawing.arm(body, point), True)
            for body, point in ((holders[point][0], point) for point in vector)
        )
        return SignVector(start, end, line)

    vectors = {
        name: [vector_of(vector) for vector in sign.vectors] for name, sign in model.branch_signs.items()
    }
    for number, sense in enumerate(senses):
        vectors[f"sense {number} of joint {sense.owner}"] = [
            fixed(sense.first, sense.direction),
            fixed(sense.second, sense.partner),
        ]
    return vectors


class BranchSigns:
    """Products of vectors of a model, evaluated from placed features; their drawn signs name the branch.

    Attributes:
        names: of the branch signs of the model, then of the joints.
        limits: of each, the links that are at their dead point where it is zero.
        told: whether the model has branch signs; without any, nothing here tells assemblies apart.
        wanted: (signs,) signs in the drawing; 0 where the drawing stands at zero within rounding.
        drawn: (signs,) products in the drawing as shares, see `shares`.
    """

    def __init__(self, model: Model, vectors: dict[str, list[SignVector]], features: Features) -> None:
        self.told = bool(model.branch_signs)
        # Products of three first, so that one vector product serves them all.
        ordered = sorted(vectors.items(), key=lambda sign: -len(sign[1]))
        self.names = tuple(name for name, _ in ordered)
        self.limits = tuple(
            model.branch_signs[name].limits if name in model.branch_signs else () for name in self.names
        )
        self._count = len(ordered)
        self._triples = sum(len(vectors) == 3 for _, vectors in ordered)
        every = [
            *(vectors[0] for _, vectors in ordered),
            *(vectors[1] for _, vectors in ordered),
            *(vectors[2] for _, vectors in ordered[: self._triples]),
        ]
        picks = [(vector.start, vector.end) for vector in every]
        flat = np.array(features.flat(picks), dtype=np.int64).reshape(-1, 2)
        self._starts: Counts = flat[:, 0].copy()
        self._ends: Counts = flat[:, 1].copy()
        # The drawing's own differences: a vector may be short beside the car.
        drawn = np.array([vector.drawn for vector in every]).reshape(-1, 3)
        self.drawn = self._shares(drawn)
        self.wanted = np.where(np.abs(self.drawn) > ROUNDINGS * EPS, np.sign(self.drawn), 0.0)

    def products(self, world: Array) -> Array:
        """(..., signs) a . b or (a x b) . c from placed features (..., features, 3)."""
        return self._products(self._vectors(world))

    def shares(self, world: Array) -> Array:
        """(signs,) products divided by the lengths of their factors, between -1 and 1."""
        return self._shares(self._vectors(world))

    def kept(self, world: Array) -> NDArray[np.bool_]:
        """(...) whether all signs are those of the drawing."""
        kept: NDArray[np.bool_] = np.asarray((self.products(world) * self.wanted > 0.0).all(-1))
        return kept

    def lost(self, world: Array) -> int:
        """The place of the product whose share is furthest from its sign at one pose."""
        return int(np.argmin(self.shares(world) * self.wanted))

    def _vectors(self, world: Array) -> Array:
        vectors: Array = world.take(self._ends, -2)
        vectors -= world.take(self._starts, -2)
        return vectors

    def _products(self, vectors: Array) -> Array:
        """Uses up the vectors."""
        count, triples = self._count, self._triples
        first, second = vectors[..., :count, :], vectors[..., count : 2 * count, :]
        if triples:
            # In place: these vectors are needed no more.
            first[..., :triples, :] = cross(first[..., :triples, :], second[..., :triples, :])
            second[..., :triples, :] = vectors[..., 2 * count :, :]
        products: Array = np.vecdot(first, second)
        return products

    def _shares(self, vectors: Array) -> Array:
        # Of unit vectors, so that short ones do not multiply to nothing.
        length = np.linalg.norm(vectors, axis=-1, keepdims=True)
        return self._products(np.divide(vectors, length, out=np.zeros_like(vectors), where=length > 0))
