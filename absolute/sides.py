"""Which side of its folds a linkage is on: the signs that tell its assemblies apart."""

import numpy as np
from numpy.typing import NDArray

from absolute.description import Model, Vector
from absolute.drawing import Drawing
from absolute.features import Features, Pick
from absolute.rows import Angle
from absolute.solution import Array, Counts
from absolute.vectors import cross

# A drawn product below this many roundings of its factors has no sign.
ROUNDINGS = 16


# A vector from the first feature to the second.
Ends = tuple[Pick, Pick]


def side_ends(
    model: Model, drawing: Drawing, senses: tuple[Angle, ...], features: Features
) -> dict[str, list[Ends]]:
    """The vectors of each side, put into the table of features.

    The sides of the model come first, then one per pair of joint axes that must keep its sense.
    """
    nothing = features.add(0, np.zeros(3), False)
    holder = {point: body for body in reversed(drawing.bodies) for point in model.bodies[body]}

    def ends(vector: tuple[str, str] | Vector) -> Ends:
        if len(vector) == 3:
            line = np.array(vector) / np.abs(vector).max()
            return nothing, features.add(0, line / np.linalg.norm(line), False)
        start, end = (
            features.add(drawing.bodies[holder[point]], drawing.arm(holder[point], point), True)
            for point in vector
        )
        return start, end

    sides = {name: [ends(vector) for vector in side.vectors] for name, side in model.sides.items()}
    for number, sense in enumerate(senses):
        sides[f"sense {number} of joint {sense.owner}"] = [
            (nothing, features.add(sense.first, sense.direction, False)),
            (nothing, features.add(sense.second, sense.partner, False)),
        ]
    return sides


class Sides:
    """Products of vectors of a model, evaluated from placed features; their drawn signs name the branch.

    Attributes:
        names: of the sides of the model, then of the joints.
        told: whether the model has sides; without any, nothing here tells assemblies apart.
        wanted: (sides,) signs in the drawing; 0 where the drawing stands at zero within rounding.
        drawn: (sides,) products in the drawing as shares, see `shares`.
    """

    def __init__(self, model: Model, sides: dict[str, list[Ends]], features: Features) -> None:
        self.told = bool(model.sides)
        # Products of three first, so that one vector product serves them all.
        ordered = sorted(sides.items(), key=lambda side: -len(side[1]))
        self.names = tuple(name for name, _ in ordered)
        self._count = len(ordered)
        self._triples = sum(len(ends) == 3 for _, ends in ordered)
        picks: list[tuple[Pick, ...]] = [
            *(ends[0] for _, ends in ordered),
            *(ends[1] for _, ends in ordered),
            *(ends[2] for _, ends in ordered[: self._triples]),
        ]
        flat = np.array(features.flat(picks), dtype=np.int64).reshape(-1, 2)
        self._starts: Counts = flat[:, 0].copy()
        self._ends: Counts = flat[:, 1].copy()
        self.wanted = self.drawn = np.zeros(self._count)

    def learn(self, world: Array, rounding: float) -> None:
        """Take the signs of the drawing, whose features are placed here with errors of `rounding`."""
        lengths = self._lengths(world)
        slack = sum(np.prod(np.delete(lengths, at, axis=0), axis=0) for at in range(3))
        products = self.products(world)
        clear = np.abs(products) > ROUNDINGS * rounding * slack
        self.wanted = np.where(clear, np.sign(products), 0.0)
        self.drawn = self.shares(world)

    def products(self, world: Array) -> Array:
        """(..., sides) a . b or (a x b) . c from placed features (..., features, 3)."""
        vectors = world.take(self._ends, -2)
        vectors -= world.take(self._starts, -2)
        count, triples = self._count, self._triples
        first, second = vectors[..., :count, :], vectors[..., count : 2 * count, :]
        if triples:
            # In place: these vectors are needed no more.
            first[..., :triples, :] = cross(first[..., :triples, :], second[..., :triples, :])
            second[..., :triples, :] = vectors[..., 2 * count :, :]
        products: Array = np.vecdot(first, second)
        return products

    def shares(self, world: Array) -> Array:
        """(sides,) products divided by the lengths of their factors, between -1 and 1."""
        lengths = np.prod(self._lengths(world), axis=0)
        products = self.products(world)
        shares: Array = np.divide(products, lengths, out=np.zeros_like(products), where=lengths > 0)
        return shares

    def kept(self, world: Array) -> NDArray[np.bool_]:
        """(...) whether all sides are those of the drawing."""
        kept: NDArray[np.bool_] = np.asarray((self.products(world) * self.wanted > 0.0).all(-1))
        return kept

    def lost(self, world: Array) -> int:
        """The side whose share is furthest on the wrong side at one pose."""
        return int(np.argmin(self.shares(world) * self.wanted))

    def _lengths(self, world: Array) -> Array:
        """(3, sides) lengths of the factors at one pose; 1 for a factor that is not there."""
        found = np.linalg.norm(world.take(self._ends, -2) - world.take(self._starts, -2), axis=-1)
        lengths = np.ones((3, self._count))
        lengths[0], lengths[1] = found[: self._count], found[self._count : 2 * self._count]
        lengths[2, : self._triples] = found[2 * self._count :]
        return lengths
