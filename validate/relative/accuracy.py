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

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from validate.relative.follow import Poses, at_places
from validate.relative.linkage import Line
from validate.relative.rates import (
    Rates,
    as_rows,
    carried,
    chain_sum,
    closure_gaps,
    cross,
    point_velocities,
    screw_product,
    screws_by_joint,
)
from validate.relative.tree import TURNED, Places, Tree, U

Array = NDArray[np.float64]

# Of some 1e5 numbers one goes beyond 4.4 standard deviations if they are normal; roundings of one pose are
# shared by its numbers and not all independent.
DEVIATIONS = 5.0
FOLD = 0.125
# Poses whose folds are looked at together: what is made on the way takes some 10 kB for each.
BLOCK = 2**10


@dataclass(frozen=True)
class Motion:
    """How bodies move in one or more directions; the axis of the directions, K, follows that of the poses.

    Attributes:
        twists: of the bodies and the chassis with time, (N, 1, bodies + 1, 6).
        accelerations: likewise.
        pose: twists of the bodies with the direction, (N, K, bodies + 1, 6).
        twists_by, accelerations_by: derivatives of the twists and accelerations, (N, K, bodies + 1, 6).
    """

    twists: Array
    accelerations: Array
    pose: Array
    twists_by: Array
    accelerations_by: Array


@dataclass(frozen=True)
class Deviations:
    """What every number's claim is made of.

    Attributes:
        motion: how everything moves with the rows and, after these, with their first rates.
        noise: standard deviations of the rows and of their first and second rates, (3, N, size).
        residual: what is left of the rows, (N, size).
        widened: 1 / (1 - 2 h), (N,). fold: h, (N,).
        condition: number of the Jacobian, (N,).
    """

    motion: Motion
    noise: Array
    residual: Array
    widened: Array
    fold: Array
    condition: Array


def point_derivatives(poses: Poses, motion: Motion, places: Places) -> tuple[Array, Array, Array]:
    """Of points' places, velocities and accelerations by the directions, (N, K, P, 3) each."""
    at, body = at_places(poses, places)[:, None], places.body
    moved, faster = _first(at, motion.pose, motion.twists, motion.twists_by, body)
    twist, by = motion.twists[..., body, :], motion.twists_by[..., body, :]
    second = (
        carried(motion.accelerations_by[..., body, :], at)
        + cross(motion.accelerations[..., body, 3:], moved)
        + cross(by[..., 3:], carried(twist, at))
        + cross(twist[..., 3:], faster)
    )
    return moved, faster, second


def _first(
    at: Array, pose: Array, twists: Array, twists_by: Array, body: NDArray[np.int64]
) -> tuple[Array, Array]:
    """Derivatives of points' places and velocities by directions, (..., P, 3) each.

    Args:
        at: places, (..., P, 3). pose, twists, twists_by: as of `Motion`, (..., bodies + 1, 6).
        body: of each point, (P,).
    """
    moved = carried(pose[..., body, :], at)
    return moved, carried(twists_by[..., body, :], at) + cross(twists[..., body, 3:], moved)


def _first_rates(tree: Tree, at: Array, pose: Array, twists: Array, twists_by: Array) -> Array:
    """Derivatives of the rows' first rates by directions, (..., size).

    Args:
        at: places of the rows' ends, (..., ends, 3). pose, twists, twists_by: as of `_first`.
    """
    body, rods = tree.ends.body, tree.rods
    moved, faster = _first(at, pose, twists, twists_by, body)
    place, velocity = closure_gaps(tree, moved)[..., rods, :], closure_gaps(tree, faster)
    d, d1 = (closure_gaps(tree, x)[..., rods, :] for x in (at, carried(twists[..., body, :], at)))
    along = (place * d1 + d * velocity[..., rods, :]).sum(-1) / tree.lengths
    return as_rows(tree, velocity, along, faster[..., 2 * len(tree.linkage.closures) :, :])


def _second_rates(tree: Tree, poses: Poses, motion: Motion) -> Array:
    """Derivatives of the rows' second rates by the directions, (N, K, size)."""
    at, body, rods = at_places(poses, tree.ends)[:, None], tree.ends.body, tree.rods
    ends = point_derivatives(poses, motion, tree.ends)
    place, velocity = (closure_gaps(tree, x)[..., rods, :] for x in ends[:2])
    apart = closure_gaps(tree, ends[2])
    twist = motion.twists[..., body, :]
    fast = carried(twist, at)
    faster = carried(motion.accelerations[..., body, :], at) + cross(twist[..., 3:], fast)
    d, d1, d2 = (closure_gaps(tree, x)[..., rods, :] for x in (at, fast, faster))
    along = (place * d2 + d * apart[..., rods, :] + 2.0 * d1 * velocity).sum(-1) / tree.lengths
    return as_rows(tree, apart, along, ends[2][..., 2 * len(tree.linkage.closures) :, :])


def _fold(tree: Tree, poses: Poses, screws: Array, inverse: Array, size: Array) -> Array:
    """How much the Jacobian changes over the pose's error, in parts of itself, (N,)."""
    found = np.empty(len(screws))
    at = at_places(poses, tree.ends)
    for low in range(0, len(screws), BLOCK):
        some = slice(low, low + BLOCK)
        found[some] = _fold_of_block(tree, at[some], screws[some], inverse[some], size[some])
    return found


def _fold_of_block(tree: Tree, at: Array, screws: Array, inverse: Array, size: Array) -> Array:
    # Column k of dJ v is a row's first rate by the pose where coordinate k alone moves at rate one.
    by_row = np.swapaxes(inverse, 1, 2)
    moved = chain_sum(tree, screws[:, None] * by_row[..., None])
    turned = screw_product(moved[:, :, tree.body_of], screws[:, None])
    # (N, K, size) to (N, coordinates, 1 or K, bodies + 1, 6): a coordinate moves the bodies of its chains.
    chain = tree.chains.T[:, None, :, None]
    twists = screws[:, :, None, None] * chain
    twists_by = np.swapaxes(turned, 1, 2)[:, :, :, None] * chain
    changed = _first_rates(tree, at[:, None, None], moved[:, None], twists, twists_by)
    part = changed @ by_row[:, None]
    return np.asarray(np.sqrt(((part**2).sum(-1) * (size**2)[:, None]).sum((-1, -2))))


def deviations(tree: Tree, poses: Poses, rates: Rates, inputs: Array) -> Deviations:
    """What claims are made of, at solved poses with their rates.

    Raises:
        LinAlgError: a Jacobian is singular to rounding.
    """
    screws = screws_by_joint(poses)
    inverse = np.asarray(np.linalg.inv(rates.jacobian), dtype=float)
    motion = _settled(tree, poses, screws, rates, inverse)
    noise = _noise(tree, poses, screws, rates, inputs)
    residual = poses.residual
    size = DEVIATIONS * noise[0] + np.abs(residual)
    fold = _fold(tree, poses, screws, inverse, size)
    widened = 1.0 / (1.0 - 2.0 * np.minimum(fold, FOLD))
    return Deviations(motion, noise, residual, widened, fold, np.linalg.cond(rates.jacobian))


def _settled(tree: Tree, poses: Poses, screws: Array, rates: Rates, inverse: Array) -> Motion:
    """The motion by the rows, where their rates are held, and then by each row's first rate alone.

    The joint coordinates' rates by a direction are found from the rows' rates as they would be without them.
    """
    by_row = np.swapaxes(inverse, 1, 2)  # joint coordinates by rows, (N, size, size)
    none = np.zeros_like(by_row)
    pose, wanted = np.concatenate([by_row, none], axis=1), np.concatenate([none, by_row], axis=1)
    s, q1, q2 = screws[:, None], rates.first[:, None, :, None], rates.second[:, None, :, None]
    own, at = tree.body_of, at_places(poses, tree.ends)[:, None]
    twists, accelerations = rates.twists[:, None], rates.accelerations[:, None]
    moved = chain_sum(tree, s * pose[..., None])
    # Screws by the direction, and how they change in time.
    s_by = screw_product(moved[..., own, :], s)
    twists_by = chain_sum(tree, s_by * q1)
    first = (wanted - _first_rates(tree, at, moved, twists, twists_by) @ by_row)[..., None]
    twists_by = twists_by + chain_sum(tree, s * first)
    turned = screw_product(twists[..., own, :], s)
    turned_by = screw_product(twists_by[..., own, :], s) + screw_product(twists[..., own, :], s_by)
    accelerations_by = chain_sum(tree, s_by * q2 + turned_by * q1 + turned * first)
    open_ = Motion(twists, accelerations, moved, twists_by, accelerations_by)
    second = -(_second_rates(tree, poses, open_) @ by_row)[..., None]
    return replace(open_, accelerations_by=accelerations_by + chain_sum(tree, s * second))


def _reach(tree: Tree, poses: Poses, places: Places) -> Array:
    """Root of the sum of squares of the chains' lengths, to points, (N, P)."""
    to_joint = np.zeros((len(poses.q), len(tree.bodies) + 1))
    joints = np.concatenate([poses.translations, np.zeros((len(poses.q), 1, 3))], axis=1)
    for body, parent in enumerate(tree.parents):
        # Without a parent it is the chassis, which is the last.
        to_joint[:, body] = np.square(joints[:, body] - joints[:, parent]).sum(axis=-1) + to_joint[:, parent]
    from_joint = at_places(poses, places) - joints[:, places.body]
    squares = to_joint[:, places.body] + np.square(from_joint).sum(axis=-1)
    return np.asarray(np.sqrt(squares))


def _sizes(
    tree: Tree, poses: Poses, screws: Array, rates: Rates, places: Places
) -> tuple[Array, Array, Array]:
    """Roots of the sums of squares of the terms of points' places, velocities and accelerations, (N, P)."""
    chain = tree.chains[places.body]
    far = np.linalg.norm(at_places(poses, places), axis=-1)[:, :, None]
    linear, angular, fast, turn = _lengths(tree, screws, rates)
    arm = np.hypot(linear, angular * far)
    velocity = np.sqrt((np.square(arm * rates.first[:, None]) * chain).sum(axis=-1))
    turned = np.hypot(fast * angular, turn * arm)
    acceleration = np.square(arm * rates.second[:, None]) + np.square(turned * rates.first[:, None])
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


def _noise(tree: Tree, poses: Poses, screws: Array, rates: Rates, inputs: Array) -> Array:
    """Standard deviations of the rows and of their first and second rates, (3, N, size)."""
    noise = np.zeros((3, len(screws), tree.size))
    count = len(tree.linkage.closures)
    ends = np.stack(_sizes(tree, poses, screws, rates, tree.ends))
    closures, drives = np.hypot(ends[..., :count], ends[..., count : 2 * count]), ends[..., 2 * count :]
    fast = closure_gaps(tree, point_velocities(poses, rates.twists, tree.ends))[:, tree.rods]
    twice = 2.0 * np.linalg.norm(fast, axis=-1) / tree.lengths
    closures[2][:, tree.rods] = np.hypot(closures[2][:, tree.rods], twice * closures[1][:, tree.rods])
    noise[..., tree.ball_rows] = closures[..., tree.balls, None]
    noise[..., tree.rod_rows] = closures[..., tree.rods]
    for k, drive in enumerate(tree.linkage.drives):
        value, rate, acceleration = (np.abs(inputs[:, k, order]) for order in range(3))
        wanted = (
            (drive.size, drive.size * rate, drive.size * (rate * rate + acceleration))
            if drive.kind == "angle"
            else (drive.size * value, drive.size * rate, drive.size * acceleration)
        )
        foot = (abs(float(drive.foot @ drive.direction)), 0.0, 0.0)
        for order in range(3):
            squares = drives[order, :, k] ** 2 + wanted[order] ** 2 + foot[order] ** 2
            noise[order, :, tree.first_drive + k] = np.sqrt(squares)
    return np.asarray(TURNED * noise)


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
    x, v, a = point_derivatives(poses, known.motion, places)
    sizes = _sizes(tree, poses, screws_by_joint(poses), rates, places)
    own = [TURNED * size[..., None] for size in sizes]
    still = x[:, : tree.size]  # first rates do not move a place
    return _claim(known, still, own[0]), _claim(known, v, own[1]), _claim(known, a, own[2], still)


def body_claims(tree: Tree, poses: Poses, rates: Rates, known: Deviations, body: str) -> tuple[Array, Array]:
    """How far a body's angular velocity and acceleration may be off, (N, 3) each."""
    k, motion = tree.number(body), known.motion
    chain = tree.chains[k]
    _, turns, _, spin = (part[:, 0] for part in _lengths(tree, screws_by_joint(poses), rates))
    own1 = np.sqrt(np.square(turns * rates.first) @ chain)
    own2 = np.sqrt((np.square(turns * rates.second) + np.square(turns * spin * rates.first)) @ chain)
    turn = motion.pose[:, : tree.size, k, 3:]
    return (
        _claim(known, motion.twists_by[..., k, 3:], TURNED * own1[:, None]),
        _claim(known, motion.accelerations_by[..., k, 3:], TURNED * own2[:, None], turn),
    )


def line_vector(tree: Tree, poses: Poses, line: Line) -> Array:
    """From a line's start to its end, (N, 3); turned with the body where one carries both."""
    if line.fixed:
        return np.asarray(poses.rotations[:, tree.number(line.start.body)] @ line.drawn)
    at = at_places(poses, tree.together((line.start, line.end)))
    return np.asarray(at[:, 1] - at[:, 0])


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
    vector, pose = line_vector(tree, poses, line), known.motion.pose[:, : tree.size]
    if line.fixed:
        turned = cross(pose[..., tree.number(line.start.body), 3:], vector[:, None])
        return LineDerivatives(vector, turned, np.linalg.norm(vector, axis=-1))
    places = tree.together((line.start, line.end))
    moved = carried(pose[..., places.body, :], at_places(poses, places)[:, None])
    reach = _reach(tree, poses, places)
    return LineDerivatives(vector, moved[..., 1, :] - moved[..., 0, :], np.hypot(reach[:, 0], reach[:, 1]))


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
