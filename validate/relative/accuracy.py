r"""How far off the numbers of the relative-coordinate model may be, from what rounding does to its equations.

Rounding leaves a row r of the closure equations with a random error of standard deviation rho_r, its first
and second rates with rho'_r and rho''_r: two roundings of every term that they are added from. To first
order the rows of positions move the pose by J^-1 e_r rho_r, and with it every rate. So each number x has
the derivatives

    x_r  = dx / d(row r),    x'_r = dx / d(first rate of row r),    x''_r = dx / d(second rate of row r),

taken exactly here from the screws: a screw moves with its body, whether in time or with a row. With these
and with what its own last sum rounds, the standard deviation of x is the root of the sum of squares, and
DEVIATIONS times that is claimed. The rows' own residual is added: Newton's method may have been told to end
early.

First order is enough where the Jacobian changes little over that error of the pose: by h in parts of
itself, h = |DEVIATIONS rho_r J^-1 dJ/d(row r)|, over all rows r. The claims grow by 1 / (1 - 2 h), and
above FOLD the pose cannot be told from that of the other side.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from validate.relative.follow import BLOCK, Poses, at_places, drive_rates
from validate.relative.rates import (
    Rates,
    carried,
    chain_sum,
    screw_product,
    turned,
)
from validate.relative.tree import TURNED, Places, Rows, Tree, U, product_rates
from validate.spanning_tree.cut import Place

Array = NDArray[np.float64]

# Of some 1e5 numbers one goes beyond 4.4 standard deviations if they are normal; roundings of one pose are
# shared by its numbers and not all independent.
DEVIATIONS = 5.0
FOLD = 0.125


@dataclass(frozen=True)
class Motion:
    """How bodies move in one or more directions; the axis of the directions, K, follows that of the poses.

    Attributes:
        pose: twists of the bodies with the direction, (N, K, B, 6).
        twists_by, accelerations_by: derivatives of the twists and accelerations, (N, K, B, 6).
        matrices: derivatives of the bodies' matrices and of their two rates, (N, K, 12 B) each.
    """

    pose: Array
    twists_by: Array
    accelerations_by: Array
    matrices: tuple[Array, Array, Array]


@dataclass(frozen=True)
class Deviations:
    """What every number's claim is made of.

    Attributes:
        motion: how everything moves with the rows and, after these, with their first rates.
        noise: standard deviations of the rows and of their first and second rates, (N, size) each.
        residual: what is left of the rows, (N, size).
        widened: 1 / (1 - 2 h), (N,). fold: h, (N,).
        condition: number of the Jacobian, (N,).
    """

    motion: Motion
    noise: tuple[Array, Array, Array]
    residual: Array
    widened: Array
    fold: Array
    condition: Array


def point_derivatives(motion: Motion, places: Places) -> tuple[Array, Array, Array]:
    """Of points' places, velocities and accelerations by the directions, (N, K, P, 3) each."""
    x, v, a = (places.now(part) for part in motion.matrices)
    return x, v, a


def _changed(
    rates: Rates, pose: Array, twists_by: Array, accelerations_by: Array | None
) -> tuple[Array, Array, Array]:
    """Derivatives of the bodies' matrices and of their rates by directions, (N, K, 12 B) each.

    Args:
        pose, twists_by, accelerations_by: see `Motion`; without the last one, neither is the last result.
    """
    m, m1 = (part[:, None] for part in rates.matrices[:2])
    twists, accelerations = rates.twists[:, None], rates.accelerations[:, None]
    moved = carried(pose, m)
    faster = carried(twists_by, m) + turned(twists, moved)
    if accelerations_by is None:
        return moved, faster, faster
    second = carried(accelerations_by, m) + turned(accelerations, moved) + turned(twists_by, m1)
    return moved, faster, second + turned(twists, faster)


def _fold(tree: Tree, poses: Poses, screws: Array, inverse: Array, size: Array) -> Array:
    """How much the Jacobian changes over the pose's error, in parts of itself, (N,)."""
    found = np.empty(len(screws))
    for low in range(0, len(screws), BLOCK):
        some = slice(low, low + BLOCK)
        found[some] = _fold_of_block(tree, poses.matrices[some], screws[some], inverse[some], size[some])
    return found


def _fold_of_block(tree: Tree, matrices: Array, screws: Array, inverse: Array, size: Array) -> Array:
    # Column k of dJ v is a row's first rate by the pose where coordinate k alone moves at rate one.
    by_row, m = np.swapaxes(inverse, 1, 2), matrices[:, None]
    pose = chain_sum(tree, screws[:, None] * by_row[..., None])
    screws_by = screw_product(pose[:, :, tree.body_of], screws[:, None])
    # (N, K, size) to (N, coordinates, 1 or K, B, 6): a coordinate moves the bodies of its chains.
    chain = tree.chains.T[:, None, :, None]
    twists = screws[:, :, None, None] * chain
    twists_by = np.swapaxes(screws_by, 1, 2)[:, :, :, None] * chain
    moved = carried(pose, m)[:, None]
    rates = (m[:, None], carried(twists, m[:, None]))
    by = (moved, carried(twists_by, m[:, None]) + turned(twists, moved))
    part = tree.rows.changes(rates, by, 1) @ by_row[:, None]
    return np.asarray(np.sqrt(((part**2).sum(-1) * (size**2)[:, None]).sum((-1, -2))))


def deviations(tree: Tree, poses: Poses, rates: Rates, inputs: Array) -> Deviations:
    """What claims are made of, at solved poses with their rates.

    Raises:
        LinAlgError: a Jacobian is singular to rounding.
    """
    screws = poses.screws
    inverse = np.asarray(np.linalg.inv(poses.jacobian), dtype=float)
    motion = _settled(tree, screws, rates, inverse)
    noise = _noise(tree, tree.rows, poses, screws, rates, inputs)
    residual = poses.residual
    size = DEVIATIONS * noise[0] + np.abs(residual)
    fold = _fold(tree, poses, screws, inverse, size)
    widened = 1.0 / (1.0 - 2.0 * np.minimum(fold, FOLD))
    return Deviations(motion, noise, residual, widened, fold, np.linalg.cond(poses.jacobian))


def violated(tree: Tree, poses: Poses, rates: Rates, inputs: Array, known: Deviations) -> NDArray[np.bool_]:
    """Which of the rows that are left out an answer violates, (N, left out).

    A row that depends on others is zero with them, but for what rounding does to it and to them.
    """
    rows = tree.left_out
    found = rows.values(poses.matrices, poses.q, rows.target)
    x, y = rows.pairs(poses.matrices)
    dx, dy = rows.pairs(known.motion.matrices[0][:, : tree.size])
    by = product_rates([dx], [y[:, None]], 0) + product_rates([x[:, None]], [dy], 0)
    noise = _noise(tree, rows, poses, poses.screws, rates, inputs)[0]
    return np.asarray(~(np.abs(found) <= _claim(known, by, noise)))


def _settled(tree: Tree, screws: Array, rates: Rates, inverse: Array) -> Motion:
    """The motion by the rows, where their rates are held, and then by each row's first rate alone.

    The joint coordinates' rates by a direction are found from the rows' rates as they would be without them.
    """
    by_row = np.swapaxes(inverse, 1, 2)  # joint coordinates by rows, (N, size, size)
    none = np.zeros_like(by_row)
    pose, wanted = np.concatenate([by_row, none], axis=1), np.concatenate([none, by_row], axis=1)
    s, q1, q2 = screws[:, None], rates.first[:, None, :, None], rates.second[:, None, :, None]
    own, twists = tree.body_of, rates.twists[:, None]
    m = tuple(part[:, None] for part in rates.matrices)
    moved = chain_sum(tree, s * pose[..., None])
    # Screws by the direction, and how they change in time.
    s_by = screw_product(moved[..., own, :], s)
    twists_by = chain_sum(tree, s_by * q1)
    changed = _changed(rates, moved, twists_by, None)
    first = (wanted - tree.rows.changes(m, changed, 1) @ by_row)[..., None]
    twists_by = twists_by + chain_sum(tree, s * first)
    turning = screw_product(twists[..., own, :], s)
    turning_by = screw_product(twists_by[..., own, :], s) + screw_product(twists[..., own, :], s_by)
    accelerations_by = chain_sum(tree, s_by * q2 + turning_by * q1 + turning * first)
    changed = _changed(rates, moved, twists_by, accelerations_by)
    second = chain_sum(tree, s * -(tree.rows.changes(m, changed, 2) @ by_row)[..., None])
    last = changed[2] + carried(second, m[0])
    return Motion(moved, twists_by, accelerations_by + second, (*changed[:2], last))


def _reach(tree: Tree, poses: Poses, places: Places) -> Array:
    """Root of the sum of squares of the chains' lengths, to points, or of directions, (N, P)."""
    joints = poses.matrices.reshape(len(poses.q), 3, -1, 4)[..., 3]
    to_joint = np.zeros((len(poses.q), len(tree.bodies)))
    for body, parent in enumerate(tree.parents[1:], 1):
        to_joint[:, body] = np.square(joints[..., body] - joints[..., parent]).sum(axis=-1)
        to_joint[:, body] += to_joint[:, parent]
    squares = to_joint[:, places.body] * places.point + np.square(places.at).sum(axis=-1)
    return np.asarray(np.sqrt(squares))


def _sizes(
    tree: Tree, poses: Poses, screws: Array, rates: Rates, places: Places
) -> tuple[Array, Array, Array]:
    """Roots of the sums of squares of the terms of points' places, velocities and accelerations, (N, P)."""
    chain = tree.chains[places.body]
    far = np.linalg.norm(at_places(poses, places), axis=-1)[:, :, None]
    linear, angular, fast, turn = _lengths(tree, screws, rates)
    arm = np.hypot(linear * places.point[:, None], angular * far)
    velocity = np.sqrt((np.square(arm * rates.first[:, None]) * chain).sum(axis=-1))
    faster = np.hypot(fast * angular * places.point[:, None], turn * arm)
    acceleration = np.square(arm * rates.second[:, None]) + np.square(faster * rates.first[:, None])
    spin = np.linalg.norm(rates.twists[:, places.body, 3:], axis=-1)
    return (
        _reach(tree, poses, places),
        velocity,
        np.sqrt((acceleration * chain).sum(axis=-1) + np.square(spin * velocity)),
    )


def _lengths(tree: Tree, screws: Array, rates: Rates) -> tuple[Array, Array, Array, Array]:
    """Of the linear and the angular part of the screws, and of their bodies' twists, (N, 1, size) each."""
    own = rates.twists[:, tree.body_of]
    parts = (screws[..., :3], screws[..., 3:], own[..., :3], own[..., 3:])
    linear, angular, fast, turn = (np.linalg.norm(part, axis=-1)[:, None] for part in parts)
    return linear, angular, fast, turn


def _noise(
    tree: Tree, rows: Rows, poses: Poses, screws: Array, rates: Rates, inputs: Array
) -> tuple[Array, Array, Array]:
    """Standard deviations of the rows and of their first and second rates, (N, rows) each.

    Of a rate of X . Y every product of rates is rounded as its factors are.
    """
    # Of the first and second place of X and of Y, (N, 2, 2, F); directions of the chassis are exact.
    exact = (rows.ends.body == 0) & (rows.ends.point == 0.0)
    sizes = [np.where(exact, 0.0, part) for part in _sizes(tree, poses, screws, rates, rows.ends)]
    off = [np.hypot(*np.moveaxis(part.reshape(len(part), 2, 2, -1), 1, 0)) for part in sizes]
    long = [np.linalg.norm(rows.pairs(part), axis=-1) for part in rates.matrices]
    off = [part * np.stack([rows.scale, np.ones_like(rows.scale)]) for part in off]
    squares = []
    for order in range(3):
        parts = [
            math.comb(order, k) ** 2
            * (np.square(long[k][0] * off[order - k][:, 1]) + np.square(long[k][1] * off[order - k][:, 0]))
            for k in range(order + 1)
        ]
        squares.append(np.asarray(sum(parts))[:, : rows.count])
    squares[0][:, rows.tails] += np.square(rows.radii)
    for row, k in zip(rows.drives, rows.drive_numbers, strict=True):
        drive, series = tree.drives[k], np.abs(inputs[:, k])
        _, rate, acceleration = np.moveaxis(series, -1, 0)
        if drive.kind == "angle":
            wanted = [np.full_like(rate, drive.size), drive.size * rate]
            wanted.append(drive.size * (rate * rate + acceleration))
        else:
            wanted = [np.abs(part) for part in drive_rates(drive, series)]
        for order in range(3):
            squares[order][:, row] += np.square(wanted[order])
    first, second, third = (TURNED * np.sqrt(part) for part in squares)
    return first, second, third


def _claim(known: Deviations, by: Array, own: Array, second: Array | None = None) -> Array:
    """Of numbers (N, ...).

    Args:
        by: derivatives by the rows, and by their first rates after these, (N, K, ...).
        own: standard deviation of the last sum. second: derivatives by the rows' second rates, likewise.
    """
    extra = [1] * (by.ndim - 2)

    def by_rows(array: Array) -> Array:
        return array.reshape(*array.shape, *extra)

    size = known.residual.shape[1]
    noise, rates, faster = known.noise
    squares = np.square(own) + np.square(by[:, :size] * by_rows(noise)).sum(axis=1)
    if by.shape[1] > size:
        squares = squares + np.square(by[:, size:] * by_rows(rates)).sum(axis=1)
    if second is not None:
        squares = squares + np.square(second * by_rows(faster)).sum(axis=1)
    rest = np.abs((by[:, :size] * by_rows(known.residual)).sum(axis=1))
    return np.asarray(known.widened.reshape(-1, *extra) * (DEVIATIONS * np.sqrt(squares) + rest))


def point_claims(
    tree: Tree, poses: Poses, rates: Rates, known: Deviations, places: Places
) -> tuple[Array, Array, Array]:
    """How far points' places, velocities and accelerations may be off, (N, P, 3) each."""
    x, v, a = point_derivatives(known.motion, places)
    sizes = _sizes(tree, poses, poses.screws, rates, places)
    own = [TURNED * size[..., None] for size in sizes]
    still = x[:, : tree.size]  # first rates do not move a place
    return _claim(known, still, own[0]), _claim(known, v, own[1]), _claim(known, a, own[2], still)


def body_claims(tree: Tree, poses: Poses, rates: Rates, known: Deviations, body: str) -> tuple[Array, Array]:
    """How far a body's angular velocity and acceleration may be off, (N, 3) each."""
    k, motion = tree.number[body], known.motion
    chain = tree.chains[k]
    _, turns, _, spin = (part[:, 0] for part in _lengths(tree, poses.screws, rates))
    own1 = np.sqrt(np.square(turns * rates.first) @ chain)
    own2 = np.sqrt((np.square(turns * rates.second) + np.square(turns * spin * rates.first)) @ chain)
    turn = motion.pose[:, : tree.size, k, 3:]
    return (
        _claim(known, motion.twists_by[..., k, 3:], TURNED * own1[:, None]),
        _claim(known, motion.accelerations_by[..., k, 3:], TURNED * own2[:, None], turn),
    )


@dataclass(frozen=True)
class Line:
    """A line through two points, of which angles are made.

    Attributes:
        places: start and end, or, where one body carries both, their difference as drawn: a direction, which
            is exact where they lie near to each other.
    """

    places: Places

    @classmethod
    def of(cls, tree: Tree, start: Place, end: Place) -> Line:
        """From one point to another."""
        if start.body == end.body:
            return cls(tree.together([Place(end.body, end.at - start.at)], np.zeros(1)))
        return cls(tree.together([start, end]))

    def now(self, matrices: Array) -> Array:
        """From start to end, (..., 3); of rates of the matrices its rate."""
        at = self.places.now(matrices)
        return np.asarray(at[..., 0, :] if at.shape[-2] == 1 else at[..., 1, :] - at[..., 0, :])


@dataclass(frozen=True)
class LineDerivatives:
    """A line and how it moves.

    Attributes:
        vector: (N, 3). by: its derivatives by the rows, (N, K, 3). own: what its last sum is made of, (N,).
    """

    vector: Array
    by: Array
    own: Array


def line_derivatives(tree: Tree, poses: Poses, known: Deviations, line: Line) -> LineDerivatives:
    """How a line moves with the rows."""
    own = np.linalg.norm(_reach(tree, poses, line.places), axis=-1)
    return LineDerivatives(line.now(poses.matrices), line.now(known.motion.matrices[0][:, : tree.size]), own)


def angle_claims(known: Deviations, line: LineDerivatives, sine: Array, cosine: Array) -> Array:
    """How far the angle of a line may be off, (N,)."""
    length = np.linalg.norm(line.vector, axis=-1)
    up, over = line.vector @ sine, line.vector @ cosine
    squared = up * up + over * over
    with np.errstate(divide="ignore", invalid="ignore"):
        turned = (over[:, None] * (line.by @ sine) - up[:, None] * (line.by @ cosine)) / squared[:, None]
        last = TURNED * np.hypot(line.own, length) / np.sqrt(squared)
    angle = np.abs(np.arctan2(up, over))
    return _claim(known, turned, np.hypot(last, U * angle))
