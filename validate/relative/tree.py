r"""A mechanism's tree in Pinocchio, its rows at a pose, and Newton's method on them.

Where a body b is says a matrix M_b = [R t], (3, 4), and every point and every direction that is fixed in a
body is a linear function of these matrices. Every row is a product of two such vectors,

    r = b X . Y + tail - target,

of a closure or a drive (see `spanning_tree.cut`): with e a direction of a body and g = p - q between points
of two bodies, X = e, Y = g, b = 1; of a rod or a driven distance X = Y = g, b = 1 / (2 L), and the target is
L / 2; of a wheel's contact the tail is rho - rho sqrt(1 - s^2), s the product of the direction up and the
wheel's axle. A turn is a joint coordinate, and so is its row.

With q the joint coordinates a Newton step is

    J dq = -r,    q <- q (+) dq,

where (+) turns the quaternion of a ball joint by the step's rotation, in the joint's own axes. Rows that
depend on others in the reference pose (planar mechanisms have such) are left out, and checked at each answer.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dgesv

from validate.extras import MissingPackage
from validate.relative.errors import HardpointsError
from validate.spanning_tree.cut import (
    CHASSIS,
    NO_AXIS,
    Coincide,
    Drive,
    Joint,
    OnLine,
    Place,
    Rod,
    SpanningTree,
    Square,
    across,
)
from validate.spanning_tree.determined import blocks, independent_rows

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
    """Points of bodies and directions that are fixed in them, taken together.

    Attributes:
        body: numbers of the bodies, the chassis is 0, (P,).
        at: from the body's joint, of the chassis from the origin, (P, 3).
        point: 1 of a point, 0 of a direction, (P,).
        of_matrices: the places by the bodies' matrices, (12 B, 3 P); those are flat by row, body and column.
    """

    body: NDArray[np.int64]
    at: Array
    point: Array
    of_matrices: Array

    def now(self, matrices: Array) -> Array:
        """Where they are, (..., P, 3), by the bodies' matrices, (..., 12 B); also of how these change."""
        return np.asarray((matrices @ self.of_matrices).reshape(*matrices.shape[:-1], -1, 3))


@dataclass(frozen=True)
class Row:
    """A row of the closures or drives; see the module.

    Attributes:
        name: of the point, rod, slide or input.
        e: direction, a place of a body; None where X = Y.
        p, q: points or directions. scale: b. target: of a closure, or what a drive adds to its own.
        drive: number of the drive; None of a closure.
        coordinate: place in q and number of a joint coordinate, if the row is one.
        radius, axle: of a contact's tail. directions: whether p and q are.
    """

    name: str
    e: Place | None
    p: Place
    q: Place
    scale: float = 1.0
    target: float = 0.0
    drive: int | None = None
    coordinate: tuple[int, int] | None = None
    radius: float = 0.0
    axle: Place | None = None
    directions: bool = False


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


def product_rates(x: Sequence[Array], y: Sequence[Array], order: int) -> Array:
    """The time derivative of X . Y of an order, (..., rows), from those of X and Y, (..., rows, 3) each."""
    dot = partial(np.einsum, "...ij,...ij->...i")
    parts = (math.comb(order, k) * dot(x[k], y[order - k]) for k in range(order + 1))
    return np.asarray(sum(parts))


class Rows:
    """Rows of a tree, by the bodies' matrices.

    Attributes:
        rows: as data. ends: e, p and q of all rows, then of the contacts' s: axle and up, (3 F, 3).
        scale: b, (F,), of all forms: rows, then tails. of_matrices: b X and Y by the matrices, (12 B, 6 F).
        tails: rows with a tail, `radii` theirs.
        coordinates: rows that are a joint coordinate, their places in q and numbers, (3, C).
    """

    def __init__(self, tree: Tree, rows: Sequence[Row]) -> None:
        self.rows = tuple(rows)
        self.count = len(self.rows)
        still = Place(CHASSIS, NO_AXIS)
        tails = [row for row in self.rows if row.axle is not None]
        forms = [*self.rows, *(Row(r.name, r.e, r.axle or still, still, directions=True) for r in tails)]
        # X and Y of each form as differences of two places.
        first = [(f.p, f.q) if f.e is None else (f.e, still) for f in forms]
        ends = [*(f[0] for f in first), *(f.p for f in forms), *(f[1] for f in first), *(f.q for f in forms)]
        points = [f.e is None for f in forms] + [not f.directions for f in forms]
        self.ends = tree.together(ends, np.array([*points, *points], dtype=float))
        count = len(forms)
        of_ends = self.ends.of_matrices.reshape(12 * len(tree.bodies), 2, 2, count, 3)
        # X of the form's own scale, and Y, (12 B, F, 2, 3).
        pair = np.moveaxis(of_ends[:, 0] - of_ends[:, 1], 1, 2)
        pair[:, :, 0] *= np.array([[f.scale] for f in forms]).reshape(-1, 1)
        self.of_matrices = np.ascontiguousarray(pair.reshape(len(pair), 6 * count))
        self._swapped = np.ascontiguousarray(pair[:, :, ::-1].reshape(len(pair), 6 * count))
        self.scale = np.array([f.scale for f in forms])
        self.target = np.array([row.target for row in self.rows])
        self.tails = np.array([k for k, row in enumerate(self.rows) if row.axle is not None], dtype=np.int64)
        self.radii = np.array([row.radius for row in tails])
        turns = [(k, *row.coordinate) for k, row in enumerate(self.rows) if row.coordinate is not None]
        self.coordinates = np.array(turns, dtype=np.int64).reshape(-1, 3).T
        self.drives = np.array(
            [k for k, row in enumerate(self.rows) if row.drive is not None], dtype=np.int64
        )
        self.drive_numbers = [row.drive for row in self.rows if row.drive is not None]
        chain = tree.chains[self.ends.body]
        moves = np.asarray(chain.reshape(4, len(forms), chain.shape[1]).any(axis=0))
        if len(tails):
            moves[self.tails] |= moves[self.count :]
        self.pattern = moves[: self.count]
        for row, _, number in self.coordinates.T:
            self.pattern[row] = np.arange(chain.shape[1]) == number

    def pairs(self, matrices: Array) -> tuple[Array, Array]:
        """b X and Y of all forms, (..., F, 3) each; linear in the matrices, (..., 12 B)."""
        both = (matrices @ self.of_matrices).reshape(*matrices.shape[:-1], -1, 2, 3)
        return both[..., 0, :], both[..., 1, :]

    def values(self, matrices: Array, q: Array, targets: Array) -> Array:
        """The rows, (..., rows).

        Args:
            matrices: (..., 12 B). q: joint coordinates, (..., nq).
            targets: what they are to be, (..., rows).
        """
        x, y = self.pairs(matrices)
        forms = np.einsum("...ij,...ij->...i", x, y)
        rows = forms[..., : self.count]
        if len(self.tails):
            s = forms[..., self.count :]
            rows[..., self.tails] += self.radii * (1.0 - np.sqrt((1.0 - s) * (1.0 + s)))
        if self.coordinates.size:
            rows[..., self.coordinates[0]] = q[..., self.coordinates[1]]
        return np.asarray(rows - targets)

    def slopes(self, x: Array, y: Array) -> tuple[Array, Array]:
        """First two derivatives of the tails by s, (..., tails) each."""
        s = product_rates([x[..., self.count :, :]], [y[..., self.count :, :]], 0)
        c = np.sqrt((1.0 - s) * (1.0 + s))
        return self.radii * s / c, self.radii / c**3

    def jacobian(self, matrices: Array, moved: Array) -> Array:
        """Of the rows by the joint coordinates, (..., rows, size).

        Args:
            matrices: (..., 12 B). moved: how each coordinate moves them, (..., size, 12 B).
        """
        # dX . Y + dY . X at once.
        both = (moved @ self.of_matrices).reshape(*moved.shape[:-1], -1, 6)
        other = (matrices @ self._swapped).reshape(*matrices.shape[:-1], -1, 6)
        forms = np.einsum("...kij,...ij->...ik", both, other)
        rows = forms[..., : self.count, :]
        if len(self.tails):
            x, y = self.pairs(matrices)
            rows[..., self.tails, :] += self.slopes(x, y)[0][..., None] * forms[..., self.count :, :]
        if self.coordinates.size:
            rows[..., self.coordinates[0], :] = 0.0
            rows[..., self.coordinates[0], self.coordinates[2]] = 1.0
        return np.asarray(rows)

    def second_rates(self, m: Sequence[Array]) -> Array:
        """Second rates of the rows, (..., rows), from the matrices and their two rates."""
        x, y = zip(*(self.pairs(part) for part in m), strict=True)
        forms = [product_rates(x, y, order) for order in (0, 1, 2)]
        rows = forms[2][..., : self.count]
        if len(self.tails):
            first, second = self.slopes(x[0], y[0])
            s1, s2 = (form[..., self.count :] for form in forms[1:])
            rows[..., self.tails] += first * s2 + second * s1 * s1
        rows[..., self.coordinates[0]] = 0.0
        return np.asarray(rows)


class Tree:
    """Pinocchio's model of a mechanism with its workspace, which every call overwrites: one thread at a time.

    Attributes:
        cut: the mechanism as data.
        size: number of unknowns, which is that of the rows.
        bodies: names, the chassis first; `parents` their numbers; `body_of` the number of each joint
            coordinate's body; `chains` whether a coordinate moves a body, (B, size).
        rows: those that are solved. left_out: those that depend on them.
        blocks: rows and columns of the Jacobian's diagonal blocks, in the order in which they are solved.
        noise: standard deviation of what rounding does to each row in the reference pose, (size,).
    """

    def __init__(self, cut: SpanningTree) -> None:
        self.cut = cut
        self._model = pinocchio.Model()
        origins: dict[str, tuple[int, Array]] = {CHASSIS: (0, NO_AXIS)}
        for joint in cut.joints:
            parent, at = origins[joint.parent]
            placed = pinocchio.SE3(np.eye(3), joint.at - at)
            number = self._model.addJoint(parent, _joint_model(joint), placed, joint.body)
            origins[joint.body] = (number, joint.at)
        self._data = self._model.createData()
        self.bodies = tuple(origins)
        self.number = {body: number for body, (number, _) in origins.items()}
        self._origins = np.array([at for _, at in origins.values()])
        self.size = int(self._model.nv)
        self._describe_chains()
        every = Rows(self, list(self._rows()))
        self._workspace()
        chosen = self._independent(every)
        self.rows = Rows(self, [every.rows[k] for k in chosen])
        self.left_out = Rows(self, [row for k, row in enumerate(every.rows) if k not in chosen])
        self.blocks = blocks(self.rows.pattern)
        self.noise = self._row_noise()

    @property
    def drives(self) -> Sequence[Drive]:
        """What the inputs give."""
        return self.cut.drives

    @property
    def neutral(self) -> Array:
        """The reference pose."""
        return np.array(pinocchio.neutral(self._model))

    def together(self, places: Sequence[Place], point: Array | None = None) -> Places:
        """Several places at once.

        Args:
            point: 1 of a point, 0 of a direction, (P,); points unless given.
        """
        count = len(places)
        weight = np.ones(count) if point is None else point
        body = np.array([self.number[place.body] for place in places], dtype=np.int64)
        at = np.array([place.at for place in places]).reshape(-1, 3) - weight[:, None] * self._origins[body]
        linear = np.zeros((3, len(self.bodies), 4, count, 3))
        for i in range(3):
            linear[i, body, :, np.arange(count), i] = np.concatenate([at, weight[:, None]], axis=1)
        return Places(body, at, weight, linear.reshape(12 * len(self.bodies), 3 * count))

    def matrices(self, q: Array) -> Array:
        """Matrices of all bodies, in a workspace that the next call overwrites, (12 B,)."""
        pinocchio.computeJointJacobians(self._model, self._data, q)
        for target, source in self._copied:
            target[...] = source
        return self._flat

    def whole(self, matrices: Array) -> Array:
        """Matrices with their fourth row, (..., 4, 4 B)."""
        found = np.empty((*matrices.shape[:-1], 4, matrices.shape[-1] // 3))
        found[..., :3, :] = matrices.reshape(*matrices.shape[:-1], 3, -1)
        found[..., 3, :] = self._whole[3]
        return found

    def moved(self, whole: Array, screws: Array) -> Array:
        """How the joint coordinates move the bodies' matrices, (..., size, 12 B).

        Args:
            whole: matrices with their fourth row, (..., 4, 4 B).
            screws: in the world's axes about their origin, linear before angular, (..., size, 6).
        """
        found = (screws @ SCREW_MATRIX).reshape(*screws.shape[:-2], -1, 4) @ whole
        found = found.reshape(*screws.shape[:-1], 3, -1)
        found *= self._moves
        return np.asarray(found.reshape(*screws.shape[:-1], -1))

    def settle(self, q: Array, targets: Array, goal: float, most: int = MOST_STEPS) -> Settled:
        """Newton's method from a pose, until the rows' root of the sum of squares is at the goal.

        It also ends where rounding keeps the rows from getting smaller.
        """
        enough, noise = goal * goal, STALLED * STALLED * float(self.noise.dot(self.noise))
        model, before, first, second = self._model, math.inf, 0.0, 0.0
        for steps in range(most + 1):
            r = self.rows.values(self.matrices(q), q, targets)
            left = float(r.dot(r))
            if left <= enough or (left <= noise and left > 0.25 * before):
                return Settled(q, r, steps, first, second)
            if steps == most or not left <= 1e4 * before:
                break
            _, _, dq, info = dgesv(self.jacobian(), r)
            if info:
                break
            if steps < 2:
                size = math.sqrt(dq.dot(dq))
                first, second = (size, 0.0) if steps == 0 else (first, size)
            q = self.normalized(pinocchio.integrate(model, q, -dq))
            before = left
        return Settled(None, r, steps, first, second)

    def jacobian(self) -> Array:
        """Of the rows where the matrices were evaluated last."""
        return self.rows.jacobian(self._flat, self.moved(self._whole, self._screws))

    def signs(self, jacobian: Array) -> Array:
        """Signs of the determinants of the Jacobian's diagonal blocks, (..., blocks)."""
        found = [
            np.sign(np.linalg.det(jacobian[..., rows[:, None], columns])) for rows, columns in self.blocks
        ]
        return np.stack(found, axis=-1)

    def normalized(self, q: Array) -> Array:
        """The coordinates with quaternions of length one."""
        return np.asarray(pinocchio.normalize(self._model, q)) if self._turning else q

    def store(self, matrices: Array, screws: Array) -> None:
        """Copy where the bodies are, (12 B,), and the joints' screws, (size, 6), as evaluated last."""
        matrices[...] = self._flat
        screws[...] = self._screws

    def holding(self, jacobian: Array) -> tuple[str, ...]:
        """What holds each other where a Jacobian is nearly singular, the strongest first.

        The multipliers u of the rows that nearly balance, u J = 0, with |u| = 1: names of those above half
        of the largest.
        """
        share = np.abs(np.linalg.svd(jacobian)[0][:, -1])
        strongest = np.argsort(-share, kind="stable")
        names = (self.rows.rows[k].name for k in strongest if share[k] > 0.5 * share[strongest[0]])
        return tuple(dict.fromkeys(names))

    def _workspace(self) -> None:
        bodies = len(self.bodies)
        self._whole = np.zeros((4, 4 * bodies))
        self._whole[3, 3::4] = 1.0
        matrices = self._whole[:3].reshape(3, bodies, 4)
        matrices[:, 0, :3] = np.eye(3)
        self._flat = matrices.reshape(-1)
        # Views of Pinocchio's own memory, which stays where it is: of a vector, so at even distances.
        self._screws = self._data.J.reshape(6, self.size, order="F").T
        placed = self._data.oMi
        sources = []
        for views in ([at.rotation for at in placed], [at.translation for at in placed]):
            before, first = (view.__array_interface__["data"][0] for view in views[:2])
            shape, strides = (bodies - 1, *views[1].shape), (first - before, *views[1].strides)
            sources.append(np.lib.stride_tricks.as_strided(views[1], shape, strides))
        self._copied = (
            (matrices[:, 1:, :3], np.swapaxes(sources[0], 0, 1)),
            (matrices[:, 1:, 3], sources[1].T),
        )
        self._moves = np.repeat(self.chains, 4, axis=0).T[:, None, :]
        self._turning = any(joint.kind == "ball" for joint in self.cut.joints)

    def _describe_chains(self) -> None:
        kinds = [joint.kind for joint in self.cut.joints]
        self.parents = np.array([0, *(self.number[joint.parent] for joint in self.cut.joints)])
        self.body_of = np.repeat(np.arange(1, len(self.bodies)), [3 if k == "ball" else 1 for k in kinds])
        self.chains = np.zeros((len(self.bodies), self.size))
        for body in range(1, len(self.bodies)):
            self.chains[body] = self.chains[self.parents[body]] + (self.body_of == body)

    def _rows(self) -> Iterator[Row]:
        for c in self.cut.closures:
            if isinstance(c, Coincide):
                yield from (Row(c.name, Place(CHASSIS, e), c.first, c.second) for e in np.eye(3))
            elif isinstance(c, OnLine):
                yield from (Row(c.name, Place(c.second.body, u), c.first, c.second) for u in across(c.axis))
            elif isinstance(c, Square):
                yield Row(c.name, c.second, c.first, Place(CHASSIS, NO_AXIS), directions=True)
            elif isinstance(c, Rod):
                yield Row(c.name, None, c.first, c.second, 0.5 / c.length, 0.5 * c.length)
        for k, d in enumerate(self.cut.drives):
            if d.kind == "distance":
                yield Row(d.input, None, d.first, d.second, 0.5 / d.size, drive=k)
                continue
            e = Place(d.of, d.axis)
            if d.kind == "turn":
                joint = self._model.joints[self.number[d.joint]]
                yield Row(d.input, e, d.first, d.second, drive=k, coordinate=(joint.idx_q, joint.idx_v))
            elif d.kind == "contact":
                axle = Place(d.first.body, d.axle)
                yield Row(d.input, e, d.first, d.second, drive=k, radius=d.size, axle=axle)
            else:
                yield Row(d.input, e, d.first, d.second, drive=k)

    def _independent(self, every: Rows) -> NDArray[np.int64]:
        """Rows that determine the pose, of all.

        Raises:
            HardpointsError: too few do, or a drive depends on others.
        """
        flat = self.matrices(self.neutral)
        jacobian = every.jacobian(flat, self.moved(self._whole, self._screws))
        chosen = independent_rows(jacobian, len(self.cut.drives))
        lost = [every.rows[k].name for k in every.drives if k not in chosen]
        if lost:
            raise HardpointsError(
                lost[0], "does not move the mechanism as drawn beside the other inputs", "as many as freedoms"
            )
        if len(chosen) < self.size:
            motion = np.abs(np.linalg.svd(jacobian)[2][-1])
            body = self.bodies[self.body_of[int(np.argmax(motion))]]
            raise HardpointsError(
                body,
                f"is free to move as drawn: {len(chosen)} independent rows for {self.size} joint coordinates",
                "as many inputs as there are freedoms, and no singular drawing",
            )
        return chosen

    def _row_noise(self) -> Array:
        """Standard deviation of what rounding does to the rows, by the chains' lengths as drawn."""
        ends = self.rows.ends
        joints, squares = self._origins, np.zeros(len(self.bodies))
        for body, parent in enumerate(self.parents[1:], 1):
            squares[body] = np.square(joints[body] - joints[parent]).sum() + squares[parent]
        reach = np.sqrt(squares[ends.body] * ends.point + np.square(ends.at).sum(axis=-1))
        forms = np.hypot(*np.hypot(*reach.reshape(2, 2, -1)))
        return np.asarray(TURNED * forms[: self.rows.count])


# (v + w x p) of a screw (v, w) and a point (p, 1), as a matrix (3, 4), flat.
_BY_ENTRY = np.zeros((6, 3, 4))
for _i in range(3):
    _BY_ENTRY[_i, _i, 3] = 1.0
    _BY_ENTRY[3 + _i, (_i + 2) % 3, (_i + 1) % 3] = 1.0
    _BY_ENTRY[3 + _i, (_i + 1) % 3, (_i + 2) % 3] = -1.0
SCREW_MATRIX = _BY_ENTRY.reshape(6, 12)


def _joint_model(joint: Joint) -> Any:
    if joint.kind == "ball":
        return pinocchio.JointModelSpherical()
    if joint.kind == "hinge":
        return pinocchio.JointModelRevoluteUnaligned(joint.axis)
    return pinocchio.JointModelPrismaticUnaligned(joint.axis)
