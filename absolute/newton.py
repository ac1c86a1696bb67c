"""Newton's method on the manifold of body poses, to rounding, and the rates at a pose."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from absolute.backend import eigenpy
from absolute.mechanism import Mechanism, Poses
from absolute.precision import EPS
from absolute.solution import Array
from absolute.stack import Placed, RowStack

# Below this reciprocal condition number a fold of the motion is nearer than sqrt(eps): the two
# branches that meet there can no longer be told apart, nor half of the digits trusted.
SMALLEST_RCOND = float(np.sqrt(EPS))

# A factorisation serves further corrections as long as each shrinks at least a hundredfold.
GOOD_CONTRACTION = 1e-2

# Quadratic convergence from a correction of 0.1 needs about 6 corrections; 25 is a stall.
MOST_CORRECTIONS = 25


class Pose(NamedTuple):
    """A configuration where the rows meet their target, with the factorised Jacobian there.

    Attributes:
        q: configuration of Pinocchio.
        poses, placed: body poses and rows there.
        factors: LU factors of the Jacobian.
        rcond: estimate of its reciprocal condition number (1-norm).
        signs: signs of the determinants of its groups; they change only through a singular pose.
        residual: largest violation of a row, in units of size.
        floor: the largest correction that rounding explains.
    """

    q: Array
    poses: Poses
    placed: Placed
    factors: eigenpy.PartialPivLU
    rcond: float
    signs: Array
    residual: float
    floor: float


def rounding_of(rcond: float) -> float:
    """The largest correction that rounding explains.

    Each row is rounded like a few products of order 1, and the inverse of the Jacobian magnifies
    that; columns have a norm of order 1, so 1 / rcond bounds the norm of the inverse.
    """
    return 64 * EPS / rcond if rcond > 0 else math.inf


def inverse(rcond: float) -> float:
    """The condition number of a reciprocal one."""
    return 1.0 / rcond if rcond > 0 else math.inf


def pose_at(
    mechanism: Mechanism,
    q: Array,
    poses: Poses,
    placed: Placed,
    target: Array,
    jacobian: Array,
    factors: eigenpy.PartialPivLU,
) -> Pose:
    """The pose at a configuration with its Jacobian and the factors of that."""
    rcond = factors.rcond()
    residual = float(np.abs(mechanism.stack.gap(placed, target)).max())
    signs = mechanism.signs(jacobian)
    return Pose(q, poses, placed, factors, rcond, signs, residual, rounding_of(rcond))


class Corrected(NamedTuple):
    """Outcome of Newton's method: the pose or None, corrections spent, size of the first."""

    pose: Pose | None
    corrections: int
    first: float


def correct(mechanism: Mechanism, q: Array, target: Array, rcond: float) -> Corrected:
    """Solve  rows(q) = target  near q.

    The first Jacobian serves every correction as long as each is a hundredth of the one before;
    it is renewed otherwise. With contraction c the error left after a correction s is at most
    s c / (1 - c); before c is known, about s^2 / rcond, with the `rcond` of a pose nearby, as the
    rows are quadratic with second derivatives of order 1. Newton stops when that is below eps, or
    when corrections no longer shrink, and then a fresh Jacobian must find the next correction as
    small as rounding explains and the rows closed to rounding. The correction alone proves nothing
    near a fold: there it falls as the root of the residual, and just beyond the fold, where there
    is no pose, it is as small. Anything else is a failure: `pose` is None.
    """
    factors = None
    previous = first = np.inf
    settled = False
    for count in range(1, MOST_CORRECTIONS + 1):
        poses = mechanism.poses(q)
        placed = mechanism.stack.place(*poses)
        if factors is None or settled:
            jacobian = mechanism.stack.jacobian(placed)
            factors = eigenpy.PartialPivLU(jacobian)
        step = factors.solve(mechanism.stack.gap(placed, target))
        size = math.sqrt(step @ step)
        if not math.isfinite(size):
            break
        if settled:
            pose = pose_at(mechanism, q, poses, placed, target, jacobian, factors)
            if not size <= pose.floor:
                return Corrected(None, count - 1, first)
            if mechanism.stack.closed(placed, target):
                return Corrected(pose, count - 1, first)
        contraction = size / previous
        q = mechanism.moved(q, poses.rotation, step)
        if settled:
            continue
        if count == 1:
            first = size
            settled = size * size <= EPS * rcond
            renew = size > GOOD_CONTRACTION
        else:
            settled = contraction > 0.5 or size * contraction < EPS * (1 - contraction)
            renew = contraction > GOOD_CONTRACTION
        if renew:
            factors = None
        previous = size
    return Corrected(None, count, first)


def accelerations(mechanism: Mechanism, pose: Pose, rate: Array, second: Array) -> tuple[Array, Array]:
    """Velocities and accelerations [o', w], [o'', w'] of the moving bodies by the factors of a pose.

    J v = rate,  J a = second - drift(v):  one matrix serves both.
    """
    velocity = pose.factors.solve(rate)
    moving = np.zeros((len(pose.poses.origin), 2, 3))
    moving[1:] = velocity.reshape(-1, 2, 3)
    drift = mechanism.stack.drift(pose.placed, moving)
    return velocity, pose.factors.solve(second - drift)


def held_at(mechanism: Mechanism, pose: Pose) -> bool:
    """Whether the rows that were left out hold at a pose."""
    left_out = mechanism.redundant
    if left_out is None:
        return True
    placed = left_out.place(*pose.poses)
    return bool(held_to(left_out, placed, mechanism.stack.count, inverse(pose.rcond)).all())


def held_to(left_out: RowStack, placed: Placed, unknowns: int, strength: Array | float) -> NDArray[np.bool_]:
    """(..., rows) whether rows that were left out hold at poses that close to rounding.

    Args:
        placed: these rows there. strength: (...) norm of the inverse of the Jacobian: the pose is off by so
            many times the rounding of its rows, and a row changes by no more than a few times that.
    """
    more = 1.0 + np.sqrt(unknowns) * np.asarray(strength)[..., None]
    gap = left_out.gap(placed, left_out.drawn)
    return np.asarray(np.abs(gap) <= left_out.rounding(placed) * more)
