"""Newton's method on the manifold of body poses, to rounding, and the rates at a pose."""

import math
from dataclasses import dataclass

import eigenpy
import numpy as np

from absolute.assembly import Mechanism, Poses
from absolute.solution import Array
from absolute.stack import Placed

EPS = float(np.finfo(float).eps)

# Below this reciprocal condition number a fold of the motion is nearer than sqrt(eps): the two
# branches that meet there can no longer be told apart, nor half of the digits trusted.
SMALLEST_RCOND = float(np.sqrt(EPS))

# A factorisation serves further corrections as long as each shrinks at least a hundredfold.
GOOD_CONTRACTION = 1e-2

# Quadratic convergence from a correction of 0.25 needs about 6 corrections; 25 is a stall.
MOST_CORRECTIONS = 25


@dataclass(frozen=True)
class Pose:
    """A configuration where the rows meet their target, with the factorised Jacobian there.

    Attributes:
        q: configuration of Pinocchio.
        poses, placed: body poses and rows there.
        factors: LU factors of the Jacobian.
        rcond: estimate of its reciprocal condition number (1-norm).
        sign: sign of its determinant; it changes only through a singular pose.
        residual: largest violation of a row, in units of size.
        norm: 1-norm of the Jacobian.
    """

    q: Array
    poses: Poses
    placed: Placed
    factors: eigenpy.PartialPivLU
    rcond: float
    sign: float
    residual: float
    floor: float

    def solve(self, rate: Array) -> Array:
        """Velocities [o', w] of the moving bodies for a rate of the rows."""
        velocity: Array = self.factors.solve(rate)
        return velocity


def pose_at(mechanism: Mechanism, q: Array, poses: Poses, placed: Placed, target: Array) -> Pose:
    """Factorise the Jacobian at a configuration."""
    jacobian = mechanism.stack.jacobian(placed)
    factors = eigenpy.PartialPivLU(jacobian)
    rcond = factors.rcond()
    # Rounding of a few products of order 1 in each row, as the inverse of the Jacobian sees it.
    # Its columns have a norm of order 1, so 1 / rcond bounds the norm of the inverse.
    floor = 64 * EPS / rcond if rcond > 0 else np.inf
    return Pose(
        q, poses, placed, factors, rcond, math.copysign(1.0, factors.determinant()),
        float(np.abs(target - placed.values).max()), floor,
    )  # fmt: skip


@dataclass(frozen=True)
class Corrected:
    """Outcome of Newton's method: the pose or None, corrections spent, their largest size."""

    pose: Pose | None
    corrections: int
    largest: float


def correct(mechanism: Mechanism, q: Array, target: Array) -> Corrected:
    """Solve  rows(q) = target  near q.

    The first Jacobian serves every correction as long as each is a hundredth of the one before;
    it is renewed otherwise. With contraction c the error left after a correction s is at most
    s c / (1 - c); Newton stops when that is below eps, or when corrections no longer shrink and
    are as small as rounding explains. Anything else is a failure: `pose` is None.
    """
    current: Pose | None = None
    previous = np.inf
    largest = 0.0
    settled = False
    for count in range(1, MOST_CORRECTIONS + 1):
        poses = mechanism.poses(q)
        placed = mechanism.stack.place(*poses)
        if current is None or settled:
            current = pose_at(mechanism, q, poses, placed, target)
        step = current.solve(target - placed.values)
        size = float(np.abs(step).max())
        if not np.isfinite(size) or current.rcond < EPS:
            return Corrected(None, count, np.inf)
        if settled or size <= EPS:
            if size <= current.floor:
                fresh = current if current.q is q else pose_at(mechanism, q, poses, placed, target)
                return Corrected(fresh, count - 1, largest)
            settled = False
        contraction = size / previous
        if contraction > 0.5 and size > current.floor:
            return Corrected(None, count, np.inf)
        largest += size
        q = mechanism.moved(q, poses.rotation, step)
        if count == 1:
            # Nothing is known of the contraction yet; Newton squares the size of a correction.
            settled = False
            renew = size > GOOD_CONTRACTION
        else:
            settled = contraction > 0.5 or size * contraction < EPS * (1 - contraction)
            renew = contraction > GOOD_CONTRACTION
        if renew and not settled:
            current = None
        previous = size
    return Corrected(None, MOST_CORRECTIONS, np.inf)


def accelerations(mechanism: Mechanism, pose: Pose, rate: Array, second: Array) -> tuple[Array, Array]:
    """Velocities and accelerations [o', w], [o'', w'] of the moving bodies by the factors of a pose.

    J v = rate,  J a = second - drift(v):  one matrix serves both.
    """
    velocity = pose.solve(rate)
    moving = np.zeros((len(pose.poses.origin), 2, 3))
    moving[1:] = velocity.reshape(-1, 2, 3)
    drift = mechanism.stack.drift(pose.placed, moving[:, 0], moving[:, 1])
    return velocity, pose.solve(second - drift)
