"""Newton's method on the poses of the bodies, to rounding, and their rates, for many configurations."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from absolute.mechanism import Choice, Mechanism
from absolute.rows import ROUNDINGS, Placed
from absolute.vectors import EPS, Array, Counts

# Below this reciprocal condition number a fold of the motion is nearer than sqrt(eps): its two branches
# cannot be told apart, and half of the digits are lost.
SMALLEST_RCOND = float(np.sqrt(EPS))

# Quadratic convergence from a correction of 0.1 needs about 6 corrections; 25 means a stall.
MOST_CORRECTIONS = 25


class Configurations(NamedTuple):
    """N configurations of the bodies, with their rows.

    Attributes:
        choice: choice of the rows that are solved.
        placed: all rows, evaluated.
        q: (N, size of Pinocchio's configuration).
        jacobian: (N, rows, unknowns). inverse: (N, unknowns, unknowns) of the kept rows; NaN where there is
            none.
        condition: (N,) condition numbers of the kept rows (1-norm).
        signs: (N, groups) signs of the groups' determinants; they change only through a singular pose.
        residual: (N,) largest violation of a row.
        closed: (N,) whether the next correction and the kept rows' violations are as small as rounding.
        held: (N,) whether the rows left out are satisfied.
        corrections: (N,) Newton corrections used.
    """

    choice: Choice
    placed: Placed
    q: Array
    jacobian: Array
    inverse: Array
    condition: Array
    signs: Array
    residual: Array
    closed: NDArray[np.bool_]
    held: NDArray[np.bool_]
    corrections: Counts

    def part(self, of: slice) -> "Configurations":
        """A slice of the configurations."""
        placed = Placed(*(array[of] for array in self.placed))
        return Configurations._make((self.choice, placed, *(array[of] for array in self[2:])))

    @property
    def kept(self) -> Array:
        """(N, unknowns, unknowns) Jacobians of the rows kept."""
        return self.jacobian[:, self.choice.kept]


def rounding_of(condition: Array) -> Array:
    """The largest correction that rounding can cause.

    The inverse of the Jacobian magnifies the rounding of a few products of order 1 in each row. Columns have
    norms of order 1, so the condition number bounds the norm of the inverse.
    """
    return 64 * EPS * condition


def configurations_at(
    mechanism: Mechanism, choice: Choice, q: Array, target: Array, corrections: Counts | None = None
) -> Configurations:
    """Evaluate configurations (N, nq) with their rows, against targets (N, rows)."""
    stack, kept, left_out = mechanism.stack, choice.kept, choice.left_out
    placed = stack.place(*mechanism.poses(q))
    jacobian = stack.jacobian(placed)
    square = jacobian[:, kept]
    inverse = solved(square, np.broadcast_to(np.eye(stack.unknowns), square.shape))
    # Sums over columns as matrix products, which are quicker.
    condition, other = ((np.ones(stack.unknowns) @ np.abs(of)).max(axis=1) for of in (square, inverse))
    condition *= other
    condition[np.isnan(condition)] = np.inf
    gap = stack.gap(placed, target)
    small = lengths(np.matvec(inverse, gap[:, kept])) <= rounding_of(condition)
    off, rounding = np.abs(gap), stack.rounding(placed)
    allowed = rounding[:, left_out] * more_than_rounding(inverse)[:, None]
    return Configurations(
        choice,
        placed,
        q,
        jacobian,
        inverse,
        condition,
        signs_of(choice, jacobian),
        off.max(axis=1),
        small & (off[:, kept] <= rounding[:, kept]).all(axis=1),
        np.asarray((off[:, left_out] <= allowed).all(axis=1)),
        np.zeros(len(q), dtype=np.int64) if corrections is None else corrections,
    )


def signs_of(choice: Choice, jacobian: Array) -> Array:
    """(..., groups) signs of the determinants of the groups, from Jacobians (..., rows, unknowns)."""
    square = jacobian[..., choice.kept, :]
    blocks = (square[..., rows[:, None], columns] for rows, columns in choice.groups)
    return np.stack([np.sign(np.linalg.det(block)) for block in blocks], axis=-1)


def newton(
    mechanism: Mechanism, near: Configurations, q: Array, target: Array, largest: Array
) -> Configurations:
    """Solve rows(q) = target near N configurations, up to the first with too large a first correction.

    After a correction s about k s^2 is left: k = s / before^2 with the correction before, and at most the
    condition number for the first one, as rows are quadratic with second derivatives of order 1. Newton's
    method stops when this is no more than the rounding of a row, or when corrections no longer shrink. Then
    the next correction must be as small as rounding, and the rows closed to rounding. A small correction
    alone proves nothing near a fold: it falls as the root of the residual, also just beyond the fold, where
    there is no pose.

    Args:
        near: a configuration nearby, for its condition number and its choice of rows.
        q: (N, nq). target: (N, rows). largest: (N,) largest allowed first correction.
    """
    stack, kept, condition = mechanism.stack, near.choice.kept, near.condition[0]
    q, corrections = q.copy(), np.zeros(len(q), dtype=np.int64)
    more, few = np.arange(len(q)), 0
    previous: Array | float = np.inf
    for count in range(MOST_CORRECTIONS):
        rotation, origin = mechanism.poses(q[more])
        placed = stack.place(rotation, origin)
        gap = stack.gap(placed, target[more])[:, kept]
        step = solved(stack.jacobian(placed)[:, kept], gap[..., None])[..., 0]
        size = lengths(step)
        if count == 0:
            few = leading(size <= largest)
            if not few:
                return near.part(slice(0))
            more, rotation, step, size = more[:few], rotation[:few], step[:few], size[:few]
        q[more] = mechanism.moved(q[more], rotation, mechanism.spread(step))
        corrections[more] += 1
        # Comparisons with NaN are false: it is not corrected any more.
        left = np.minimum(condition, size / previous**2 if count else np.inf) * size**2
        again = (left > ROUNDINGS) & (size <= 0.5 * previous)
        more, previous = more[again], size[again]
        if not more.size:
            break
    return configurations_at(mechanism, near.choice, q[:few], target[:few], corrections[:few])


def leading(right: NDArray[np.bool_]) -> int:
    """Number of leading entries that are true."""
    return len(right) if right.all() else int(right.argmin())


def lengths(steps: Array) -> Array:
    """(N,) norms of N steps, over all their numbers together."""
    flat = steps.reshape(len(steps), math.prod(steps.shape[1:]))
    return np.asarray(np.sqrt(np.vecdot(flat, flat)))


def solved(matrices: Array, right_hand: Array) -> Array:
    """Solutions (N, n, k) of N systems with k right-hand sides each; NaN where a system is singular."""
    try:
        return np.asarray(np.linalg.solve(matrices, right_hand))
    except np.linalg.LinAlgError:  # one of them is singular to the last digit
        if len(matrices) == 1:
            return np.full(right_hand.shape, np.nan)
        each = zip(matrices, right_hand, strict=True)
        return np.concatenate([solved(matrix[None], side[None]) for matrix, side in each])


def rates(mechanism: Mechanism, at: Configurations, *sides: Array) -> list[Array]:
    """Velocities [o', w], accelerations [o'', w'] and higher rates of the bodies, (N, bodies, 2, 3) each.

    J v = first,  J a = second - drift(v),  and so on, with one matrix.

    Args:
        at: N configurations, or one. sides: (N, rows) rates of the rows, the first, the second and so on.
    """
    found = [mechanism.spread(velocities(at, sides[0]))]
    for side in sides[1:]:
        found.append(mechanism.spread(velocities(at, side - mechanism.stack.drift(at.placed, found))))
    return found


def velocities(at: Configurations, rates: Array) -> Array:
    """v with J v = rates, (N, rows), corrected once by its residual: as accurate as by factors (Higham, ch.
    12).
    """
    rates = rates[:, at.choice.kept]
    found: Array = np.matvec(at.inverse, rates)
    return np.asarray(found + np.matvec(at.inverse, rates - np.matvec(at.kept, found)))


def more_than_rounding(inverse: Array) -> Array:
    """(N,) factor by which a left-out row may exceed its rounding if the other rows are closed.

    The error of such a configuration is the norm of the inverse times the rounding of its rows, and a row
    changes by no more than a few times that.
    """
    return np.asarray(1.0 + np.sqrt(inverse.shape[-1]) * lengths(inverse))
