"""All rows of a mechanism at once: values, Jacobian and drift from the poses of its bodies.

Every row is a . e, with a a direction of the first body and e = f - g the difference of two
features: the partner direction and nothing (right angle), or point 2 and point 1 (offset). The
unknown velocities of a body are those of its frame's origin and its angular velocity, in world
axes: [o', w]. A point p of a body moves with o' + w x r, r its arm from the origin, a direction d
with w x d. With r1 and r2 the arms of both points, or nothing and the partner direction, the row
has the rate
    offset only:  a . (o2' - o1')     both:  w1 . (a x (r1 + e)) - w2 . (a x r2).
The arms are turned by themselves: as differences of points far out they would be rounded as those.

A distance |e| is such a row with a = e / |e|, and has that rate, since a' is at a right angle to e.
The turn t of axes x, y of the first and x2, y2 of the second body about a common third one, with
cos t = x . x2 and sin t = y . x2, has the rate of the right angle  -(x cos t + y sin t) . y2  which is 0
there, t held. Its value is known up to whole turns: `gap` takes the nearest.

With the turning a1 = w1 x a and the velocity v of e as it is seen from the first body, a row's rate is a . v
and its second rate, when no body accelerates,
    a1 . (2 v + t1) - (w2 x a) . t2,    v = s2 + t2 - s1 - t1,    t1 = w1 x (r1 + e),    t2 = w2 x r2,
s the velocity of an origin, and of a distance (v . v - (a . v)^2) / |e| more.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from absolute.precision import EPS
from absolute.rows import Angle, Offset, Rows, Turn
from absolute.solution import Array
from absolute.vectors import LAST, NEXT, cross

# A row is a sum of products of turned features and origins. About 27 roundings of eps / 2 of its terms
# meet in it: four from the quaternion, four from its products, three from the turning, two from the
# origin, eleven from the direction, three from the last product. Independent ones add up to
# sqrt(27 / 3) of eps / 2, or 1.5 eps; more than 4 eps is not rounding alone.
ROUNDINGS = 4 * EPS

WHOLE_TURN = 2.0 * np.pi


class Placed(NamedTuple):
    """Rows evaluated at poses.

    Attributes:
        world: (..., bodies * places, 3) the features where they are.
        parts: (..., 5, rows, 3) the vectors a, f, g, r1 + e, r2 of every row.
        reach: (..., rows, 3) e = f - g.
        values: (..., rows) a . e, and turns between -pi and pi.
        origin: (..., bodies, 3) of the bodies.
    """

    world: Array
    parts: Array
    reach: Array
    values: Array
    origin: Array


class RowStack:
    """Index arrays built once from the rows of a mechanism."""

    def __init__(self, rows: Rows, bodies: int) -> None:
        table: dict[tuple[int, tuple[float, ...], bool], int] = {}

        def feature(body: int, vector: Array, is_point: bool = False) -> int:
            """The place of a point or direction in the axes of a body; each is kept once."""
            return table.setdefault((body, tuple(vector.tolist()), is_point), len(table))

        every: list[Angle | Offset | Turn] = [*rows.angles, *rows.offsets, *rows.turns]
        self.owners = tuple(row.owner for row in every)
        self.count = count = len(every)
        # What joints hold each row to: the drawn lengths of distances.
        self.drawn = np.zeros(count)
        nothing = feature(0, np.zeros(3))
        partners = [feature(r.second, r.partner) for r in rows.angles]
        picks = [
            (feature(r.first, r.direction), partner, nothing, nothing, partner)
            for r, partner in zip(rows.angles, partners, strict=True)
        ] + [
            (
                nothing if r.direction is None else feature(r.first, r.direction),
                feature(r.second, r.second_arm, is_point=True),
                feature(r.first, r.first_arm, is_point=True),
                feature(r.first, r.first_arm),
                feature(r.second, r.second_arm),
            )
            for r in rows.offsets
        ]
        for r in rows.turns:
            partner = feature(r.second, -r.frame[1])
            picks.append((nothing, partner, nothing, nothing, partner))
        turned = [
            (
                feature(r.first, r.frame[0]),
                feature(r.first, r.frame[1]),
                feature(r.second, r.frame[0]),
            )
            for r in rows.turns
        ]
        senses = [(feature(r.first, r.direction), feature(r.second, r.partner)) for r in rows.senses]
        # What the terms of a row add up to at most, apart from the distances of the origins.
        arms = np.array([(r.first_arm, r.second_arm) for r in rows.offsets]).reshape(-1, 2, 3)
        self._spans = np.ones(count)
        self.offset_rows = slice(len(rows.angles), count - len(rows.turns))
        self._spans[self.offset_rows] = np.linalg.norm(arms, axis=-1).sum(axis=1)
        # How often the distance of a body's origin counts in a row: not at all for angles.
        self._between = np.zeros((bodies, count))
        for row, offset in enumerate(rows.offsets, len(rows.angles)):
            self._between[[offset.first, offset.second], row] = 1.0
        # One after the other for each body, as many for all: one product turns them.
        own = [[of for of in table if of[0] == body] for body in range(bodies)]
        width = max(map(len, own))
        self._local, self._is_point = np.zeros((bodies, width, 3)), np.zeros((bodies, width, 1))
        where = np.empty(len(table), dtype=np.intp)
        for body, features in enumerate(own):
            for place, of in enumerate(features):
                self._local[body, place], self._is_point[body, place] = of[1:]
                where[table[of]] = body * width + place
        self._picks = where[np.array(picks)].T.copy()
        # Rows of one joint that say where the same point, or direction, is.
        owner = np.array(self.owners)
        self._mates = ((owner[:, None] == owner) & np.equal.outer(self._picks[1], self._picks[1])).astype(
            float
        )
        self._senses = where[np.array(senses, dtype=np.intp)].reshape(-1, 2).T.copy()
        self._turned = where[np.array(turned, dtype=np.intp)].reshape(-1, 3).T.copy()
        self.turn_rows = slice(count - len(rows.turns), count)
        self.drawn[self.offset_rows] = [of.length for of in rows.offsets]
        self._is_offset = np.zeros((count, 1))
        self._is_offset[self.offset_rows] = 1.0
        first = self.offset_rows.start
        self.distances = np.array(
            [row for row, of in enumerate(rows.offsets, first) if of.direction is None], dtype=np.intp
        )
        # Where each entry of the Jacobian is found among [0, a and -a of offsets, w1 parts, w2 parts].
        angles = len(rows.angles)
        self._bodies = np.array([[row.first, row.second] for row in every]).reshape(-1, 2).T
        self.first, self.second = self._bodies
        source = np.zeros((count, bodies, 2, 3), dtype=int)
        axis = np.arange(3)
        pushes = 3 * len(rows.offsets)
        for row, one in enumerate(every):
            source[row, one.first, 1] = 1 + 2 * pushes + 3 * row + axis
            source[row, one.second, 1] = 1 + 2 * pushes + 3 * (count + row) + axis
            if isinstance(one, Offset):
                source[row, one.second, 0] = 1 + 3 * (row - angles) + axis
                source[row, one.first, 0] = 1 + pushes + 3 * (row - angles) + axis
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
        world = self._local @ rotation.swapaxes(-1, -2) + self._is_point * origin[..., None, :]
        world = world.reshape(*world.shape[:-3], -1, 3)
        parts: Array = world.take(self._picks, -2)
        reach = parts[..., 1, :, :] - parts[..., 2, :, :]
        if self.distances.size:
            along = reach[..., self.distances, :]
            parts[..., 0, self.distances, :] = along / np.sqrt(np.vecdot(along, along))[..., None]
        if self._turned.size:
            x, y, x2 = np.moveaxis(world.take(self._turned, -2), -3, 0)
            cosine, sine = np.vecdot(x, x2), np.vecdot(y, x2)
            parts[..., 0, self.turn_rows, :] = (cosine[..., None] * x + sine[..., None] * y) / np.hypot(
                cosine, sine
            )[..., None]
        parts[..., 3, :, :] += reach
        values = np.vecdot(parts[..., 0, :, :], reach)
        if self._turned.size:
            values[..., self.turn_rows] = np.arctan2(sine, cosine)
        return Placed(world, parts, reach, values, origin)

    def gap(self, placed: Placed, target: Array) -> Array:
        """(..., rows) target less value, of turns to the nearest of all that look alike."""
        gap: Array = target - placed.values
        if self._turned.size:
            turns = gap[..., self.turn_rows]
            turns -= WHOLE_TURN * np.round(turns / WHOLE_TURN)
        return gap

    def kept(self, placed: Placed) -> NDArray[np.bool_]:
        """(...) whether all joints have the sense in which they are drawn."""
        first, second = _two(placed.world.take(self._senses, -2))
        return np.asarray((np.vecdot(first, second) > 0.0).all(-1))

    def read_at_foot(self, placed: Placed, gap: Array) -> Placed:
        """Rows that are not closed, with their joints' forces where they belong on the first body.

        Where a joint is off by m, the sum of its rows' -gap a, each row's rate may be taken with its force at
        the point of the second body, as in `place`, or at its foot on the axis of the first,
            a . (o2' + w2 x (r2 - m) - o1' - w1 x (r1 + e - m)),
        and once it is closed both are the same. Directions of right angles likewise.
        """
        missed = self._mates @ (-gap[..., None] * placed.parts[..., 0, :, :])
        parts = placed.parts.copy()
        parts[..., 3:, :, :] -= missed[..., None, :, :]
        return placed._replace(parts=parts)

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
        return np.asarray((np.abs(self.gap(placed, target)) <= self.rounding(placed)).all(-1))

    def rounding(self, placed: Placed) -> Array:
        """(..., rows) what rounding alone may make of a row."""
        far = np.sqrt(np.vecdot(placed.origin, placed.origin))
        return np.asarray(ROUNDINGS * (self._spans + far @ self._between))

    def drift(self, placed: Placed, rates: Array) -> Array:
        """Second rate of the rows when no body accelerates, at rates [o', w], (..., bodies, 2, 3)."""
        both = rates.take(self._bodies, -3)
        spin, parts = both[..., 1, :], placed.parts
        t1, t2 = _two(cross(spin, parts[..., 3:, :, :]))
        a1, a2 = _two(cross(spin, parts[..., :1, :, :]))
        v = (both[..., 1, :, 0, :] - both[..., 0, :, 0, :]) * self._is_offset + t2 - t1
        drift: Array = np.vecdot(a1, 2.0 * v + t1) - np.vecdot(a2, t2)
        if self.distances.size:
            a, v = placed.parts[..., 0, self.distances, :], v[..., self.distances, :]
            along = np.vecdot(a, v)
            drift[..., self.distances] += (np.vecdot(v, v) - along * along) / placed.values[
                ..., self.distances
            ]
        return drift


def _two(pair: Array) -> tuple[Array, Array]:
    """The two of an array (..., 2, rows, 3)."""
    return pair[..., 0, :, :], pair[..., 1, :, :]
