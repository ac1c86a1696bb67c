"""Joints and inputs as rows: values, Jacobian and drift from the poses of the bodies, for all rows at once.

A row is a . e, with a a direction of the first body. For a right angle, e is a partner direction of the
second body; for an offset, e is the second point minus the first. The unknown velocities of a body are those
of its frame's origin and its angular velocity, in world axes: [o', w]. With r1 and r2 the arms of both points
from the origins (for a right angle: zero and the partner direction), a row has the rate
    offset only:  a . (o2' - o1')     both:  w1 . (a x (r1 + e)) + w2 . (r2 x a).
Arms are rotated directly: differences of points far from the origin would lose digits.

A distance |e| is such a row with a = e / |e|. It has the same rate, since a' is normal to e.
The turn t of axes x, y of the first body to x2, y2 of the second, about a common third axis, has
cos t = y . y2 and sin t = -x . y2. Its rate is that of the right angle -(x cos t + y sin t) . y2, which is 0
there with t held. Its value is known up to whole turns: `gap` takes the nearest.

A row's rate of order n with zero body rates of that order is the n-th derivative of a . e by the product
rule: a, r1 and r2 turn with their bodies, e = o2 + r2 - o1 - r1. The rate of a distance l follows from l l =
e . e, and that of a turn from t' = z . (w2 - w1), z the common axis. (The change of t is also an arcsine of a
. e, but the rounding of its derivatives grows with the factorial of the order.)
"""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from absolute.model import Row
from absolute.vectors import EPS, Array, carried, cross, product_rule

# A row is a sum of products of rotated vectors and origins. Its terms have about 27 roundings of eps / 2:
# four in the quaternion, four in its products, three in the rotation, two in the origin, eleven in the
# direction, three in the last product. Independent ones add up to sqrt(27 / 3) of eps / 2, or 1.5 eps; more
# than 4 eps is not rounding alone.
ROUNDINGS = 4 * EPS

WHOLE_TURN = 2.0 * np.pi


class Placed(NamedTuple):
    """Rows evaluated at poses.

    Attributes:
        rotation, origin: (..., bodies, 3, 3) and (..., bodies, 3) poses of the bodies.
        vectors: (..., 3, rows, 3) a, r1 and r2 of every row. e: (..., rows, 3).
        values: (..., rows) a . e; for turns the angle between -pi and pi.
    """

    rotation: Array
    origin: Array
    vectors: Array
    e: Array
    values: Array


class RowStack:
    """All rows of a mechanism.

    Attributes:
        owners: names of the rows' joints and inputs. first, second: their bodies.
        drawn: values that joints keep.
        count, unknowns: numbers of rows and columns of the Jacobian; its columns are the unknowns among
            [o', w] of all bodies.
    """

    def __init__(self, rows: Sequence[Row], bodies: int, columns: NDArray[np.intp]) -> None:
        def indices(numbers: Iterable[int]) -> NDArray[np.intp]:
            return np.array([*numbers], dtype=np.intp)

        self.count, self.unknowns = len(rows), len(columns)
        self.owners = tuple(row.owner for row in rows)
        self.first, self.second = indices(r.first for r in rows), indices(r.second for r in rows)
        self.drawn = np.array([row.drawn for row in rows])
        # a, r1 and r2 of all rows, (3, rows, 3), and the bodies that they belong to.
        vectors = np.array([(row.along, row.first_arm, row.second_arm) for row in rows])
        self._local = vectors.reshape(-1, 3, 3).swapaxes(0, 1)
        self._holders = np.array((self.first, self.first, self.second))
        # Vectors grouped by body, to be rotated by one product, and the index of each vector afterwards.
        own = [np.flatnonzero(self._holders == body) for body in range(bodies)]
        self._beside, places = np.zeros((bodies, 3, max(map(len, own)))), np.zeros(3 * self.count, np.intp)
        for body, numbers in enumerate(own):
            self._beside[body, :, : len(numbers)] = self._local.reshape(-1, 3)[numbers].T
            places[numbers] = self._beside[0].size * body + np.arange(len(numbers))
        read = places[:, None] + self._beside.shape[2] * np.arange(3)
        self._read = read.reshape(3, self.count, 3)
        self._distances, self._turns = (
            indices(number for number, row in enumerate(rows) if row.kind == kind)
            for kind in ("distance", "turn")
        )
        # Repeated to the width of the vectors that it multiplies: broadcasting takes longer.
        offset = [float(row.kind in ("offset", "distance")) for row in rows]
        self._offset, self._offsets = np.array(offset), np.repeat(np.reshape(offset, (-1, 1)), 3, axis=1)
        # Largest sum of a row's terms, without the distances of the origins.
        self._spans = np.sqrt(np.vecdot(self._local[1:], self._local[1:])).sum(axis=0)
        # Index of each entry of the Jacobian among the four vectors of a row's rate, row by row, and a zero.
        entries = np.arange(12 * self.count).reshape(4, self.count, 3)
        source = np.full((self.count, bodies, 2, 3), entries.size)
        for number, row in enumerate(rows):
            source[number, row.first] = entries[:2, number]
            source[number, row.second] = entries[2:, number]
        self._source = source.reshape(self.count, 6 * bodies)[:, columns]

    def place(self, rotation: Array, origin: Array) -> Placed:
        """Evaluate rows at poses: rotation (..., bodies, 3, 3), origin (..., bodies, 3), in units of size."""
        turned = rotation @ self._beside
        vectors = turned.reshape(*turned.shape[:-3], self._beside.size).take(self._read, -1)
        a, r1, r2 = (vectors[..., kind, :, :] for kind in range(3))
        e = self._offsets * (origin.take(self.second, -2) - origin.take(self.first, -2)) + (r2 - r1)
        if self._distances.size:
            along = e[..., self._distances, :]
            a[..., self._distances, :] = along / np.sqrt(np.vecdot(along, along))[..., None]
        if self._turns.size:
            x, y2 = a[..., self._turns, :], -e[..., self._turns, :]
            y = np.matvec(rotation.take(self.first[self._turns], -3), -self._local[2, self._turns])
            cosine, sine = np.vecdot(y, y2), -np.vecdot(x, y2)
            level = cosine[..., None] * x + sine[..., None] * y
            a[..., self._turns, :] = level / np.hypot(cosine, sine)[..., None]
        values = np.vecdot(a, e)
        if self._turns.size:
            values[..., self._turns] = np.arctan2(sine, cosine)
        return Placed(rotation, origin, vectors, e, values)

    def gap(self, placed: Placed, target: Array) -> Array:
        """(..., rows) target minus value; for turns the nearest of all equivalent targets."""
        gap: Array = target - placed.values
        if self._turns.size:
            gap[..., self._turns] -= WHOLE_TURN * np.round(gap[..., self._turns] / WHOLE_TURN)
        return gap

    def owners_of(self, rows: Iterable[int]) -> tuple[str, ...]:
        """Names of the joints and inputs of these rows, each once."""
        return tuple(dict.fromkeys(self.owners[row] for row in rows))

    def read_at_foot(self, placed: Placed, gap: Array) -> Placed:
        """Open rows with their joints' forces at the foot on the first body.

        In a joint that is open by m, the sum of its rows' -gap a, the rate of a row may be taken with its
        force at the point of the second body, as in `place`, or at the foot of that point on the axis of the
        first,
            a . (o2' + w2 x (r2 - m) - o1' - w1 x (r1 + e - m)).
        They are equal when the joint is closed. Directions of right angles are treated likewise.
        """
        owner, partner = np.array(self.owners), self._local[2]
        # Rows of one joint about the same point, or the same direction.
        same = np.equal.outer(owner, owner) & np.equal.outer(self._offset, self._offset)
        mates = (same & (partner[:, None] == partner).all(-1)).astype(float)
        vectors = placed.vectors.copy()
        vectors[..., 1:, :, :] += (mates @ (gap[..., None] * vectors[..., 0, :, :]))[..., None, :, :]
        return placed._replace(vectors=vectors)

    def jacobian(self, placed: Placed) -> Array:
        """The Jacobian, (..., rows, unknowns)."""
        a, r1, r2 = (placed.vectors[..., kind, :, :] for kind in range(3))
        push = self._offsets * a
        none = np.zeros((*a.shape[:-2], 1, 3))
        entries = np.concatenate((-push, cross(a, r1 + placed.e), push, cross(r2, a), none), -2)
        matrix: Array = entries.reshape(*a.shape[:-2], 12 * self.count + 3).take(self._source, -1)
        return matrix

    def rounding(self, placed: Placed) -> Array:
        """(..., rows) largest rounding error of each row: ROUNDINGS times the lengths of its vectors."""
        far = np.sqrt(np.vecdot(placed.origin, placed.origin))
        between = far.take(self.first, -1) + far.take(self.second, -1)
        return np.asarray(ROUNDINGS * (self._spans + self._offset * between))

    def drift(self, placed: Placed, rates: Sequence[Array]) -> Array:
        """Rate of the rows, one order higher than the given body rates, if the bodies' rates of it are zero.

        Args:
            rates: [o', w], [o'', w'] and so on of the bodies, each (..., bodies, 2, 3).
        """
        order = len(rates) + 1
        held = [rate.take(self._holders, -3) for rate in rates]
        turned = carried(placed.vectors, [each[..., 1, :] for each in held], order + 1)
        along = [each[..., 0, :, :] for each in turned]
        apart = [placed.e, *(each[..., 2, :, :] - each[..., 1, :, :] for each in turned[1:])]
        for n, each in enumerate(held, 1):
            apart[n] += self._offsets * (each[..., 2, :, 0, :] - each[..., 1, :, 0, :])
        drift = _product(along, apart, order)
        if self._distances.size:
            drift[..., self._distances] = _of_length([e[..., self._distances, :] for e in apart])
        if self._turns.size:
            first, second = self.first[self._turns], self.second[self._turns]
            level = placed.vectors[..., 0, self._turns, :]
            axis = -cross(level, placed.e[..., self._turns, :])
            axes = carried(axis, [rate.take(first, -3)[..., 1, :] for rate in rates], order)
            spins = [(rate.take(second, -3) - rate.take(first, -3))[..., 1, :] for rate in rates]
            drift[..., self._turns] = _product(axes, [*spins, 0.0 * axis], order - 1)
        return drift


def _product(one: Sequence[Array], other: Sequence[Array], order: int) -> Array:
    """A derivative of the scalar product of two vectors, from the vectors' derivatives."""
    return np.asarray(product_rule(order, (np.vecdot(one[i], other[order - i]) for i in range(order + 1))))


def _of_length(vectors: Sequence[Array]) -> Array:
    """The highest derivative of a vector's length, from its derivatives (..., rows, 3): l l' = e . e'."""
    lengths = [np.sqrt(np.vecdot(vectors[0], vectors[0]))]
    for n in range(1, len(vectors)):
        whole = product_rule(n - 1, (np.vecdot(vectors[i], vectors[n - i]) for i in range(n)))
        known = product_rule(n - 1, (lengths[i] * lengths[n - i] if i else 0.0 for i in range(n)))
        lengths.append((whole - known) / lengths[0])
    return np.asarray(lengths[-1])
