r"""Paths of the known coordinates, followed from pose to pose so that no step can change branch.

Between two sets of known coordinates the path is straight, or a law leads from one to the other; what is not
yet assembled is taken back in proportion. It is followed in steps that are proven (see `proven_step`): about
the tangent of each there is exactly one assembly, and it is the continuation of the one that the step started
from. What a step takes up of the condition goes with its length, so one that is too long tells which is
proven, and the steps shrink on their own towards a pose where the path ends.

A place on the way is corrected only until Newton's method is proven to converge from it, which is one step as
a rule; what it is still off is taken along with the next tangent. Only the end is corrected to the tolerance.
Rounding is not counted here: within the root of EPS of a pose where two branches cross, it may hide that they
do.

One pose on its way takes longer steps, along a power series of the path (see `proven_path`); tangents lead
where no few of these are proven to reach the end, and tell where a path stops.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.branch import hidden, orientation, same_side, same_signs
from pointcoord.numerics.counters import Work
from pointcoord.numerics.linear import Factors, factorise
from pointcoord.numerics.newton import factors_at, newton_refine
from pointcoord.numerics.quadratic import QuadraticMap
from pointcoord.solve.place import Path
from pointcoord.solve.proven_path import proven_end
from pointcoord.solve.proven_step import SHARES, beside_the_way, straight_way

Array = NDArray[np.float64]
Law = Callable[[NDArray[np.intp], Array], Array]
"""Known coordinates of members, by number, at shares of their paths, both (m,): (m, size - unknowns)."""

# Part of a step that would just be proven, and how much longer the next one is at most.
SAFETY, LONGER = 0.8, 4.0
# Part of a step that is tried instead where it overflows, or where digits have run out at its end.
AGAIN = 0.1
# A path that advances less than this fraction in a step has met the end of what can be assembled: steps
# shrink in proportion to the distance to the end, which is then near 1e-12 of the path. The end is a fold,
# where two assemblies meet as the root of the distance: they are still 1e-6 of the path apart, and
# rounding, which grows as the inverse of that root, is near 1e-10.
SMALLEST_STEP = 1e-13
# Steps tried for a path, or for each part of it that is as long as a step may be.
STEPS = 2000
# How far the end of a step that is not proven may be beside its tangent, in parts of it. What bends is in
# proportion to the step: an end so near the tangent is far from where the step would double back.
BESIDE = 0.25


def follow(
    system: QuadraticMap,
    y: Array,
    target: Array | Law,
    factors: Factors | None = None,
    tolerance: float = 0.0,
    steps: int = STEPS,
    longest: float = 1.0,
) -> Path:
    """Carry poses along paths of their known coordinates.

    Args:
        y: start, shape (..., size); what its residual is not zero by is taken back along the path.
        target: known coordinates at the end of a straight path, shape (..., size - unknowns), or a law.
        factors: factorisation of C_u at y, if it is at hand.
        tolerance: how far the end may be from the exact assembly, rounding apart, in units.
        steps: tried at most for each share `longest` of the path.
        longest: share of the path in one step, so short that SHARES of it show what a law does.
    Returns:
        Poses at the ends of their paths, or where these stop.
    """
    n = system.unknowns
    batch = y.shape[:-1] if callable(target) else np.broadcast_shapes(y.shape[:-1], target.shape[:-1])
    y = np.broadcast_to(y, (*batch, y.shape[-1])).reshape(-1, y.shape[-1]).copy()
    if callable(target):
        law, still, shares = target, np.zeros(len(y), dtype=bool), np.append(SHARES, 1.0)
    else:
        goals = np.broadcast_to(target, (*batch, target.shape[-1])).reshape(len(y), -1)
        law, still, shares = _straight(y[:, n:].copy(), goals), (goals == y[:, n:]).all(axis=-1), np.ones(1)
    offset = system.residual(y)
    done, step, rest = np.zeros(len(y)), np.full(len(y), min(longest, 1.0)), np.zeros(len(y))
    iterations, work = np.zeros(len(y), dtype=np.int64), Work(residuals=len(y))
    if factors is None or factors.condition.shape != batch:
        factors = factorise(system.jacobian(y))
        work += Work(factorisations=len(y))
    factors = factors.reshaped((len(y),))
    side = orientation(system, factors)
    active = np.flatnonzero(~factors.singular & (still | ~hidden(system, y, factors)))
    for _ in range(int(steps / min(longest, 1.0))):
        if not active.size:
            break
        here, begun, inverse = y[active], done[active], factors.taken(active).preconditioner
        end = np.minimum(begun + step[active], 1.0)
        places = np.where(shares == 1.0, end[:, None], begun[:, None] + (end - begun)[:, None] * shares)
        known = law(np.repeat(active, len(shares)), places.ravel()).reshape(*places.shape, -1)
        left_open = (1.0 - np.stack([begun, end]))[..., None] * offset[active]
        with np.errstate(all="ignore"):
            beside = None if len(shares) == 1 else beside_the_way(here[:, n:], known[:, :-1], known[:, -1])
            way = straight_way(system, inverse, here, known[:, -1], beside, left_open)
            proof = way.best_proof(system, inverse)
            able = np.flatnonzero(proof.holds)
            length = np.minimum(SAFETY / proof.used, LONGER) * (end - begun)
            # Of a step so long that it overflows nothing is known.
            shorter = np.where(np.isnan(length), AGAIN, SAFETY) * (end - begun)
        step[active] = np.fmin(length, shorter)
        if able.size:
            guess = (here + way.tangent)[able]
            guess[:, n:] = known[able, -1]
            # On the way it is enough to be where Newton's method is proven to converge.
            allowed = np.where(end[able] == 1.0, tolerance, np.inf)
            reached = newton_refine(system, guess, left_open[1, able], allowed)
            # In exact arithmetic every correction converges and no path crosses a fold, where the determinant
            # changes its sign. One that does has run out of digits: a drawing on a fold, to within rounding.
            there, factorised = factors_at(system, reached)
            work += reached.work + factorised
            apart = np.abs(reached.y - guess)[:, :n]
            good = reached.converged & proof.taken(able).within(apart)
            good &= same_side(system, reached.y, there, side[active[able]], end[able] == 1.0)
            kept, chosen = active[able[good]], np.flatnonzero(good)
            y[kept], done[kept], rest[kept] = reached.y[chosen], end[able[chosen]], reached.left[chosen]
            iterations[kept] = reached.iterations[chosen]
            factors = factors.replaced(kept, there.taken(chosen))
            step[active[able[~good]]] *= AGAIN
            step[kept] = np.minimum(length[able[chosen]], longest)
        # A step that completes a path may be as short as it likes.
        active = active[
            (done[active] < 1.0) & (step[active] >= np.minimum(SMALLEST_STEP, 1.0 - done[active]))
        ]
    stopped = np.flatnonzero((done < 1.0) & (rest > 0.0))
    if stopped.size:
        # Where a path ends is told as exactly as an assembly is.
        ends = newton_refine(system, y[stopped], offset[stopped] * (1.0 - done[stopped])[:, None])
        there, factorised = factors_at(system, ends)
        work += ends.work + factorised
        good = ends.converged & same_side(system, ends.y, there, side[stopped], True)
        stopped = stopped[good]
        y[stopped], rest[stopped] = ends.y[good], 0.0
        factors = factors.replaced(stopped, there.taken(np.flatnonzero(good)))
    return Path(y, factors, rest, work, iterations, done).reshaped(batch)


def _straight(start: Array, goals: Array) -> Law:
    """The straight paths between known coordinates, each (members, size - unknowns)."""
    change = goals - start

    def law(members: NDArray[np.intp], shares: Array) -> Array:
        share = shares[:, None]
        return np.where(share == 1.0, goals[members], start[members] + change[members] * share)

    return law


def led(
    system: QuadraticMap, y: Array, target: Array, factors: Factors | None = None, tolerance: float = 0.0
) -> Path:
    """What `follow` gives; one pose goes along a few series where these prove the whole path.

    Args, result: as of `follow`.
    """
    if y.ndim == 1 and target.ndim == 1:
        first = factorise(system.jacobian(y)) if factors is None else factors
        end = proven_end(system, y, target, first, tolerance)
        if end is not None:
            return end if factors is not None else replace(end, work=end.work + Work(factorisations=1))
    return follow(system, y, target, factors, tolerance)


def stepped(system: QuadraticMap, y: Array, target: Array) -> Array | None:
    """The pose at other known coordinates, if Newton's method finds it close to the tangent; None if not.

    It is on the same side of a fold, and nothing else of it is proven: for telling what stops a motion, where
    a motion itself goes along proven steps.

    Args:
        y: an assembled pose, shape (size,). target: known coordinates.
    """
    factors = factorise(system.jacobian(y))
    if factors.singular:
        return None
    with np.errstate(all="ignore"):
        tangent = straight_way(system, factors.preconditioner, y, target).tangent
        guess = y + tangent
        guess[system.unknowns :] = target
        reached = newton_refine(system, guess)
        there = factorise(system.jacobian(reached.y))
        beside = np.abs(reached.y - guess).max() <= BESIDE * np.abs(tangent).max()
    kept = same_signs(orientation(system, there), orientation(system, factors))
    return reached.y if bool(beside and reached.converged) and kept else None
