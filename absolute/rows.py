"""Joints and inputs as rows: their values, Jacobian and drift from the poses of the bodies, all at once.

A joint is a pair of frames, one on each body, with z along the axis; its rows are picked from
    (x1 . d, y1 . d, z1 . d), d from origin 1 to origin 2;    (axis i of 1) . (axis j of 2).

So every row is a . e, with a a direction of the first body and e the partner direction (right angle), or
point 2 less point 1 (offset). The unknown velocities of a body are those of its frame's origin and its
angular velocity, in world axes: [o', w]. With r1 and r2 the arms of both points from the origins, or nothing
and the partner direction, a row has the rate
    offset only:  a . (o2' - o1')     both:  w1 . (a x (r1 + e)) + w2 . (r2 x a).
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

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from absolute.description import KINDS, Joint, Model
from absolute.drawing import Drawing
from absolute.errors import DescriptionError
from absolute.solution import Array
from absolute.vectors import EPS, cross

# A row is a sum of products of turned features and origins. About 27 roundings of eps / 2 of its terms
# meet in it: four from the quaternion, four from its products, three from the turning, two from the
# origin, eleven from the direction, three from the last product. Independent ones add up to
# sqrt(27 / 3) of eps / 2, or 1.5 eps; more than 4 eps is not rounding alone.
ROUNDINGS = 4 * EPS

WHOLE_TURN = 2.0 * np.pi
NOTHING = np.zeros(3)


class Row(NamedTuple):
    """A row of bodies `first` and `second` (indices), by vectors in their axes.

    Attributes:
        kind: "angle", "offset", "distance" or "turn".
        along: a; of a turn x; nothing of a distance.
        first_arm, second_arm: r1 and r2; nothing and the partner direction, of a turn -y.
        drawn: what joints hold it to: 0, or the drawn distance.
    """

    owner: str
    kind: str
    first: int
    second: int
    along: Array
    first_arm: Array
    second_arm: Array
    drawn: float = 0.0


def rows_of(model: Model, drawing: Drawing) -> tuple[list[Row], list[Row]]:
    """Rows of every joint and then of every input, in body axes and units of size; and pairs of directions
    whose product must stay positive, since a right angle alone also allows the reversed joint."""
    rows, senses = list[Row](), list[Row]()
    for name, joint in model.joints.items():
        ends = drawing.bodies[joint.first], drawing.bodies[joint.second]
        points = joint.on_first.through, joint.on_second.through
        arms = drawing.arm(joint.first, points[0]), drawing.arm(joint.second, points[1])
        if joint.kind == "distance":
            length = drawing.length(f"joint {name!r}", *points)
            rows.append(Row(name, "distance", *ends, NOTHING, *arms, length))
            continue
        one, other = joint_frames(name, joint, drawing)
        offsets, angles, kept = KINDS[joint.kind]
        rows += [Row(name, "offset", *ends, one[i], *arms) for i in offsets]
        rows += [Row(name, "angle", *ends, one[i], NOTHING, other[j]) for i, j in angles]
        senses += [Row(name, "angle", *ends, one[i], NOTHING, other[j]) for i, j in kept]
    for name, drive in model.inputs.items():
        what, ends = f"input {name!r}", (drawing.bodies[drive.first], drawing.bodies[drive.second])
        arms = drawing.arm(drive.first, drive.axis.through), drawing.arm(drive.second, drive.point)
        if drive.law == "turn":
            x, y, _ = frame_about(drawing.direction(what, drive.axis))
            rows.append(Row(name, "turn", *ends, x, NOTHING, -y))
        elif drive.law == "distance":
            length = drawing.length(what, drive.axis.through, drive.point)
            rows.append(Row(name, "distance", *ends, NOTHING, *arms, length))
        else:
            rows.append(Row(name, "offset", *ends, drawing.direction(what, drive.axis), *arms))
    return rows, senses


def joint_frames(name: str, joint: Joint, drawing: Drawing) -> tuple[Array, Array]:
    """Axes x, y, z (as rows) of the joint frame of each body, as drawn.

    Where the two lines shall become one, the second frame is the first turned by the smallest
    rotation between the drawn lines: so a prismatic joint holds the turn of the drawing.
    """
    if joint.on_second.toward is None:
        return np.eye(3), np.eye(3)
    z1 = drawing.direction(f"joint {name!r}", joint.on_first)
    z2 = drawing.direction(f"joint {name!r}", joint.on_second)
    frame = frame_about(z1)
    if joint.kind == "level":
        return frame, frame_about(z2)
    cosine = float(z1 @ z2)
    if cosine <= 0:
        apart = np.degrees(np.arccos(max(cosine, -1.0)))
        raise DescriptionError(
            f"joint {name!r}: its two lines are drawn {apart:.1f} degrees apart; they shall become one line "
            "of the same sense, so less than 90 degrees is needed: swap the points of one line or correct "
            "the drawing",
            name,
            cosine,
        )
    axis = cross(z1, z2)
    return frame, np.asarray(frame + cross(axis, frame) + cross(axis, cross(axis, frame)) / (1.0 + cosine))


def frame_about(z: Array) -> Array:
    """Right-handed unit axes x, y, z as rows, with z given."""
    x = cross(np.eye(3)[int(np.argmin(np.abs(z)))], z)
    x = x / np.linalg.norm(x)
    return np.array([x, cross(z, x), z])


class Placed(NamedTuple):
    """Rows evaluated at poses.

    Attributes:
        rotation, origin: (..., bodies, 3, 3) and (..., bodies, 3) of the bodies.
        a, e: (..., rows, 3) these vectors of every row. arms: (..., 2, rows, 3) r1 + e and r2.
        values: (..., rows) a . e, and turns between -pi and pi.
    """

    rotation: Array
    origin: Array
    a: Array
    e: Array
    arms: Array
    values: Array


class RowStack:
    """Rows of a mechanism side by side.

    Attributes:
        owners: names of their joints and inputs. first, second: their bodies.
        drawn: what joints hold them to.
    """

    def __init__(self, rows: Sequence[Row], senses: Sequence[Row], bodies: int) -> None:
        def indices(numbers: Sequence[int]) -> NDArray[np.intp]:
            return np.array(numbers, dtype=np.intp)

        def vectors(of: Sequence[Array]) -> Array:
            return np.array(of, dtype=float).reshape(-1, 3)

        self.count = len(rows)
        self.owners = tuple(row.owner for row in rows)
        self.first, self.second = (indices(of) for of in ([r.first for r in rows], [r.second for r in rows]))
        self.drawn = np.array([row.drawn for row in rows])
        # a, r1 and r2 of all rows; vectors of a body once, as many for all bodies: one product turns them.
        local = np.array([(row.along, row.first_arm, row.second_arm) for row in rows]).swapaxes(0, 1)
        self._holders = np.array((self.first, self.first, self.second))
        numbered = np.concatenate((self._holders[..., None], local), axis=-1).reshape(-1, 4)
        table, where = np.unique(numbered, axis=0, return_inverse=True)
        body = table[:, 0].astype(np.intp)
        held = np.bincount(body, minlength=bodies)
        place = np.arange(len(table)) - (np.cumsum(held) - held)[body]
        self._local = np.zeros((bodies, held.max(), 3))
        self._local[body, place] = table[:, 1:]
        self._where = (body * held.max() + place)[where].reshape(3, -1)
        self._distances, self._turns = (
            indices([number for number, row in enumerate(rows) if row.kind == kind])
            for kind in ("distance", "turn")
        )
        self._axes = local[0, self._turns], -local[2, self._turns]
        self._offset = np.array([float(row.kind in ("offset", "distance")) for row in rows])
        # What the terms of a row add up to at most, apart from the distances of the origins.
        arms = np.linalg.norm(local[1:], axis=-1).sum(axis=0)
        self._spans = np.where(self._offset > 0.0, arms, 1.0)
        # Rows of one joint that say where the same point, or direction, is.
        same = (local[2][:, None] == local[2]).all(-1) & np.equal.outer(self._offset, self._offset)
        owner = np.array(self.owners)
        self._mates = ((owner[:, None] == owner) & same).astype(float)
        self._senses = (
            indices([of.first for of in senses]),
            vectors([of.along for of in senses]),
            indices([of.second for of in senses]),
            vectors([of.second_arm for of in senses]),
        )
        self._numbers = np.arange(self.count)

    def place(self, rotation: Array, origin: Array) -> Placed:
        """Rows at poses: rotation (..., bodies, 3, 3), origin (..., bodies, 3), in units of size."""
        turned = self._local @ rotation.swapaxes(-1, -2)
        turned = turned.reshape(*turned.shape[:-3], self._local.size // 3, 3).take(self._where, -2)
        a, arms = turned[..., 0, :, :], turned[..., 1:, :, :]
        apart = origin.take(self.second, -2) - origin.take(self.first, -2)
        e = self._offset[:, None] * apart + (arms[..., 1, :, :] - arms[..., 0, :, :])
        if self._distances.size:
            along = e[..., self._distances, :]
            a[..., self._distances, :] = along / np.sqrt(np.vecdot(along, along))[..., None]
        if self._turns.size:
            one, other = (rotation.take(of[self._turns], -3) for of in (self.first, self.second))
            x, x2 = (np.matvec(of, self._axes[0]) for of in (one, other))
            y = np.matvec(one, self._axes[1])
            cosine, sine = np.vecdot(x, x2), np.vecdot(y, x2)
            level = cosine[..., None] * x + sine[..., None] * y
            a[..., self._turns, :] = level / np.hypot(cosine, sine)[..., None]
        values = np.vecdot(a, e)
        if self._turns.size:
            values[..., self._turns] = np.arctan2(sine, cosine)
        arms[..., 0, :, :] += e
        return Placed(rotation, origin, a, e, arms, values)

    def gap(self, placed: Placed, target: Array) -> Array:
        """(..., rows) target less value, of turns to the nearest of all that look alike."""
        gap: Array = target - placed.values
        if self._turns.size:
            gap[..., self._turns] -= WHOLE_TURN * np.round(gap[..., self._turns] / WHOLE_TURN)
        return gap

    def kept(self, placed: Placed) -> NDArray[np.bool_]:
        """(...) whether all joints have the sense in which they are drawn."""
        first, along, second, partner = self._senses
        one = np.matvec(placed.rotation.take(first, -3), along)
        other = np.matvec(placed.rotation.take(second, -3), partner)
        return np.asarray((np.vecdot(one, other) > 0.0).all(-1))

    def read_at_foot(self, placed: Placed, gap: Array) -> Placed:
        """Rows that are not closed, with their joints' forces where they belong on the first body.

        Where a joint is off by m, the sum of its rows' -gap a, each row's rate may be taken with its force at
        the point of the second body, as in `place`, or at its foot on the axis of the first,
            a . (o2' + w2 x (r2 - m) - o1' - w1 x (r1 + e - m)),
        and once it is closed both are the same. Directions of right angles likewise.
        """
        missed = self._mates @ (-gap[..., None] * placed.a)
        return placed._replace(arms=placed.arms - missed[..., None, :, :])

    def jacobian(self, placed: Placed) -> Array:
        """(..., rows, 6 * moving bodies), columns [o', w] of each moving body."""
        lead, bodies = placed.values.shape[:-1], placed.origin.shape[-2]
        matrix = np.zeros((*lead, self.count, bodies, 2, 3))
        push = self._offset[:, None] * placed.a
        turning = cross(placed.a[..., None, :, :], placed.arms)
        matrix[..., self._numbers, self.first, 0, :] = -push
        matrix[..., self._numbers, self.first, 1, :] = turning[..., 0, :, :]
        matrix[..., self._numbers, self.second, 0, :] = push
        matrix[..., self._numbers, self.second, 1, :] = -turning[..., 1, :, :]
        return matrix[..., 1:, :, :].reshape(*lead, self.count, 6 * (bodies - 1))

    def rounding(self, placed: Placed) -> Array:
        """(..., rows) what rounding alone may make of a row: ROUNDINGS times the lengths of the vectors that
        add up to it."""
        far = np.sqrt(np.vecdot(placed.origin, placed.origin))
        between = far.take(self.first, -1) + far.take(self.second, -1)
        return np.asarray(ROUNDINGS * (self._spans + self._offset * between))

    def closed(self, placed: Placed, target: Array) -> NDArray[np.bool_]:
        """(...) whether no row misses its target by more than rounding."""
        return np.asarray((np.abs(self.gap(placed, target)) <= self.rounding(placed)).all(-1))

    def drift(self, placed: Placed, rates: Array) -> Array:
        """Second rate of the rows when no body accelerates, at rates [o', w], (..., bodies, 2, 3)."""
        both, a = rates.take(self._holders[1:], -3), placed.a
        t, turned = cross(both[..., 1, :], placed.arms), cross(both[..., 1, :], a[..., None, :, :])
        t1, t2 = t[..., 0, :, :], t[..., 1, :, :]
        v = self._offset[:, None] * (both[..., 1, :, 0, :] - both[..., 0, :, 0, :]) + t2 - t1
        drift: Array = np.vecdot(turned[..., 0, :, :], 2.0 * v + t1) - np.vecdot(turned[..., 1, :, :], t2)
        if self._distances.size:
            a, v = a[..., self._distances, :], v[..., self._distances, :]
            along = np.vecdot(a, v)
            drift[..., self._distances] += (np.vecdot(v, v) - along**2) / placed.values[..., self._distances]
        return drift
