"""All rows of a mechanism at once: values, Jacobian and drift from the poses of its bodies.

Unknown velocities are, for each moving body, the velocity of its frame's origin and its angular
velocity, both in world axes: [o', w]. With a the direction of the first body and e the vector it
is multiplied with (a direction b of the second body, or d = p2 - p1), the row a . e has the rate
    right angle:  w1 . (a x b) - w2 . (a x b)
    offset:       a . (o2' - o1') + w1 . (a x (p2 - o1)) - w2 . (a x (p2 - o2)).
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
    """Rows evaluated at poses: world vectors (..., vectors, 3), row vectors e, row values."""

    vectors: Array
    reach: Array
    values: Array


class RowStack:
    """Index arrays built once from the rows of a mechanism with `bodies` bodies, the chassis first."""

    def __init__(self, rows: Rows, bodies: int) -> None:
        every = [*rows.angles, *rows.offsets]
        self.owners = tuple(row.owner for row in every)
        self.count = count = len(every)
        self._bodies = bodies
        self._angles = angles = len(rows.angles)
        # World vectors, in this order: a of every row, b of right angles, both arms of offsets.
        local = [row.direction for row in every]
        local += [row.partner for row in rows.angles]
        local += [row.first_arm for row in rows.offsets] + [row.second_arm for row in rows.offsets]
        self._local = np.array(local)[:, :, None]
        first, second = [row.first for row in every], [row.second for row in every]
        self._owner = np.array(first + second[:angles] + first[angles:] + second[angles:])
        self._first, self._second = np.array(first[angles:]), np.array(second[angles:])
        self._cuts = (count, count + angles, 2 * count, 3 * count - angles)
        # Places in the flat Jacobian, in the order in which `jacobian` writes.
        axis = np.arange(3)

        def places(row_indices: range, of_bodies: list[int], part: int) -> Array:
            starts = [(6 * bodies * r + 6 * b + part) for r, b in zip(row_indices, of_bodies, strict=True)]
            return (np.array(starts, dtype=int)[:, None] + axis).ravel()

        offset_rows = range(angles, count)
        self._places = np.concatenate(
            [
                places(offset_rows, first[angles:], 0),
                places(offset_rows, second[angles:], 0),
                places(range(count), first, 3),
                places(range(count), second, 3),
            ]
        )
        sense = rows.senses
        self._sense_bodies = (np.array([s.first for s in sense], int), np.array([s.second for s in sense], int))
        self._sense_vectors = (
            np.array([s.direction for s in sense]).reshape(-1, 3, 1),
            np.array([s.partner for s in sense]).reshape(-1, 3, 1),
        )
        self.sense_owners = tuple(s.owner for s in sense)

    def place(self, rotation: Array, origin: Array) -> Placed:
        """Rows at poses: rotation (..., bodies, 3, 3), origin (..., bodies, 3), in units of size."""
        vectors = (rotation.take(self._owner, -3) @ self._local)[..., 0]
        a, b, arm1, arm2 = self._split(vectors)
        parted = arm2 - arm1 + (origin.take(self._second, -2) - origin.take(self._first, -2))
        reach = np.concatenate((b, parted), -2)
        return Placed(vectors, reach, np.einsum("...ij,...ij->...i", a, reach))

    def jacobian(self, placed: Placed) -> Array:
        """(..., rows, 6 * moving bodies), columns [o', w] of each moving body."""
        a, b, arm1, arm2 = self._split(placed.vectors)
        k = self._angles
        along = a[..., k:, :]
        from_first = np.concatenate((b, placed.reach[..., k:, :] + arm1), -2)
        from_second = np.concatenate((b, arm2), -2)
        parts = (-along, along, cross(a, from_first), cross(from_second, a))
        lead = a.shape[:-2]
        matrix = np.zeros((*lead, self.count * 6 * self._bodies))
        matrix[..., self._places] = np.concatenate(parts, -2).reshape(*lead, -1)
        return matrix.reshape(*lead, self.count, 6 * self._bodies)[..., 6:]

    def drift(self, placed: Placed, velocity: Array, spin: Array) -> Array:
        """Second rate of the rows when no body accelerates: a''.e + 2 a'.e' + a.e''.

        Args:
            velocity: (..., bodies, 3) of the body origins. spin: (..., bodies, 3) angular.
        """
        turning = spin.take(self._owner, -2)
        rate = cross(turning, placed.vectors)
        second_rate = cross(turning, rate)
        a, (a1, b1, f1, s1), (a2, b2, f2, s2) = (
            self._split(placed.vectors)[0],
            self._split(rate),
            self._split(second_rate),
        )
        parting = s1 - f1 + (velocity.take(self._second, -2) - velocity.take(self._first, -2))
        reach1 = np.concatenate((b1, parting), -2)
        reach2 = np.concatenate((b2, s2 - f2), -2)
        drift: Array = (a2 * placed.reach + 2.0 * a1 * reach1 + a * reach2).sum(-1)
        return drift

    def senses(self, rotation: Array) -> Array:
        """(..., senses) products that stay positive while no joint is reversed."""
        first, second = (
            (rotation.take(body, -3) @ vector)[..., 0]
            for body, vector in zip(self._sense_bodies, self._sense_vectors, strict=True)
        )
        products: Array = (first * second).sum(-1)
        return products

    def _split(self, vectors: Array) -> tuple[Array, Array, Array, Array]:
        i, j, k, m = self._cuts
        return vectors[..., :i, :], vectors[..., i:j, :], vectors[..., j:k, :], vectors[..., k:m, :]
