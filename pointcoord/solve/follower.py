r"""Follows paths of the known coordinates from pose to pose so that no step can change branch.

Between two sets of known coordinates the path is straight or given by a law. A residual of the starting pose
is reduced to zero in proportion along the path. From each pose a power series of the path is expanded and
followed as far as proven (see `proven_step`): near the series there is exactly one assembly, the continuation
of the assembly at the start of the step. So the steps become shorter by themselves towards a pose where the
path ends.

A pose on the way is corrected only until Newton's method is proven to converge from there, as a rule by one
step. Its residual is reduced along the rest of the path. Only the end is corrected to the tolerance.

Two errors are left out. Rounding: within the root of EPS of a pose where two branches cross, rounding may
hide the crossing. Truncation of a law, that of a rotation: for a step of h rad at order p the error is
d = h^(p + 1) / (p + 1)!. Where branches cross, the assemblies along the truncated law come within a root of d
of both branches. A step past the crossing would have to be no longer than that root, but d is in proportion
to a power of h above the square.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from pointcoord.numerics.arrays import Array, Indices
from pointcoord.numerics.counters import Work
from pointcoord.numerics.few_entries import LARGE
from pointcoord.numerics.linear import Factors, factorise
from pointcoord.numerics.newton import factors_at, newton_refine
from pointcoord.numerics.power_series import expand
from pointcoord.numerics.quadratic import QuadraticMap
from pointcoord.solve.path import Path
from pointcoord.solve.proven_step import hidden, orientation, prove_segment, same_side
from pointcoord.solve.step_rule import convergence_radius, log_sizes

Law = Callable[[Indices, Array, int], Array]
"""A path of the known coordinates: law(members, shares, order) expands the known coordinates of some members,
by number, about shares of their paths, both (m,), as series in the share, (m, order + 1, size - unknowns)."""

# Order of a series; and for a large map, where every order costs one more product of large matrices.
ORDER, OF_LARGE = 16, 3
# Length of a step that is tried first, as a share of the radius of convergence, and factor by which it is
# shortened until it is proven. Of orders from 8 to 20, shares from 0.6 to 0.8 and factors from 0.5 to 0.8
# these take the fewest trials, or nearly so, on 360 paths of nine mechanisms.
REACH, SHORTER = 0.7, 0.7
# A path whose step is shorter than this share of the path has met the end of what can be assembled: steps
# shrink in proportion to the distance to the end, which is then near 1e-12 of the path. The end is a fold,
# where the distance of two assemblies falls as the root of the distance to the fold: they are still 1e-6 of
# the path apart, and rounding, which grows as the inverse of that root, is near 1e-10.
SMALLEST_STEP = 1e-13
# Factor by which a step is shortened where digits have run out at its end.
AGAIN = 0.1
# Most steps for a path, or for each part of the path that is as long as the longest allowed step.
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
    """Move poses along paths of their known coordinates.

    Args:
        y: start, shape (..., size); a residual of the start is reduced to zero along the path.
        target: known coordinates at the end of a straight path, shape (..., size - unknowns), or a law.
        factors: factorisation of C_u at y, if available.
        tolerance: allowed distance of the end to the exact assembly, without rounding, in units.
        steps: most steps for each share `longest` of the path.
        longest: largest share of the path in one step.
    Returns:
        Poses at the ends of their paths, or where the paths stop.
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
    alive = ~factors.singular & (still | ~hidden(system, y, factors))
    for tried in range(int(steps / min(longest, 1.0))):
        active = np.flatnonzero(alive & (done < 1.0) & (most >= np.minimum(SMALLEST_STEP, 1.0 - done)))
        if not active.size:
            break
        # Where no known coordinate moves, one step of Newton's method assembles the pose as a rule.
        order = 1 if tried == 0 and still.all() else highest
        begun, local = done[active], factors.taken(active)
        left = 1.0 - begun
        with np.errstate(all="ignore"):
            # Series in the share of the remaining path.
            known = law(active, begun, order) * left[:, None, None] ** np.arange(order + 1.0)[:, None]
            series = expand(system, local, y[active], known, system.residual(y[active]))
            length = np.minimum(most[active] / left, 1.0)
            if order > 1:
                length = np.minimum(length, REACH * convergence_radius(log_sizes(series[..., :n])))
            proof = prove_segment(system, series, length, parts=(1,))
        # A step that completes a path may be as short as it likes.
        alive[active] = (length >= 1.0) | (length * left >= SMALLEST_STEP)
        most[active] = SHORTER * length * left
        able = np.flatnonzero(proof.holds & alive[active])
        if not able.size:
            continue
        active, series, proof = active[able], series[able], proof.taken(able)
        begun, left, length = begun[able], left[able], length[able]
        end = np.where(length >= 1.0, 1.0, begun + length * left)
        guess = (length[:, None, None] ** np.arange(order + 1.0) @ series)[:, 0]
        guess[:, n:] = law(active, end, 0)[:, 0]
        # On the way any pose will do from which Newton's method is proven to converge.
        allowed = np.where(end == 1.0, tolerance, np.inf)
        reached = newton_refine(system, guess, (1.0 - end)[:, None] * offset[active], allowed)
        # In exact arithmetic every correction converges and no path crosses a fold, where the determinant
        # changes its sign. A path that does has run out of digits, like one from a drawing on a fold.
        there, factorised = factors_at(system, reached)
        work += reached.work + factorised
        good = reached.converged & proof.within(np.abs(reached.y - guess)[:, :n])
        good &= same_side(system, reached.y, there, side[active], end == 1.0)
        kept, chosen = active[good], np.flatnonzero(good)
        y[kept], done[kept], rest[kept] = reached.y[good], end[good], reached.left[good]
        iterations[kept] = reached.iterations[good]
        factors = factors.replaced(kept, there.taken(chosen))
        most[active] = np.where(good, longest, AGAIN * length * left)
    stopped = np.flatnonzero((done < 1.0) & (rest > 0.0))
    if stopped.size:
        # A pose where a path stops is corrected as exactly as an assembled pose.
        ends = newton_refine(system, y[stopped], offset[stopped] * (1.0 - done[stopped])[:, None])
        there, factorised = factors_at(system, ends)
        work += ends.work + factorised
        good = ends.converged & same_side(system, ends.y, there, side[stopped], True)
        stopped = stopped[good]
        y[stopped], rest[stopped] = ends.y[good], 0.0
        factors = factors.replaced(stopped, there.taken(np.flatnonzero(good)))
    return Path(y, factors, rest, work, iterations, done).reshaped(batch)


def _straight(start: Array, goals: Array) -> Law:
    """The law of straight paths between known coordinates, start and goals (members, size - unknowns)."""
    change = goals - start

    def law(members: Indices, shares: Array, order: int) -> Array:
        known = np.zeros((len(members), order + 1, goals.shape[-1]))
        share = shares[:, None]
        known[:, 0] = np.where(share == 1.0, goals[members], start[members] + change[members] * share)
        known[:, 1:2] = change[members][:, None]
        return known

    return law
