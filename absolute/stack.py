"""All rows of a mechanism at once: values, Jacobian and drift from the poses of its bodies.

Every row is a . e, with a a direction of the first body and e = f - g the difference of two
features: the partner direction and nothing (right angle), or point 2 and point 1 (offset). The
unknown velocities of a body are those of its frame's origin and its angular velocity, in world
axes: [o', w]. A point p of a body moves with o' + w x r, r its arm from the origin, a direction d
with w x d. With r1 and r2 the arms of both points, or nothing and the partner direction, the row
has the rate
    offset only:  a . (o2' - o1')     both:  w1 . (a x (r1 + e)) - w2 . (a x r2).
The arms are turned by themselves: as differences of points far out they would be rounded as those.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from absolute.features import Features
from absolute.precision import EPS
from absolute.rows import Angle, Offset, Rows
from absolute.solution import Array
from absolute.vectors import LAST, NEXT

# w @ WHEEL is the transposed matrix of "w x", row by row: features are kept as rows.
WHEEL = np.array([np.cross(axis, np.eye(3)).ravel() for axis in np.eye(3)])

# A row is a sum of products of turned features and origins. About 27 roundings of eps / 2 of its terms
# meet in it: four from the quaternion, four from its products, three from the turning, two from the
# origin, eleven from the direction, three from the last product. Independent ones add up to
# sqrt(27 / 3) of eps / 2, or 1.5 eps; more than 4 eps is not rounding alone.
ROUNDINGS = 4 * EPS


class Placed(NamedTuple):
    """Rows evaluated at poses.

    Attributes:
        turned: (..., bodies, places, 3) features of each body turned to world axes, without its origin.
        world: (..., bodies * places, 3) the features where they are.
        parts: (..., 5, rows, 3) the vectors a, f, g, r1 + e, r2 of every row.
        reach: (..., rows, 3) e = f - g.
        values: (..., rows) a . e.
        origin: (..., bodies, 3) of the bodies.
    """

    turned: Array
    world: Array
    parts: Array
    reach: Array
    values: Array
    origin: Array


class RowStack:
    """Index arrays built once from the rows of a mechanism; its features are added to those given."""

    def __init__(self, rows: Rows, features: Features) -> None:
        every: list[Angle | Offset] = [*rows.angles, *rows.offsets]
        self.owners = tuple(row.owner for row in every)
        self.count = count = len(every)
        bodies = features.bodies
        nothing = features.add(0, np.zeros(3), False)
        partners = [features.add(r.second, r.partner, False) for r in rows.angles]
        picks = [
            (features.add(r.first, r.direction, False), partner, nothing, nothing, partner)
            for r, partner in zip(rows.angles, partners, strict=True)
        ] + [
            (
                features.add(r.first, r.direction, False),
                features.add(r.second, r.second_arm, True),
                features.add(r.first, r.first_arm, True),
                features.add(r.first, r.first_arm, False),
                features.add(r.second, r.second_arm, False),
            )
            for r in rows.offsets
        ]
        # What the terms of a row add up to at most, apart from the distances of the origins.
        arms = np.array([(r.first_arm, r.second_arm) for r in rows.offsets]).reshape(-1, 2, 3)
        self._spans = np.append(np.ones(len(rows.angles)), np.linalg.norm(arms, axis=-1).sum(axis=1))
        # How often the distance of a body's origin counts in a row: not at all for angles.
        self._between = np.zeros((bodies, count))
        for row, offset in enumerate(rows.offsets, len(rows.angles)):
            self._between[[offset.first, offset.second], row] = 1.0
        self._local, self._is_point = features.tables()
        self._picks = np.array(features.flat(picks)).T.copy()
        # Where each entry of the Jacobian is found among [0, a and -a of offsets, w1 parts, w2 parts].
        angles = len(rows.angles)
        self.offset_rows = slice(angles, count)
        self.first, self.second = np.array([[row.first, row.second] for row in every]).reshape(-1, 2).T
        source = np.zeros((count, bodies, 2, 3), dtype=int)
        axis = np.arange(3)
        pushes = 3 * (count - angles)
        for row, of in enumerate(every):
            source[row, of.first, 1] = 1 + 2 * pushes + 3 * row + axis
            source[row, of.second, 1] = 1 + 2 * pushes + 3 * (count + row) + axis
            if row >= angles:
                source[row, of.second, 0] = 1 + 3 * (row - angles) + axis
                source[row, of.first, 0] = 1 + pushes + 3 * (row - angles) + axis
        self._none = np.zeros(1)
        # Column by column, the order in which a factorisation reads without a copy.
        self._source = source[:, 1:].reshape(count, -1).T.copy()
        # Numbers in the flat parts from which a x (r1 + e) and r2 x a are multiplied out.
        part = np.arange(5 * count * 3).reshape(5, count, 3)
        a, r1, r2 = part[0], part[3], part[4]
        self._turn_a = np.array([[a[:, NEXT], a[:, LAST]], [a[:, LAST], a[:, NEXT]]])
        self._turn_r = np.array([[r1[:, LAST], r1[:, NEXT]], [r2[:, NEXT], r2[:, LAST]]])

    def place(self, rotation: Array, origin: Array) -> Placed:
        """Rows at poses: rotation (..., bodies, 3, 3), origin (..., bodies, 3), in units of size."""
        turned = self._local @ rotation.swapaxes(-1, -2)
        world = turned + self._is_point * origin[..., None, :]
        world = world.reshape(*world.shape[:-3], -1, 3)
        parts: Array = world.take(self._picks, -2)
        reach = parts[..., 1, :, :] - parts[..., 2, :, :]
        parts[..., 3, :, :] += reach
        return Placed(turned, world, parts, reach, np.vecdot(parts[..., 0, :, :], reach), origin)

    def jacobian(self, placed: Placed) -> Array:
        """(..., rows, 6 * moving bodies), columns [o', w] of each moving body."""
        lead = placed.parts.shape[:-3]
        numbers = placed.parts.reshape(*lead, -1)
        products = numbers.take(self._turn_a, -1) * numbers.take(self._turn_r, -1)
        turning = (products[..., 0, :, :] - products[..., 1, :, :]).reshape(*lead, -1)
        return self.matrix(placed.parts[..., 0, self.offset_rows, :].reshape(*lead, -1), turning)

    def matrix(self, along: Array, turning: Array) -> Array:
        """Rows that are linear in [o', w] of their two bodies, all others left out.

        Args:
            along: (..., 3 * offset rows) what the second origin is multiplied by, the first by its
                negative. turning: (..., 6 * rows) the same for the first bodies' w, then the second's.
        Returns:
            (..., rows, 6 * moving bodies).
        """
        none = self._none if along.ndim == 1 else np.zeros((*along.shape[:-1], 1))
        entries = np.concatenate((none, along, -along, turning), -1)
        matrix: Array = entries.take(self._source, -1)
        return matrix.swapaxes(-1, -2)

    def closed(self, placed: Placed, target: Array) -> NDArray[np.bool_]:
        """(...) whether no row misses its target by more than rounding: ROUNDINGS times the lengths of
        the vectors that add up to it."""
        far = np.sqrt(np.vecdot(placed.origin, placed.origin))
        rounding = ROUNDINGS * (self._spans + far @ self._between)
        closed: NDArray[np.bool_] = np.asarray((np.abs(target - placed.values) <= rounding).all(-1))
        return closed

    def drift(self, placed: Placed, velocity: Array, spin: Array) -> Array:
        """Second rate of the rows when no body accelerates: a''.e + 2 a'.e' + a.e''.

        Args:
            velocity: (..., bodies, 3) of the body origins. spin: (..., bodies, 3) angular.
        """
        turning = (spin @ WHEEL).reshape(*spin.shape, 3)
        rate = placed.turned @ turning
        first = self._parts(rate + self._is_point * velocity[..., None, :])
        second = self._parts(rate @ turning)
        drift: Array = np.vecdot(second[..., 0, :, :], placed.reach)
        drift += np.vecdot(placed.parts[..., 0, :, :], second[..., 1, :, :] - second[..., 2, :, :])
        drift += 2.0 * np.vecdot(first[..., 0, :, :], first[..., 1, :, :] - first[..., 2, :, :])
        return drift

    def _parts(self, features: Array) -> Array:
        flat = features.reshape(*features.shape[:-3], -1, 3)
        # The vectors a, f and g: arms have no rates of their own in a row.
        picked: Array = flat.take(self._picks[:3], -2)
        return picked
