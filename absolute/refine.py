"""Many configurations at once: Newton to rounding, then velocities and accelerations."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from absolute.backend import eigenpy
from absolute.mechanism import Mechanism
from absolute.newton import MOST_CORRECTIONS, rounding_of
from absolute.precision import EPS
from absolute.solution import Array, Counts
from absolute.tracking import SMALL, Found

# Instants per batch: enough to share the cost of a call, few enough to stay in fast memory.
BATCH = 64

# Corrections below this are rounding of the 30 or so unknowns themselves.
ROUNDING = 32 * EPS


class Refined(NamedTuple):
    """Exact poses of N instants in units of size, with their rates.

    Attributes:
        rotation: (N, bodies, 3, 3). origin: (N, bodies, 3).
        velocity, acceleration: (N, 6 * moving bodies) [o', w] and [o'', w'], empty without rates.
        corrections: (N,) Newton corrections in all.
        residual: (N,) largest violation of a row.
        step: (N,) the last correction, not made.
        closed: (N,) whether corrections became as small as rounding and the rows closed to rounding.
        kept: (N,) whether the pose is on the branch of the drawing.
        left: (N, 3, rows) what is left of the equations of the pose and its rates as computed, zero without
            rates.
        world: (N, features, 3) points and directions that tell it.
        sure: (N,) whether what was predicted was right: a small first correction, the determinant's sign.
        q: (N, configuration) of Pinocchio.
    """

    rotation: Array
    origin: Array
    velocity: Array
    acceleration: Array
    corrections: Counts
    residual: Array
    step: Array
    closed: NDArray[np.bool_]
    kept: NDArray[np.bool_]
    left: Array
    world: Array
    sure: NDArray[np.bool_]
    q: Array


def refine(mechanism: Mechanism, found: Found, targets: Array, rates: bool) -> Refined:
    """Newton with a fresh Jacobian each time until corrections and rows are rounding, for all together.

    The Jacobian of the last, negligible correction is that of the pose itself: its factors serve
    velocity and acceleration,  J v = rate,  J a = second - drift(v).

    Args:
        found: configurations close to their poses.
        targets: (3, N, rows) targets, their first and second rates.
        rates: False leaves velocity and acceleration empty.
    """
    stack = mechanism.stack
    q, corrections = found.q.copy(), found.corrections.copy()
    rotation, origin = mechanism.poses_of(q)
    placed = stack.place(rotation, origin)
    jacobian = stack.jacobian(placed)
    steps = solved_once(jacobian, targets[0] - placed.values)
    first = previous = lengths(steps)
    factors: list[eigenpy.PartialPivLU] = [None] * len(q)
    pending = np.arange(len(q))
    velocity = np.empty((len(q) if rates else 0, stack.count))
    for _ in range(MOST_CORRECTIONS):
        order = pending.tolist()
        q[pending] = mechanism.moved_all(q[pending], rotation[pending], steps)
        corrections[pending] += 1
        poses = mechanism.poses_of(q[pending])
        fresh = stack.place(*poses)
        renewed = stack.jacobian(fresh)
        if len(order) == len(q):
            (rotation, origin), placed, jacobian = poses, fresh, renewed
        else:
            rotation[pending], origin[pending], jacobian[pending] = *poses, renewed
            for whole, part in zip(placed, fresh, strict=True):
                whole[pending] = part
        for instant, each in zip(order, renewed, strict=True):
            factors[instant] = eigenpy.PartialPivLU(each)
        those, left = [factors[instant] for instant in order], targets[0, pending] - fresh.values
        if rates:
            # Both at once: with factors that small, calls cost more than numbers.
            both = solved(those, np.stack((left, targets[1, pending]), axis=-1))
            steps, velocity[pending] = both[..., 0], both[..., 1]
        else:
            steps = solved(those, left)
        size = lengths(steps)
        # Negated, so that what is not a number counts as more to do.
        more = ~(size <= ROUNDING)
        for place in np.flatnonzero(more & (size > 0.5 * previous[pending])).tolist():
            more[place] = not size[place] <= rounding_of(factors[order[place]].rcond())
        # Near a fold corrections become as small as rounding before the rows close.
        more |= ~stack.closed(fresh, targets[0, pending])
        if len(order) == len(q):
            previous = size
        else:
            previous[pending] = size
        pending, steps = pending[more], steps[more]
        if not pending.size:
            break
    closed = np.ones(len(q), dtype=np.bool_)
    closed[pending] = False
    acceleration = np.empty((0, stack.count))
    if rates:
        moving = np.zeros((*origin.shape[:2], 2, 3))
        moving[:, 1:] = velocity.reshape(len(q), -1, 2, 3)
        drift = stack.drift(placed, moving[:, :, 0], moving[:, :, 1])
        acceleration = solved(factors, targets[2] - drift)
    left = np.zeros((len(q), 3, stack.count))
    left[:, 0] = targets[0] - placed.values
    if rates:
        left[:, 1] = targets[1] - np.matvec(jacobian, velocity)
        left[:, 2] = targets[2] - drift - np.matvec(jacobian, acceleration)
    residual = np.abs(left[:, 0]).max(axis=1)
    kept = mechanism.branch_signs.kept(placed.world)
    sure = np.ones(len(q), dtype=np.bool_)
    for place in np.flatnonzero(found.predicted).tolist():
        sure[place] = first[place] <= SMALL and factors[place].determinant() * found.sign > 0
    return Refined(
        rotation,
        origin,
        velocity,
        acceleration,
        corrections,
        residual,
        previous,
        closed,
        kept,
        left,
        placed.world,
        sure,
        q,
    )


def lengths(steps: Array) -> Array:
    """(N,) of N steps."""
    return np.asarray(np.sqrt(np.vecdot(steps, steps)))


def solved(factors: list[eigenpy.PartialPivLU], right_hand: Array) -> Array:
    """Solutions (N, rows), or (N, rows, some), of N factorised systems for such right-hand sides."""
    return np.array([lu.solve(column) for lu, column in zip(factors, right_hand, strict=True)])


def solved_once(jacobian: Array, right_hand: Array) -> Array:
    """Solutions (N, rows) of N systems (N, rows, rows) whose factors serve nothing else."""
    try:
        solution = np.asarray(np.linalg.solve(jacobian, right_hand[..., None])[..., 0], dtype=float)
    except np.linalg.LinAlgError:  # one of them is singular to the last digit: not a number for that one
        return solved([eigenpy.PartialPivLU(each) for each in jacobian], right_hand)
    return solution
