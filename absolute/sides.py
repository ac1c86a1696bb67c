"""Which side of its folds a linkage is on: the signs that tell its assemblies apart."""

import numpy as np
from numpy.typing import NDArray

from absolute.description import Model
from absolute.drawing import Drawing
from absolute.features import Features, Pick
from absolute.rows import Angle
from absolute.solution import Array, Counts
from absolute.vectors import cross

# A drawn product below this many roundings of its factors has no sign.
ROUNDINGS = 16


class Sides:
    """Products of vectors of a model, evaluated at poses; their drawn signs name the branch.

    The sides of the model come first, then one per pair of joint axes that must keep its sense.

    Attributes:
        names: of the sides of the model, then of the joints.
        told: number of sides of the model; without any, nothing here tells assemblies apart.
        wanted: (sides,) signs in the drawing; 0 where the drawing stands at zero within rounding.
        drawn: (sides,) products in the drawing as shares, see `shares`.
    """

    def __init__(self, model: Model, drawing: Drawing, senses: tuple[Angle, ...]) -> None:
        features = Features(len(drawing.bodies))
        nothing = features.add(0, np.zeros(3), False)
        holder = {point: body for body in reversed(drawing.bodies) for point in model.bodies[body]}

        def ends(vector: tuple[str, str] | tuple[float, float, float]) -> tuple[Pick, Pick]:
            if len(vector) == 3:
                line = np.array(vector) / np.abs(vector).max()
                return nothing, features.add(0, line / np.linalg.norm(line), False)
            start, end = (
                features.add(drawing.bodies[holder[point]], drawing.arm(holder[point], point), True)
                for point in vector
            )
            return start, end

        factors = [[ends(vector) for vector in side.vectors] for side in model.sides.values()]
        factors += [
            [
                (nothing, features.add(sense.first, sense.direction, False)),
                (nothing, features.add(sense.second, sense.partner, False)),
            ]
            for sense in senses
        ]
        self.names = (*model.sides, *(f"sense of joint {sense.owner}" for sense in senses))
        self.told = len(model.sides)
        # Products of three first, so that one vector product serves them all.
        order = sorted(range(len(factors)), key=lambda index: -len(factors[index]))
        self._back = np.argsort(order)
        self._triples = sum(len(factor) == 3 for factor in factors)
        pairs = [factors[index][:2] for index in order]
        thirds = [factors[index][2] for index in order[: self._triples]]
        picks: list[tuple[Pick, ...]] = [
            *(pair[0] for pair in pairs),
            *(pair[1] for pair in pairs),
            *thirds,
        ]
        flat = np.array(features.flat(picks), dtype=np.int64).reshape(-1, 2)
        self._starts: Counts = flat[:, 0].copy()
        self._ends: Counts = flat[:, 1].copy()
        self._local, self._is_point = features.tables()
        origin = drawing.origins
        rotation = np.broadcast_to(np.eye(3), (len(origin), 3, 3))
        products, lengths = self.products(rotation, origin), self._lengths(rotation, origin)
        slack = np.full(len(factors), 0.0)
        for at in range(3):
            slack += np.prod(np.delete(lengths, at, axis=0), axis=0)
        clear = np.abs(products) > ROUNDINGS * drawing.rounding * slack
        self.wanted = np.where(clear, np.sign(products), 0.0)
        self.drawn = self.shares(rotation, origin)

    def products(self, rotation: Array, origin: Array) -> Array:
        """(..., sides) a . b or (a x b) . c at poses (..., bodies, 3, 3) and (..., bodies, 3)."""
        vectors = self._vectors(rotation, origin)
        count, triples = len(self._back), self._triples
        first, second = vectors[..., :count, :], vectors[..., count : 2 * count, :]
        if triples:
            first, second = first.copy(), second.copy()
            first[..., :triples, :] = cross(first[..., :triples, :], second[..., :triples, :])
            second[..., :triples, :] = vectors[..., 2 * count :, :]
        products: Array = np.vecdot(first, second).take(self._back, -1)
        return products

    def shares(self, rotation: Array, origin: Array) -> Array:
        """(sides,) products divided by the lengths of their factors, between -1 and 1."""
        lengths = np.prod(self._lengths(rotation, origin), axis=0)
        products = self.products(rotation, origin)
        shares: Array = np.divide(products, lengths, out=np.zeros_like(products), where=lengths > 0)
        return shares

    def kept(self, rotation: Array, origin: Array) -> NDArray[np.bool_]:
        """(...) whether all sides at poses are those of the drawing."""
        products = self.products(rotation, origin)
        kept: NDArray[np.bool_] = np.asarray((products * self.wanted > 0.0).all(-1))
        return kept

    def lost(self, rotation: Array, origin: Array) -> int:
        """The side whose share is furthest on the wrong side at one pose."""
        return int(np.argmin(self.shares(rotation, origin) * self.wanted))

    def _vectors(self, rotation: Array, origin: Array) -> Array:
        world = self._local @ rotation.swapaxes(-1, -2)
        world += self._is_point * origin[..., None, :]
        flat = world.reshape(*world.shape[:-3], -1, 3)
        vectors: Array = flat.take(self._ends, -2) - flat.take(self._starts, -2)
        return vectors

    def _lengths(self, rotation: Array, origin: Array) -> Array:
        """(3, sides) lengths of the factors at one pose; 1 for a factor that is not there."""
        found = np.linalg.norm(self._vectors(rotation, origin), axis=-1)
        count = len(self._back)
        lengths = np.ones((3, count))
        lengths[0], lengths[1] = found[:count], found[count : 2 * count]
        lengths[2, : self._triples] = found[2 * count :]
        return lengths[:, self._back]
