"""Many configurations at once: Newton to rounding, then velocities and accelerations."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from absolute.backend import eigenpy
from absolute.groups import SERVES, Groups, inverses, magnitude, times
from absolute.mechanism import Mechanism
from absolute.newton import MOST_CORRECTIONS, held_to, rounding_of
from absolute.precision import EPS
from absolute.solution import Array, Counts
from absolute.tracking import Found

# Instants per batch: enough to share the cost of a call, few enough to stay in fast memory.
BATCH = 64

# Corrections below this are rounding of the 30 or so unknowns themselves.
ROUNDING = 2 * EPS

# A solution whose last correction is this share of it is left with SERVES of that: rounding.
SETTLED = EPS / SERVES
# Roundings of eps in the rate of a row, of its pose and its velocities, each as in its value (see `stack`).
LEFT_OUT = 3 * 4 * EPS
# From an error of SERVES to rounding takes four; what takes more than eight is all but singular.
MOST_REFINEMENTS = 8


class Refined(NamedTuple):
    """Exact poses of N instants in units of size, with their rates.

    Attributes:
        rotation: (N, bodies, 3, 3). origin: (N, bodies, 3).
        velocity, acceleration: (N, 6 * moving bodies) [o', w] and [o'', w'], empty without rates.
        corrections: (N,) Newton corrections in all.
        residual: (N,) largest violation of a row, or of the rate of one that was left out at unit speed.
        step: (N,) the last correction, not made.
        closed: (N,) whether corrections became as small as rounding and the rows closed to rounding.
        kept: (N,) whether the pose is on the branch of the drawing: signs of its groups and its joints.
        held: (N,) whether the rows that were left out hold.
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
    held: NDArray[np.bool_]


def refine(mechanism: Mechanism, found: Found, targets: Array, rates: bool) -> Refined:
    """Newton until corrections and rows are rounding, for all together.

    The inverses of the Jacobians serve on as long as the pose moves so little that each further correction
    is some SERVES of the one before; rates are solved with the Jacobian of the pose itself,
        J v = rate,    J a = second - drift(v).

    Args:
        found: configurations close to their poses.
        targets: (3, N, rows) targets, their first and second rates.
        rates: False leaves velocity and acceleration empty.
    """
    stack = mechanism.stack
    q, corrections = found.q, found.corrections.copy()
    rotation, origin = mechanism.poses(q)
    placed = stack.place(rotation, origin)
    jacobian = stack.jacobian(placed)
    groups = mechanism.groups
    inverse, signs = inverses(groups, jacobian)
    steps = solved(groups, jacobian, inverse, stack.gap(placed, targets[0]))
    previous = lengths(steps)
    # How far a pose may move so that its inverse is off by no more than SERVES.
    reach = SERVES / magnitude(inverse)
    more = np.ones(len(q), dtype=np.bool_)
    for _ in range(MOST_CORRECTIONS):
        steps[~more] = 0.0
        q = mechanism.moved(q, rotation, steps)
        corrections += more
        rotation, origin = mechanism.poses(q)
        placed = stack.place(rotation, origin)
        jacobian = stack.jacobian(placed)
        # Negated, so that what is not a number is stale.
        stale = np.flatnonzero(~(previous <= reach))
        if stale.size:
            inverse[stale], signs[stale] = inverses(groups, jacobian[stale])
            reach[stale] = SERVES / magnitude(inverse[stale])
        steps = times(groups, inverse, stack.gap(placed, targets[0]))
        size = lengths(steps)
        # Negated, so that what is not a number counts as more to do.
        more = ~(size <= ROUNDING)
        for place in np.flatnonzero(more & (size > 0.5 * previous)).tolist():
            more[place] = not size[place] <= rounding_of(eigenpy.PartialPivLU(jacobian[place]).rcond())
        # Near a fold corrections become as small as rounding before the rows close.
        more |= ~stack.closed(placed, targets[0])
        previous = size
        if not more.any():
            break
    closed = ~more
    velocity = acceleration = np.empty((0, stack.count))
    if rates:
        velocity = solved(groups, jacobian, inverse, targets[1])
        moving = np.zeros((*origin.shape[:2], 2, 3))
        moving[:, 1:] = velocity.reshape(len(q), -1, 2, 3)
        drift = stack.drift(placed, moving)
        acceleration = solved(groups, jacobian, inverse, targets[2] - drift)
    residual = np.abs(stack.gap(placed, targets[0])).max(axis=1)
    # Those of the inverses were found a correction before.
    changed = np.flatnonzero((signs != found.signs).any(axis=1))
    if changed.size:
        signs[changed] = mechanism.signs(jacobian[changed])
    kept = stack.kept(placed) & np.asarray((signs == found.signs).all(axis=1))
    held: NDArray[np.bool_] = np.ones(len(q), dtype=np.bool_)
    left_out = mechanism.redundant
    if left_out is not None:
        again, strength = left_out.place(rotation, origin), magnitude(inverse)
        held = np.asarray(held_to(left_out, again, stack.count, strength).all(axis=1))
        residual = np.maximum(residual, np.abs(left_out.gap(again, left_out.drawn)).max(axis=1))
        if rates:
            # A row that follows from the others has no rate, but for what the pose is off.
            rate = np.abs(np.matvec(left_out.jacobian(again), velocity)).max(axis=1)
            speed = lengths(velocity)
            held &= rate <= LEFT_OUT * (1.0 + np.sqrt(stack.count) * strength) * speed
            missed = np.divide(rate, speed, out=np.zeros_like(rate), where=speed > 0.0)
            residual = np.maximum(residual, missed)
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
        held,
    )


def lengths(steps: Array) -> Array:
    """(N,) of N steps."""
    return np.asarray(np.sqrt(np.vecdot(steps, steps)))


def solved(groups: Groups, jacobian: Array, inverse: Array, right_hand: Array) -> Array:
    """Solutions (N, rows) of N systems by inverses that are off by some SERVES.

    Each is corrected by what is left of its equation, which leaves SERVES of its error, until a further
    correction would be rounding: so it is as good as by factors of the matrix itself (Higham, ch. 12).
    """
    solution = times(groups, inverse, right_hand)
    for _ in range(MOST_REFINEMENTS):
        change = times(groups, inverse, right_hand - np.matvec(jacobian, solution))
        solution += change
        # What is not a number is never corrected. Squares of what is one may be none.
        largest, whole = (np.abs(part).max(axis=1) for part in (change, solution))
        if not (largest > SETTLED * whole).any():
            break
    return solution
