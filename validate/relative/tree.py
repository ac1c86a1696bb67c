r"""The tree of a linkage in Pinocchio, its closure equations at a pose, and Newton's method on them.

With q the joint coordinates and w the inputs' values, the rows r(q, w) of `linkage` are zero. A Newton step
is

    J dq = -r,    q <- q (+) dq,

where (+) turns the quaternion of a spherical joint by the step's rotation, in the joint's own axes.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dgesv

from validate.extras import MissingPackage
from validate.relative.linkage import CHASSIS, Coincide, Joint, Linkage, Place

try:
    import pinocchio
except ModuleNotFoundError as error:
    raise MissingPackage("relative", error) from None

Array = NDArray[np.float64]

U = 2.0**-53  # a rounding
# Turning a vector multiplies it by a matrix whose entries, made of a sine and a cosine or of a quaternion,
# are off by a rounding or two, and adds three products: two roundings of its length are one standard
# deviation.
TURNED = 2.0 * U
MOST_STEPS = 25
# A residual at rounding is not halved by a step; one this many deviations off has not come there.
STALLED = 16.0


@dataclass(frozen=True)
class Places:
    """Points of bodies, taken together.

    Attributes:
        body: numbers of the bodies, that of the chassis is the last, (P,).
        at: from the body's joint, of the chassis from the origin, (P, 3).
        moving: those that are not of the chassis.
    """

    body: NDArray[np.int64]
    at: Array
    moving: NDArray[np.int64]


@dataclass(frozen=True)
class Settled:
    """Where Newton's method came to an end.

    Attributes:
        q: joint coordinates; None if it found no pose.
        residual: the rows there.
        steps: how many.
        first, second: lengths of the first and second step, 0 where there was none.
    """

    q: Array | None
    residual: Array
    steps: int
    first: float
    second: float


class Tree:
    """Pinocchio's model of a linkage with its workspace, which every call overwrites: one thread at a time.

    Attributes:
        size: number of unknowns, which is that of the rows.
        noise: standard deviation of what rounding does to each row, (size,).
        bodies: names in the order of the joints; `body_of` the place of each joint coordinate's body in them;
            `chains` whether a coordinate moves a body, with the chassis as the last, (bodies + 1, size).
        ends: points of the rows: first ones of the closures, second ones, then those of the drives.
        balls, rods: closures by number that are coincidences and distances, `ball_rows` (balls, 3) and
            `rod_rows` their rows, `lengths` of the rods.
        directions: of the drives, (drives, 3).
        corners: points of the sides, (4 sides), a point that a side has not is its first one.
        driven, free: joint coordinates that the drives' rows have alone, in their order, and the others.
    """

    def __init__(self, linkage: Linkage) -> None:
        self.linkage = linkage
        self._model = pinocchio.Model()
        origins: dict[str, tuple[int, Array]] = {CHASSIS: (0, np.zeros(3))}
        self._origins = origins
        for joint in linkage.joints:
            parent, at = origins[joint.parent]
            number = self._model.addJoint(parent, _joint_model(joint), _shift(joint.at - at), joint.body)
            origins[joint.body] = (number, joint.at)
        places = [
            *(place for c in linkage.closures for place in (c.first, c.second)),
            *(drive.place for drive in linkage.drives),
        ]
        frames = [self._frame(place, str(k)) for k, place in enumerate(places)]
        self._data = self._model.createData()
        self._q = pinocchio.neutral(self._model)
        self._joints = [origins[joint.body][0] for joint in linkage.joints]
        # Views of Pinocchio's own memory, which stays where it is.
        views = [self._data.oMf[frame].translation for frame in frames]
        self._rotations = [self._data.oMi[number].rotation for number in self._joints]
        self._translations = [self._data.oMi[number].translation for number in self._joints]
        self.size = int(self._model.nv)
        self._balls: list[tuple[int, Array, Array, int, int, int]] = []
        self._rods: list[tuple[int, Array, Array, int, int, int, float]] = []
        self._drives: list[tuple[int, Array, Array, int]] = []
        row = 0
        for k, closure in enumerate(linkage.closures):
            two = (views[2 * k], views[2 * k + 1], frames[2 * k], frames[2 * k + 1], k)
            if isinstance(closure, Coincide):
                self._balls.append((row, *two))
                row += 3
            else:
                self._rods.append((row, *two, closure.length))
                row += 1
        for k, drive in enumerate(linkage.drives, 2 * len(linkage.closures)):
            self._drives.append((row, drive.direction, views[k], frames[k]))
            row += 1
        if row != self.size:
            raise ValueError(f"{row} rows for {self.size} joint coordinates")
        self.first_drive = row - len(linkage.drives)
        self._r, self._jacobian = np.zeros(row), np.zeros((row, row), order="F")
        self.bodies = tuple(joint.body for joint in linkage.joints)
        self._describe_chains()
        self._find_driven()
        self._describe_rows()
        self.noise = self._row_noise()

    @property
    def neutral(self) -> Array:
        """The reference pose."""
        return np.array(pinocchio.neutral(self._model))

    def number(self, body: str) -> int:
        """Of a body among `bodies`; the chassis comes after them."""
        return len(self.bodies) if body == CHASSIS else self.bodies.index(body)

    def together(self, places: Sequence[Place]) -> Places:
        """Several points at once."""
        body = np.array([self.number(place.body) for place in places], dtype=np.int64)
        at = np.array([place.at - self._origins[place.body][1] for place in places]).reshape(-1, 3)
        return Places(body, at, np.flatnonzero(body < len(self.bodies)))

    def rows(self, q: Array, targets: Array, gaps: Sequence[Array] | None = None) -> Array:
        """The closure equations at a pose, in a workspace that the next call overwrites, (size,).

        Args:
            targets: what each row is to be, (size,): values of the drives, measured from the axes' origin.
            gaps: of the closures.
        """
        pinocchio.computeJointJacobians(self._model, self._data, q)
        pinocchio.updateFramePlacements(self._model, self._data)
        r = self._r
        for row, a, b, _, _, k in self._balls:
            r[row : row + 3] = a - b if gaps is None else a - b - gaps[k]
        for row, a, b, _, _, k, length in self._rods:
            d = a - b if gaps is None else a - b - gaps[k]
            r[row] = (d.dot(d) - length * length) / (2.0 * length)
        for row, direction, a, _ in self._drives:
            r[row] = direction.dot(a)
        r -= targets
        return r

    def jacobian(self, gaps: Sequence[Array] | None = None) -> Array:
        """Of the rows where they were evaluated last, in a workspace that the next call overwrites."""
        model, data, world = self._model, self._data, pinocchio.LOCAL_WORLD_ALIGNED
        get, found = pinocchio.getFrameJacobian, self._jacobian
        for row, _, _, one, two, _ in self._balls:
            found[row : row + 3] = get(model, data, one, world)[:3] - get(model, data, two, world)[:3]
        for row, a, b, one, two, k, length in self._rods:
            d = a - b if gaps is None else a - b - gaps[k]
            difference = get(model, data, one, world)[:3] - get(model, data, two, world)[:3]
            found[row] = (d / length).dot(difference)
        for row, direction, _, one in self._drives:
            found[row] = direction.dot(get(model, data, one, world)[:3])
        return found

    def settle(
        self,
        q: Array,
        targets: Array,
        goal: float,
        gaps: Sequence[Array] | None = None,
        most: int = MOST_STEPS,
    ) -> Settled:
        """Newton's method from a pose, until the rows' root of the sum of squares is at the goal.

        It also ends where rounding keeps the rows from getting smaller.
        """
        enough, noise = goal * goal, STALLED * STALLED * float(self.noise.dot(self.noise))
        model, before, first, second = self._model, math.inf, 0.0, 0.0
        for steps in range(most + 1):
            r = self.rows(q, targets, gaps)
            left = float(r.dot(r))
            if left <= enough or (left <= noise and left > 0.25 * before):
                return Settled(q, r.copy(), steps, first, second)
            if steps == most or not left <= 1e4 * before:
                break
            _, _, dq, info = dgesv(self.jacobian(gaps), r)
            if info:
                break
            if steps < 2:
                size = math.sqrt(dq.dot(dq))
                first, second = (size, 0.0) if steps == 0 else (first, size)
            q = pinocchio.normalize(model, pinocchio.integrate(model, q, -dq))
            before = left
        return Settled(None, self._r.copy(), steps, first, second)

    def normalized(self, q: Array) -> Array:
        """The coordinates with quaternions of length one."""
        return np.asarray(pinocchio.normalize(self._model, q))

    def store(self, rotations: Array, translations: Array, screws: Array) -> None:
        """Copy where the bodies are, and the joints' screws, as evaluated last.

        Args:
            rotations: (bodies, 3, 3). translations: (bodies, 3). screws: in the world's axes about their
                origin, linear above angular, (6, size).
        """
        for k, (rotation, translation) in enumerate(zip(self._rotations, self._translations, strict=True)):
            rotations[k] = rotation
            translations[k] = translation
        screws[...] = self._data.J

    def _frame(self, place: Place, name: str) -> int:
        number, at = self._origins[place.body]
        kind = pinocchio.FrameType.OP_FRAME
        return int(self._model.addFrame(pinocchio.Frame(name, number, _shift(place.at - at), kind)))

    def _describe_chains(self) -> None:
        parents = {joint.body: joint.parent for joint in self.linkage.joints}
        self.body_of = np.concatenate(
            [np.full(3 if j.kind == "spherical" else 1, k) for k, j in enumerate(self.linkage.joints)]
        )
        self.parents = np.array(
            [-1 if j.parent == CHASSIS else self.bodies.index(j.parent) for j in self.linkage.joints]
        )
        self.chains = np.zeros((len(self.bodies) + 1, self.size))
        for k, body in enumerate(self.bodies):
            name = body
            while name != CHASSIS:
                self.chains[k, self.body_of == self.bodies.index(name)] = 1.0
                name = parents[name]

    def _find_driven(self) -> None:
        places = (drive.place.body for drive in self.linkage.drives)
        columns = [np.flatnonzero(self.chains[self.bodies.index(body)]) for body in places]
        if any(len(found) != 1 for found in columns):
            raise ValueError("a drive moves a body on more than one joint coordinate")
        self.driven = np.concatenate(columns)
        self.free = np.setdiff1d(np.arange(self.size), self.driven)

    def _describe_rows(self) -> None:
        closures, sides = self.linkage.closures, self.linkage.sides
        self.ends = self.together(
            [
                *(closure.first for closure in closures),
                *(closure.second for closure in closures),
                *(drive.place for drive in self.linkage.drives),
            ]
        )
        self.balls = np.array([k for *_, k in self._balls], dtype=np.int64)
        first_rows = np.array([row for row, *_ in self._balls], dtype=np.int64)
        self.ball_rows = first_rows[:, None] + np.arange(3)
        self.rods = np.array([k for *_, k, _ in self._rods], dtype=np.int64)
        self.rod_rows = np.array([row for row, *_ in self._rods], dtype=np.int64)
        self.lengths = np.array([length for *_, length in self._rods])
        self.directions = np.array([drive.direction for drive in self.linkage.drives])
        self.corners = self.together([p or side.points[0] for side in sides for p in side.points])

    def _row_noise(self) -> Array:
        noise = np.zeros(self.size)
        row = 0
        for closure in self.linkage.closures:
            both = math.hypot(self._reach(closure.first), self._reach(closure.second))
            rows = 3 if isinstance(closure, Coincide) else 1
            noise[row : row + rows] = TURNED * both
            row += rows
        for drive in self.linkage.drives:
            noise[row] = TURNED * math.hypot(self._reach(drive.place), float(drive.foot @ drive.direction))
            row += 1
        return noise

    def _reach(self, place: Place) -> float:
        """Root of the sum of squares of a chain's lengths, to a point, in the reference pose."""
        squares, at, body = 0.0, place.at, place.body
        joints = {joint.body: joint for joint in self.linkage.joints}
        while body != CHASSIS:
            joint = joints[body]
            squares += float(np.square(at - joint.at).sum())
            at, body = joint.at, joint.parent
        return math.sqrt(squares + float(at @ at))


def _joint_model(joint: Joint) -> Any:
    if joint.kind == "spherical":
        return pinocchio.JointModelSpherical()
    if joint.kind == "revolute":
        return pinocchio.JointModelRevoluteUnaligned(joint.axis)
    return pinocchio.JointModelPrismaticUnaligned(joint.axis)


def _shift(vector: Array) -> Any:
    return pinocchio.SE3(np.eye(3), vector)
