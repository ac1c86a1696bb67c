"""All rows of a mechanism at once: values, Jacobian and drift from the poses of its bodies.

Every row is a . e, with a a direction of the first body and e = f - g the difference of two
features: the partner direction and nothing (right angle), or point 2 and point 1 (offset). The
unknown velocities of a body are those of its frame's origin and its angular velocity, in world
axes: [o', w]. A feature f of a body moves with w x (f - c), c the origin for a point and zero for
a direction, so the row has the rate
    offset only:  a . (o2' - o1')     both:  w1 . (a x (f - c1)) - w2 . (a x (f - c2)).
"""

from typing import NamedTuple

import numpy as np

from absolute.rows import Rows
from absolute.solution import Array

_NEXT = np.array([1, 2, 0])
_LAST = np.array([2, 0, 1])


def cross(a: Array, b: Array) -> Array:
    """Vector product over the last axis; far quicker than numpy's for a few vectors."""
    product: Array = a.take(_NEXT, -1) * b.take(_LAST, -1) - a.take(_LAST, -1) * b.take(_NEXT, -1)
    return product


class Placed(NamedTuple):
    """Rows evaluated at poses.

    Attributes:
        turned: (..., bodies, places, 3) features of each body turned to world axes, without its origin.
        parts: (..., 5, rows, 3) the vectors a, f, g, c1, c2 of every row.
        reach: (..., rows, 3) e = f - g.
        values: (..., rows) a . e.
    """

    turned: Array
    parts: Array
    reach: Array
    values: Array


class RowStack:
    """Index arrays built once from the rows of a mechanism with `bodies` bodies, the chassis first."""

    def __init__(self, rows: Rows, bodies: int) -> None:
        every = [*rows.angles, *rows.offsets]
        self.owners = tuple(row.owner for row in every)
        self.count = count = len(every)
        self._bodies = bodies
        features = _Features(bodies)
        nothing = features.add(0, np.zeros(3), False)
        origins = [features.add(body, np.zeros(3), True) for body in range(bodies)]
        picks = [
            (features.add(r.first, r.direction, False), features.add(r.second, r.partner, False), *[nothing] * 3)
            for r in rows.angles
        ] + [
            (
                features.add(r.first, r.direction, False),
                features.add(r.second, r.second_arm, True),
                features.add(r.first, r.first_arm, True),
                origins[r.first],
                origins[r.second],
            )
            for r in rows.offsets
        ]
        self._local, self._is_point = features.tables()
        self._picks = np.array(features.flat(picks)).T.copy()
        # Places in the flat Jacobian and signs, in the order in which `jacobian` writes.
        self._offset_rows = slice(len(rows.angles), count)
        first, second = [row.first for row in every], [row.second for row in every]
        blocks = [(row, first[row], 0) for row in range(len(rows.angles), count)]
        blocks += [(row, second[row], 0) for row in range(len(rows.angles), count)]
        blocks += [(row, first[row], 3) for row in range(count)]
        blocks += [(row, second[row], 3) for row in range(count)]
        starts = np.array([6 * bodies * row + 6 * body + part for row, body, part in blocks], dtype=int)
        self._places = (starts[:, None] + np.arange(3)).ravel()
        offsets = 3 * len(rows.offsets)
        self._signs = np.repeat([-1.0, 1.0, 1.0, -1.0], [offsets, offsets, 3 * count, 3 * count])
        self._sense_bodies = [np.array([s[k] for s in rows.senses], dtype=int) for k in (1, 2)]
        self._sense_vectors = [np.array([s[k] for s in rows.senses]).reshape(-1, 3, 1) for k in (3, 4)]
        self.sense_owners = tuple(sense.owner for sense in rows.senses)

    def place(self, rotation: Array, origin: Array) -> Placed:
        """Rows at poses: rotation (..., bodies, 3, 3), origin (..., bodies, 3), in units of size."""
        turned = self._local @ rotation.swapaxes(-1, -2)
        parts = self._parts(turned + self._is_point * origin[..., None, :])
        reach = parts[..., 1, :, :] - parts[..., 2, :, :]
        return Placed(turned, parts, reach, np.einsum("...ij,...ij->...i", parts[..., 0, :, :], reach))

    def jacobian(self, placed: Placed) -> Array:
        """(..., rows, 6 * moving bodies), columns [o', w] of each moving body."""
        parts = placed.parts
        along = parts[..., 0, self._offset_rows, :]
        turning = cross(parts[..., :1, :, :], parts[..., 1:2, :, :] - parts[..., 3:, :, :])
        lead = parts.shape[:-3]
        flat = (*lead, -1)
        entries = np.concatenate((along.reshape(flat), along.reshape(flat), turning.reshape(flat)), -1)
        matrix = np.zeros((*lead, self.count * 6 * self._bodies))
        matrix[..., self._places] = entries * self._signs
        return matrix.reshape(*lead, self.count, 6 * self._bodies)[..., 6:]

    def drift(self, placed: Placed, velocity: Array, spin: Array) -> Array:
        """Second rate of the rows when no body accelerates: a''.e + 2 a'.e' + a.e''.

        Args:
            velocity: (..., bodies, 3) of the body origins. spin: (..., bodies, 3) angular.
        """
        x, y, z = spin[..., 0], spin[..., 1], spin[..., 2]
        # Transposed matrix of "spin x", for features as rows.
        wheel = np.zeros((*spin.shape, 3))
        wheel[..., 0, 1], wheel[..., 0, 2], wheel[..., 1, 2] = z, -y, x
        wheel[..., 1, 0], wheel[..., 2, 0], wheel[..., 2, 1] = -z, y, -x
        rate = placed.turned @ wheel
        first = self._parts(rate + self._is_point * velocity[..., None, :])
        second = self._parts(rate @ wheel)
        a = placed.parts[..., 0, :, :]
        drift: Array = np.einsum(
            "...ij,...ij->...i", second[..., 0, :, :], placed.reach
        ) + np.einsum(
            "...ij,...ij->...i", a, second[..., 1, :, :] - second[..., 2, :, :]
        )  # fmt: skip
        drift += 2.0 * np.einsum(
            "...ij,...ij->...i", first[..., 0, :, :], first[..., 1, :, :] - first[..., 2, :, :]
        )
        return drift

    def senses(self, rotation: Array) -> Array:
        """(..., senses) products that stay positive while no joint is reversed."""
        first, second = (
            (rotation.take(body, -3) @ vector)[..., 0]
            for body, vector in zip(self._sense_bodies, self._sense_vectors, strict=True)
        )
        products: Array = (first * second).sum(-1)
        return products

    def _parts(self, features: Array) -> Array:
        flat = features.reshape(*features.shape[:-3], -1, 3)
        picked: Array = flat.take(self._picks, -2)
        return picked


class _Features:
    """Directions and points of each body, each kept once."""

    def __init__(self, bodies: int) -> None:
        self._of_body: list[dict[tuple[bytes, bool], tuple[Array, bool]]] = [{} for _ in range(bodies)]

    def add(self, body: int, vector: Array, is_point: bool) -> tuple[int, int]:
        """(body, place) of a feature given in body axes."""
        features = self._of_body[body]
        key = (vector.tobytes(), is_point)
        features.setdefault(key, (vector, is_point))
        return body, list(features).index(key)

    def tables(self) -> tuple[Array, Array]:
        """Vectors (bodies, places, 3), padded with zeros, and 1.0 where a feature is a point."""
        places = max(len(features) for features in self._of_body)
        vectors = np.zeros((len(self._of_body), places, 3))
        is_point = np.zeros((len(self._of_body), places, 1))
        for body, features in enumerate(self._of_body):
            for place, (vector, point) in enumerate(features.values()):
                vectors[body, place], is_point[body, place] = vector, float(point)
        return vectors, is_point

    def flat(self, picks: list[tuple[tuple[int, int], ...]]) -> list[list[int]]:
        """Places in the flattened table."""
        places = max(len(features) for features in self._of_body)
        return [[body * places + place for body, place in pick] for pick in picks]
