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

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from validate.relative.follow import Poses, at_place
from validate.relative.linkage import CHASSIS, Coincide, Distance, Line, Place
from validate.relative.rates import (
    Rates,
    chain_sum,
    cross,
    link,
    point_velocity,
    screw_product,
    screws_by_joint,
)
from validate.relative.tree import TURNED, Tree, U

Array = NDArray[np.float64]

# Of some 1e5 numbers one goes beyond 4.4 standard deviations if they are normal; roundings of one pose are
# shared by its numbers and not all independent.
DEVIATIONS = 5.0
FOLD = 0.125


@dataclass(frozen=True)
class Motion:
    """How bodies move in one or more directions; the axis of the directions, K, follows that of the poses.

    Attributes:
        twists: of the bodies with time, (N, 1 or K, bodies, 6).
        accelerations: likewise.
        pose: twists of the bodies with the direction, (N, K, bodies, 6).
        twists_by, accelerations_by: derivatives of the twists and accelerations, (N, K, bodies, 6).
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
        by_pose, by_rate: how everything moves with the rows and with their first rates.
        noise: standard deviations of the rows and of their first and second rates, (3, N, size).
        residual: what is left of the rows, (N, size).
        widened: 1 / (1 - 2 h), (N,). fold: h, (N,).
        condition: number of the Jacobian, (N,).
    """

    by_pose: Motion
    by_rate: Motion
    noise: Array
    residual: Array
    widened: Array
    fold: Array
    condition: Array


def _first(tree: Tree, at: Array, motion: Motion, place: Place) -> tuple[Array, Array]:
    """Derivatives of a point's place and velocity by the directions, (N, K, 3) each."""
    body = tree.bodies.index(place.body)
    pose, twist, by = (m[..., body, :] for m in (motion.pose, motion.twists, motion.twists_by))
    moved = pose[..., :3] + cross(pose[..., 3:], at)
    return moved, by[..., :3] + cross(by[..., 3:], at) + cross(twist[..., 3:], moved)


def _second(tree: Tree, at: Array, motion: Motion, place: Place) -> Array:
    """Derivative of a point's acceleration by the directions, (N, K, 3)."""
    body = tree.bodies.index(place.body)
    twist, by = motion.twists[..., body, :], motion.twists_by[..., body, :]
    acceleration, acc_by = motion.accelerations[..., body, :], motion.accelerations_by[..., body, :]
    moved, faster = _first(tree, at, motion, place)
    velocity = twist[..., :3] + cross(twist[..., 3:], at)
    return np.asarray(
        acc_by[..., :3]
        + cross(acc_by[..., 3:], at)
        + cross(acceleration[..., 3:], moved)
        + cross(by[..., 3:], velocity)
        + cross(twist[..., 3:], faster)
    )


def point_derivatives(tree: Tree, poses: Poses, motion: Motion, place: Place) -> tuple[Array, Array, Array]:
    """Of a point's place, velocity and acceleration by the directions, (N, K, 3) each."""
    if place.body == CHASSIS:
        still = np.zeros((*motion.pose.shape[:2], 3))
        return still, still, still
    at = at_place(tree, poses, place)[:, None, :]
    return (*_first(tree, at, motion, place), _second(tree, at, motion, place))


def _row_derivatives(tree: Tree, poses: Poses, motion: Motion) -> tuple[Array, Array]:
    """Of the rows' first and second rates by the directions, (N, K, size) each."""
    shape = (*motion.pose.shape[:2], tree.size)
    first, second = np.empty(shape), np.empty(shape)
    row = 0
    for closure in tree.linkage.closures:
        one, two = (point_derivatives(tree, poses, motion, p) for p in (closure.first, closure.second))
        place, velocity, acceleration = (a - b for a, b in zip(one, two, strict=True))
        if isinstance(closure, Coincide):
            first[..., row : row + 3], second[..., row : row + 3] = velocity, acceleration
            row += 3
            continue
        d = link(tree, poses, closure)[:, None, :]
        d1, d2 = (
            _time_derivative(tree, poses, motion, closure.first, order)
            - _time_derivative(tree, poses, motion, closure.second, order)
            for order in (1, 2)
        )
        first[..., row] = ((place * d1 + d * velocity) / closure.length).sum(-1)
        second[..., row] = ((place * d2 + d * acceleration + 2.0 * d1 * velocity) / closure.length).sum(-1)
        row += 1
    for drive in tree.linkage.drives:
        _, velocity, acceleration = point_derivatives(tree, poses, motion, drive.place)
        first[..., row], second[..., row] = velocity @ drive.direction, acceleration @ drive.direction
        row += 1
    return first, second


def _time_derivative(tree: Tree, poses: Poses, motion: Motion, place: Place, order: int) -> Array:
    """Velocity or acceleration of a point with time, (N, 1 or K, 3)."""
    if place.body == CHASSIS:
        return np.zeros((len(poses.q), 1, 3))
    body = tree.bodies.index(place.body)
    at = at_place(tree, poses, place)[:, None, :]
    twist = motion.twists[..., body, :]
    velocity = twist[..., :3] + cross(twist[..., 3:], at)
    if order == 1:
        return np.asarray(velocity)
    acceleration = motion.accelerations[..., body, :]
    return np.asarray(
        acceleration[..., :3] + cross(acceleration[..., 3:], at) + cross(twist[..., 3:], velocity)
    )


def _motion(tree: Tree, screws: Array, rates: Rates, pose: Array, first: Array, second: Array) -> Motion:
    """How everything moves in directions.

    Args:
        screws: (N, size, 6).
        pose: joint coordinates by the directions, (N, K, size).
        first, second: derivatives of the rates of the joint coordinates, likewise.
    """
    s, q1, q2 = screws[:, None], rates.first[:, None, :, None], rates.second[:, None, :, None]
    own = tree.body_of
    moved = chain_sum(tree, s * pose[..., None])
    # Screws by the direction, and how they change in time.
    s_by = screw_product(moved[..., own, :], np.broadcast_to(s, (*pose.shape, 6)))
    twists_by = chain_sum(tree, s_by * q1 + s * first[..., None])
    twists = rates.twists[:, None]
    turned = screw_product(twists[..., own, :], s)
    turned_by = screw_product(twists_by[..., own, :], np.broadcast_to(s, s_by.shape)) + screw_product(
        np.broadcast_to(twists[..., own, :], s_by.shape), s_by
    )
    accelerations_by = chain_sum(
        tree, s_by * q2 + s * second[..., None] + turned_by * q1 + turned * first[..., None]
    )
    return Motion(twists, rates.accelerations[:, None], moved, twists_by, accelerations_by)


def _fold(tree: Tree, poses: Poses, screws: Array, inverse: Array, by_row: Array, size: Array) -> Array:
    """How much the Jacobian changes over the pose's error, in parts of itself, (N,)."""
    total = np.zeros(len(screws))
    zero = np.zeros((len(screws), 1, tree.size))
    for k in range(tree.size):
        # Column k of dJ v is a row's first rate by the pose where coordinate k alone moves at rate one.
        unit = np.zeros((len(screws), tree.size))
        unit[:, k] = 1.0
        moved = chain_sum(tree, screws * unit[..., None])
        rates = Rates(inverse, unit, np.zeros_like(unit), moved, np.zeros_like(moved))
        motion = _motion(tree, screws, rates, by_row, zero, zero)
        changed, _ = _row_derivatives(tree, poses, motion)
        part = np.einsum("nij,nkj->nki", inverse, changed)
        total += ((part**2).sum(-1) * size**2).sum(-1)
    return np.asarray(np.sqrt(total))


def deviations(tree: Tree, poses: Poses, rates: Rates, inputs: Array) -> Deviations:
    """What claims are made of, at solved poses with their rates.

    Raises:
        LinAlgError: a Jacobian is singular to rounding.
    """
    screws = screws_by_joint(poses)
    inverse = np.asarray(np.linalg.inv(rates.jacobian), dtype=float)
    by_row = np.swapaxes(inverse, 1, 2)  # joint coordinates by rows, (N, K, size)
    none = np.zeros_like(by_row)
    pose = _settled(tree, poses, screws, rates, inverse, by_row, none)
    rate = _settled(tree, poses, screws, rates, inverse, none, by_row)
    noise = _noise(tree, poses, screws, rates, inputs)
    residual = poses.residual
    size = DEVIATIONS * noise[0] + np.abs(residual)
    fold = _fold(tree, poses, screws, inverse, by_row, size)
    widened = 1.0 / (1.0 - 2.0 * np.minimum(fold, FOLD))
    return Deviations(pose, rate, noise, residual, widened, fold, np.linalg.cond(rates.jacobian))


def _settled(
    tree: Tree, poses: Poses, screws: Array, rates: Rates, inverse: Array, pose: Array, first: Array
) -> Motion:
    """The motion in directions in which the rows' rates are held, but for `first` in their first rates."""
    none = np.zeros_like(pose)
    open_, _ = _row_derivatives(tree, poses, _motion(tree, screws, rates, pose, none, none))
    faster = first - np.einsum("nij,nkj->nki", inverse, open_)
    _, open_ = _row_derivatives(tree, poses, _motion(tree, screws, rates, pose, faster, none))
    second = -np.einsum("nij,nkj->nki", inverse, open_)
    return _motion(tree, screws, rates, pose, faster, second)


def _reach(tree: Tree, poses: Poses, place: Place) -> Array:
    """Root of the sum of squares of a chain's lengths, to a point, (N,)."""
    if place.body == CHASSIS:
        return np.full(len(poses.q), float(np.linalg.norm(place.at)))
    body = tree.bodies.index(place.body)
    at = at_place(tree, poses, place)
    squares = np.zeros(len(at))
    while body >= 0:
        joint = poses.translations[:, body]
        squares += np.square(at - joint).sum(axis=-1)
        at, body = joint, int(tree.parents[body])
    return np.asarray(np.sqrt(squares + np.square(at).sum(axis=-1)))


def _sizes(tree: Tree, poses: Poses, screws: Array, rates: Rates, place: Place) -> tuple[Array, Array, Array]:
    """Roots of the sums of squares of the terms of a point's place, velocity and acceleration, (N,) each."""
    place_size = _reach(tree, poses, place)
    if place.body == CHASSIS:
        return place_size, np.zeros_like(place_size), np.zeros_like(place_size)
    body = tree.bodies.index(place.body)
    chain = tree.chains[body]
    far = np.linalg.norm(at_place(tree, poses, place), axis=-1)[:, None]
    linear, angular = (np.linalg.norm(part, axis=-1) for part in (screws[..., :3], screws[..., 3:]))
    own = rates.twists[:, tree.body_of]
    fast, turn = (np.linalg.norm(part, axis=-1) for part in (own[..., :3], own[..., 3:]))
    arm = np.hypot(linear, angular * far)
    velocity = np.sqrt(np.square(arm * rates.first) @ chain)
    turned = np.hypot(fast * angular, turn * arm)
    acceleration = (np.square(arm * rates.second) + np.square(turned * rates.first)) @ chain
    spin = np.linalg.norm(rates.twists[:, body, 3:], axis=-1)
    return place_size, velocity, np.sqrt(acceleration + np.square(spin * velocity))


def _noise(tree: Tree, poses: Poses, screws: Array, rates: Rates, inputs: Array) -> Array:
    """Standard deviations of the rows and of their first and second rates, (3, N, size)."""
    noise = np.zeros((3, len(screws), tree.size))
    row = 0
    for closure in tree.linkage.closures:
        one, two = (_sizes(tree, poses, screws, rates, place) for place in (closure.first, closure.second))
        both = [np.hypot(a, b) for a, b in zip(one, two, strict=True)]
        rows = 3 if isinstance(closure, Coincide) else 1
        if isinstance(closure, Distance):
            fast = point_velocity(tree, poses, rates.twists, closure.first) - point_velocity(
                tree, poses, rates.twists, closure.second
            )
            both[2] = np.hypot(both[2], 2.0 * np.linalg.norm(fast, axis=-1) * both[1] / closure.length)
        for order in range(3):
            noise[order, :, row : row + rows] = both[order][:, None]
        row += rows
    for k, drive in enumerate(tree.linkage.drives):
        sizes = _sizes(tree, poses, screws, rates, drive.place)
        value, rate, acceleration = (np.abs(inputs[:, k, order]) for order in range(3))
        wanted = (
            (drive.size, drive.size * rate, drive.size * (rate * rate + acceleration))
            if drive.kind == "angle"
            else (drive.size * value, drive.size * rate, drive.size * acceleration)
        )
        foot = (abs(float(drive.foot @ drive.direction)), 0.0, 0.0)
        for order in range(3):
            noise[order, :, row] = np.sqrt(sizes[order] ** 2 + wanted[order] ** 2 + foot[order] ** 2)
        row += 1
    return np.asarray(TURNED * noise)


def _claim(deviations: Deviations, parts: Sequence[tuple[Array, Array]], own: Array, left: Array) -> Array:
    """Of numbers (N, ...).

    Args:
        parts: derivatives by the rows, (N, K, ...), each with the deviation of the rows, (N, K).
        own: standard deviation of the last sum. left: by the rows, for what is left of these.
    """
    extra = left.ndim - 2
    squares = np.square(own)
    for by, noise in parts:
        squares = squares + np.square(by * noise.reshape(*noise.shape, *[1] * extra)).sum(axis=1)
    residual = deviations.residual
    rest = np.abs((left * residual.reshape(*residual.shape, *[1] * extra)).sum(axis=1))
    widened = deviations.widened.reshape(-1, *[1] * extra)
    return np.asarray(widened * (DEVIATIONS * np.sqrt(squares) + rest))


def point_claims(
    tree: Tree, poses: Poses, rates: Rates, deviations: Deviations, place: Place
) -> tuple[Array, Array, Array]:
    """How far a point's place, velocity and acceleration may be off, (N, 3) each."""
    screws = screws_by_joint(poses)
    x, v, a = point_derivatives(tree, poses, deviations.by_pose, place)
    _, v_rate, a_rate = point_derivatives(tree, poses, deviations.by_rate, place)
    own = [TURNED * size[:, None] for size in _sizes(tree, poses, screws, rates, place)]
    n, n1, n2 = deviations.noise
    return (
        _claim(deviations, [(x, n)], own[0], x),
        _claim(deviations, [(v, n), (v_rate, n1)], own[1], v),
        _claim(deviations, [(a, n), (a_rate, n1), (x, n2)], own[2], a),
    )


def body_claims(
    tree: Tree, poses: Poses, rates: Rates, deviations: Deviations, body: str
) -> tuple[Array, Array]:
    """How far a body's angular velocity and acceleration may be off, (N, 3) each."""
    k = tree.bodies.index(body)
    pose, rate = deviations.by_pose, deviations.by_rate
    screws, chain = screws_by_joint(poses), tree.chains[k]
    turns = np.linalg.norm(screws[..., 3:], axis=-1)
    spin = np.linalg.norm(rates.twists[:, tree.body_of, 3:], axis=-1)
    own1 = np.sqrt(np.square(turns * rates.first) @ chain)
    own2 = np.sqrt((np.square(turns * rates.second) + np.square(turns * spin * rates.first)) @ chain)
    n, n1, n2 = deviations.noise
    w, w_rate = (m.twists_by[..., k, 3:] for m in (pose, rate))
    a, a_rate = (m.accelerations_by[..., k, 3:] for m in (pose, rate))
    turn = pose.pose[..., k, 3:]
    return (
        _claim(deviations, [(w, n), (w_rate, n1)], TURNED * own1[:, None], w),
        _claim(deviations, [(a, n), (a_rate, n1), (turn, n2)], TURNED * own2[:, None], a),
    )


def line_vector(tree: Tree, poses: Poses, line: Line) -> Array:
    """From a line's start to its end, (N, 3); turned with the body where one carries both."""
    if line.fixed:
        return np.asarray(poses.rotations[:, tree.bodies.index(line.start.body)] @ line.drawn)
    return at_place(tree, poses, line.end) - at_place(tree, poses, line.start)


def angle_claims(
    tree: Tree, poses: Poses, deviations: Deviations, line: Line, sine: Array, cosine: Array
) -> Array:
    """How far the angle of a line may be off, (N,)."""
    vector = line_vector(tree, poses, line)
    length = np.linalg.norm(vector, axis=-1)
    if line.fixed:
        body = tree.bodies.index(line.start.body)
        by = cross(deviations.by_pose.pose[..., body, 3:], vector[:, None, :])
        own = length
    else:
        end, start = (
            point_derivatives(tree, poses, deviations.by_pose, place)[0] for place in (line.end, line.start)
        )
        by = end - start
        own = np.hypot(_reach(tree, poses, line.end), _reach(tree, poses, line.start))
    up, over = vector @ sine, vector @ cosine
    squared = up * up + over * over
    with np.errstate(divide="ignore", invalid="ignore"):
        turned = (over[:, None] * (by @ sine) - up[:, None] * (by @ cosine)) / squared[:, None]
        last = TURNED * np.hypot(own, length) / np.sqrt(squared)
    angle = np.abs(np.arctan2(up, over))
    return _claim(deviations, [(turned, deviations.noise[0])], np.hypot(last, U * angle), turned)
