r"""Paths of the known coordinates, followed from pose to pose so that no step can change branch.

Between two sets of known coordinates the path is straight, or a law leads from one to the other; what is not
yet assembled is taken back in proportion. From each place a power series of the path is expanded, and
followed as far as is proven (see `proven_step`): near it there is exactly one assembly, and it is the
continuation of the one that the step started from. So the steps shrink on their own towards a pose where the
path ends.

A place on the way is corrected only until Newton's method is proven to converge from it, which is one step as
a rule; what it is still off is taken back along the rest of the path. Only the end is corrected to the
tolerance. Rounding is not counted here: within the root of EPS of a pose where two branches cross, it may
hide that they do. Nor is what cutting the series of a law leaves out, a turn's: of a step of h rad d =
h^(p + 1) / (p + 1)!, so that where branches cross the assemblies along the cut law come within a root of d
of both. A step that led past there would have to be no longer than that, and d goes with a higher power of
it than the square.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.counters import Work
from pointcoord.numerics.few_entries import LARGE
from pointcoord.numerics.linear import Factors, factorise
from pointcoord.numerics.newton import factors_at, newton_refine
from pointcoord.numerics.power_series import expand
from pointcoord.numerics.quadratic import QuadraticMap
from pointcoord.solve.place import Path
from pointcoord.solve.proven_step import hidden, orientation, prove, same_side

Array = NDArray[np.float64]
Law = Callable[[NDArray[np.intp], Array, int], Array]
"""Series of the known coordinates of members, by number, about shares of their paths, both (m,), in the share
and up to an order: (m, order + 1, size - unknowns)."""

# Order of a series; of a large map, where every order is one more product of large matrices.
ORDER, OF_LARGE = 8, 3
# A path that advances less than this fraction in a step has met the end of what can be assembled: steps
# shrink in proportion to the distance to the end, which is then near 1e-12 of the path. The end is a fold,
# where two assemblies meet as the root of the distance: they are still 1e-6 of the path apart, and
# rounding, which grows as the inverse of that root, is near 1e-10.
SMALLEST_STEP = 1e-13
# Part of a step that is tried instead where digits have run out at its end.
AGAIN = 0.1
# Steps tried for a path, or for each part of it that is as long as a step may be.
STEPS = 2000


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
        longest: share of the path in one step.
    Returns:
        Poses at the ends of their paths, or where these stop.
    """
    n, highest = system.unknowns, ORDER if len(system.rows) < LARGE else OF_LARGE
    batch = y.shape[:-1] if callable(target) else np.broadcast_shapes(y.shape[:-1], target.shape[:-1])
    y = np.broadcast_to(y, (*batch, y.shape[-1])).reshape(-1, y.shape[-1]).copy()
    if callable(target):
        law, still = target, np.zeros(len(y), dtype=bool)
    else:
        goals = np.broadcast_to(target, (*batch, target.shape[-1])).reshape(len(y), -1)
        law, still = _straight(y[:, n:].copy(), goals), (goals == y[:, n:]).all(axis=-1)
    offset = system.residual(y)
    done, most, rest = np.zeros(len(y)), np.full(len(y), min(longest, 1.0)), np.zeros(len(y))
    iterations, work = np.zeros(len(y), dtype=np.int64), Work(residuals=len(y))
    if factors is None or factors.condition.shape != batch:
        factors = factorise(system.jacobian(y))
        work += Work(factorisations=len(y))
    factors = factors.reshaped((len(y),))
    side = orientation(system, factors)
    active = np.flatnonzero(~factors.singular & (still | ~hidden(system, y, factors)))
    for tried in range(int(steps / min(longest, 1.0))):
        if not active.size:
            break
        # What only has to be put together is so, as a rule, by one step of Newton's method.
        order = 1 if tried == 0 and still.all() else highest
        begun, local = done[active], factors.taken(active)
        left = 1.0 - begun
        with np.errstate(all="ignore"):
            # In shares of what is left of the path.
            known = law(active, begun, order) * left[:, None, None] ** np.arange(order + 1.0)[:, None]
            series = expand(system, local, y[active], known, system.residual(y[active]))
            proof = prove(system, local.preconditioner, series)
            length = np.minimum(proof.length, most[active] / left)
        # A step that completes a path may be as short as it likes.
        able = np.flatnonzero((length >= 1.0) | (length * left >= SMALLEST_STEP))
        if not able.size:
            break
        active, series, length, proof = active[able], series[able], length[able], proof.taken(able)
        end = np.where(length >= 1.0, 1.0, begun[able] + length * left[able])
        guess = (length[:, None, None] ** np.arange(order + 1.0) @ series)[:, 0]
        guess[:, n:] = law(active, end, 0)[:, 0]
        # On the way it is enough to be where Newton's method is proven to converge.
        allowed = np.where(end == 1.0, tolerance, np.inf)
        reached = newton_refine(system, guess, (1.0 - end)[:, None] * offset[active], allowed)
        # In exact arithmetic every correction converges and no path crosses a fold, where the determinant
        # changes its sign. One that does has run out of digits: a drawing on a fold, to within rounding.
        there, factorised = factors_at(system, reached)
        work += reached.work + factorised
        good = reached.converged & proof.within(np.abs(reached.y - guess)[:, :n])
        good &= same_side(system, reached.y, there, side[active], end == 1.0)
        kept, chosen = active[good], np.flatnonzero(good)
        y[kept], done[kept], rest[kept] = reached.y[good], end[good], reached.left[good]
        iterations[kept] = reached.iterations[good]
        factors = factors.replaced(kept, there.taken(chosen))
        most[active] = np.where(good, longest, AGAIN * length * left[able])
        active = active[
            (done[active] < 1.0) & (most[active] >= np.minimum(SMALLEST_STEP, 1.0 - done[active]))
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

    def law(members: NDArray[np.intp], shares: Array, order: int) -> Array:
        known = np.zeros((len(members), order + 1, goals.shape[-1]))
        share = shares[:, None]
        known[:, 0] = np.where(share == 1.0, goals[members], start[members] + change[members] * share)
        known[:, 1:2] = change[members][:, None]
        return known

    return law
