r"""The algorithm of the paper: Newton's method at every instant, then two linear solves.

    C(u, w) = 0,    C_u u' = -C_w w',    C_u u'' = -C_w w'' - 2 B(y', y')      (eqs. 1, 19, 22)

Each pose is proven to continue the pose of the instant before. There is no loop over instants. From a pose y0
with X = C_u(y0)^-1 the poses of many instants ahead are estimated by a few terms of the series along the
straight path to their inputs (see `power_series`). All of them are corrected at once by Newton's method or,
with `chord`, with one X kept as long as it converges fast enough,

    u <- u - X C(u, w).

Then each pose is proven to continue the pose before along a straight path, by the first terms of its series
(see `proven_step`). Where that fails, the path is followed in shorter proven steps. Where an angle changes by
more than a radian, all inputs change in proportion along such a path. With `cold` each instant is reached
from the drawing instead. In either case the rates are solved for many instants at once. The series are
measured against this solver.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from math import comb, factorial

import numpy as np

from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.arrays import Array, Flags
from pointcoord.numerics.counters import Work
from pointcoord.numerics.kantorovich import smallest_radius
from pointcoord.numerics.linear import Factors, factorise
from pointcoord.numerics.newton import implicit_rate, newton_refine
from pointcoord.numerics.power_series import expand
from pointcoord.numerics.quadratic import QuadraticMap
from pointcoord.numerics.rounding import EPS
from pointcoord.solve.assembly import LONGEST, Pose, blocked, by_inputs, close_drawing, driven_to
from pointcoord.solve.follower import follow
from pointcoord.solve.proven_step import hidden, prove_box
from pointcoord.solve.status import COMPLETE, Status
from pointcoord.time_functions import TimeFunction

SquareVelocityTerm = Callable[[QuadraticMap, Array], Array]
Values = Mapping[str, Array]
"""Value of every input at all instants, each (N,)."""
Reached = tuple[Array, Array, Work, Status]
"""The solved poses, the proven distance of each to the exact one, the work, and what stopped the solver."""

# Instants that are solved at once: their matrices take 1 MB, which fits into a processor's cache. With 4,096
# at once 40,000 instants take 1.5 times as long; with 64 no less than with 512.
BLOCK = 512
# Instants ahead that are tried first; the number doubles whenever all of them were proven.
FIRST_AHEAD = 8
# Terms of the series that estimates the poses ahead: with more terms Newton's method saves no step.
TERMS = 3
# Where n eps cond(C_u) is larger, poses ahead are not estimated, because rounding may be too large.
ROUNDED = 1e-2
# If a kept X contracts more slowly, a new factorisation, which costs as much as about five steps, is cheaper.
SLOW = 0.1
# Most steps with a kept X: those from a distance of 1 to rounding at that rate, and as many again because the
# rate is only a bound.
LIMIT = 32
PROBLEM = "the mechanism cannot be assembled"


@dataclass(frozen=True)
class Solved:
    """States at the requested instants, up to the last instant that could be reached.

    Attributes:
        times: the instants, (N,), s.
        states: y and its time derivatives, each (N, size).
        left: proven distance of each pose to the exact assembly, without rounding, in units, (N,).
        work: work that the states took.
        status: how the solver ended.
    """

    times: Array
    states: tuple[Array, ...]
    left: Array
    work: Work
    status: Status = COMPLETE

    def coordinates(self, instants: Array) -> list[Array]:
        """The states at some of the instants, each of shape (..., size)."""
        places = np.searchsorted(self.times, instants)
        return [state[places] for state in self.states]


InstantSolver = Callable[
    [Mechanism, Mapping[str, TimeFunction], Pose, Array, int, SquareVelocityTerm, float], Solved
]
"""A solver of poses and their rates at instants. It returns the states up to the first instant that cannot be
reached. See `solve_instants` for the arguments."""


def square_velocity_term(system: QuadraticMap, velocity: Array) -> Array:
    """(C_q q')_q q' = 2 B(y', y'), the corrected form of the paper's eq. (23), shape (..., rows)."""
    return 2.0 * system.residual(velocity)


def solve_instants(
    mechanism: Mechanism,
    functions: Mapping[str, TimeFunction],
    pose: Pose,
    times: Array,
    derivative: int,
    square_term: SquareVelocityTerm = square_velocity_term,
    tolerance: float = 0.0,
    chord: bool = False,
    cold: bool = False,
) -> Solved:
    """Solve at all instants, each from the instant before.

    Args:
        functions: the inputs as functions of time.
        pose: the pose at the first instant.
        times: increasing instants, shape (N,), s.
        derivative: highest time derivative to solve for.
        square_term: (C_q q')_q q' of eq. (23).
        tolerance: allowed distance of a pose to the exact assembly, without rounding, in units.
        chord: whether one factorisation is kept for as many instants as it converges for.
        cold: whether every instant, also the first, is reached from the closed drawing instead. The branch
            then does not depend on the motion but on the path from the drawing. An instant is refused if the
            path leads through poses that do not exist, though a motion might lead around them.
    Returns:
        The states, up to the first instant that cannot be reached.
    """
    known = mechanism.known_series({name: f.series(times, derivative) for name, f in functions.items()})
    values = {name: f.series(times, 0)[:, 0] for name, f in functions.items()}
    if cold:
        y, left, work, status = _from_drawing(mechanism, values, times, tolerance)
    else:
        y, left, work, status = _one_from_another(pose, values, known[:, 0], times, tolerance, chord)
    known, times = known[: len(y)], times[: len(y)]
    y[:, mechanism.map.unknowns :] = known[:, 0]
    solved = with_rates(mechanism.map, y, known, times, derivative, square_term, work, left)
    return replace(solved, status=status)


def _from_drawing(mechanism: Mechanism, values: Values, times: Array, tolerance: float) -> Reached:
    """The poses at all instants, each reached from the closed drawing."""
    drawing = close_drawing(mechanism, float(times[0]), tolerance)
    work, parts, status = drawing.work, [], COMPLETE
    for low in range(0, len(times), BLOCK):
        inputs = {name: each[low : low + BLOCK] for name, each in values.items()}
        target, path = driven_to(mechanism, inputs, drawing, tolerance)
        work += path.work
        unfinished = path.done < 1.0
        first = int(np.argmax(unfinished)) if unfinished.any() else len(target)
        parts.append((path.y[:first], path.left[:first]))
        if unfinished.any():
            when = float(times[low + first])
            status = Status(blocked(mechanism, PROBLEM, path.y, path.factors, target, unfinished, when))
            break
    y, left = (np.concatenate(part) for part in zip(*parts, strict=True))
    return y, left, work, status


def _one_from_another(
    begun: Pose, values: Values, goals: Array, times: Array, tolerance: float, chord: bool
) -> Reached:
    """The poses at all instants, each reached from the one before.

    Args:
        begun: pose at the first instant.
        goals: known coordinates at all instants, (N, known coordinates).
    """
    mechanism, system = begun.mechanism, begun.mechanism.map
    turned = sum(
        (np.abs(np.diff(values[name])) for name in mechanism.topology.turning), np.zeros(len(times) - 1)
    )
    # Instants to which an angle changes too far for a straight path, and the number of instants.
    far = np.append(np.flatnonzero(turned > LONGEST) + 1, len(times))
    y, left = np.empty((len(times), system.size)), np.empty(len(times))
    y[:1], left[:1] = begun.y, begun.left
    factors, work, done, ahead, status = begun.factors, Work(), 1, FIRST_AHEAD, COMPLETE
    while done < len(times):
        straight = goals[done : min(done + ahead, int(far[np.searchsorted(far, done)]))]
        count, found, rest, spent = _ahead(system, y[done - 1], factors, straight, tolerance, chord)
        work += spent
        y[done : done + count], left[done : done + count] = found, rest
        done += count
        ahead = min(2 * ahead, BLOCK) if count == len(straight) else max(count, FIRST_AHEAD)
        if count:
            if done < len(times):
                factors = factorise(system.jacobian(y[done - 1]))
                work += Work(factorisations=1)
            continue
        here, goal = y[done - 1 : done], goals[done : done + 1]
        ends = {name: (each[done - 1 : done], each[done : done + 1]) for name, each in values.items()}
        turn = float(turned[done - 1])
        target = by_inputs(mechanism, ends, goal) if turn > LONGEST else goal
        longest = LONGEST / max(turn, LONGEST)
        path = follow(system, here, target, factors.reshaped((1,)), tolerance, longest=longest).reshaped(())
        work += path.work
        unfinished = path.done < 1.0
        if unfinished:
            when = float(times[done])
            status = Status(blocked(mechanism, PROBLEM, path.y, path.factors, goal[0], unfinished, when))
            break
        y[done], left[done], factors = path.y, path.left, path.factors
        done += 1
    return y[:done], left[:done], work, status


def _ahead(
    system: QuadraticMap, start: Array, factors: Factors, targets: Array, tolerance: float, chord: bool
) -> tuple[int, Array, Array, Work]:
    """Poses at successive known coordinates, up to the last one that is proven to continue the pose `start`.

    Args:
        start: the pose, (size,).
        factors: factorisation of C_u at `start`.
        targets: known coordinates of the poses ahead, (N, known coordinates).
    Returns:
        Number of poses, the poses, the proven distance of each to the exact one, and the work of all trials.
    """
    n, none = system.unknowns, (0, np.empty((0, len(start))), np.empty(0))
    if not (len(targets) and n * EPS * factors.condition <= ROUNDED) or bool(hidden(system, start, factors)):
        return *none, Work()
    inverse = factors.preconditioner
    with np.errstate(all="ignore"):
        guess = _guessed(system, factors, start, targets)
    # Only the estimates before the first one that is not finite are tried.
    finite = _first_false(np.asarray(np.isfinite(guess).all(axis=-1)))
    if not finite:
        return *none, Work(residuals=3 * len(targets))
    if chord:
        with np.errstate(all="ignore"):
            y, found, left, work = _by_chord(system, inverse, guess[:finite], tolerance)
    else:
        reached = newton_refine(system, guess[:finite], tolerance=tolerance)
        y, found, left, work = reached.y, reached.converged, reached.left, reached.work
        factors = reached.factors
    before = np.concatenate([start[None], y[:-1]])
    with np.errstate(all="ignore"):
        # Each pose is joined to the one before by the path back, for which it has its own factorisation. The
        # pose before must be the end of this path: both are within the tolerance of their assemblies.
        back = _straight(system, factors, y, before[:, n:], 2)
        first, second = back[:, 1], back[:, 2]
        rest = np.abs(system.residual(y)) + np.abs(2.0 * system.polar(y, first))
        rest += np.abs(2.0 * system.polar(y, second) + system.residual(first))
        about = np.stack([y + 0.5 * first + 0.25 * second, 0.5 * (first + second), 0.25 * second])
        inverse = factors.preconditioner
        defect = np.abs(np.eye(n) - inverse @ system.jacobian(about[0]))
        sizes = np.abs(np.stack([first, second]))
        proof = prove_box(system, inverse, about[0], about, slice(None), sizes, rest, defect)
        apart = np.abs(before - back.sum(axis=1))[:, :n] + tolerance
        good = found & proof.holds & proof.within(apart)
    count = _first_false(np.asarray(good))
    return count, y[:count], left[:count], work + Work(residuals=3 * len(good))


def _by_chord(
    system: QuadraticMap, inverse: Array, y: Array, tolerance: float
) -> tuple[Array, Flags, Array, Work]:
    """Poses from estimates, by Newton steps with one inverse X for all.

    Within r, the radius of the theorem about an estimate (see `kantorovich`), the iteration contracts by
    k = z + omega r: after a step d, |u* - u| <= k |d| / (1 - k).

    Returns:
        The poses, which of them meet the tolerance, their proven distances, without rounding, and the work.
    """
    y, n, magnitude, previous = y.copy(), system.unknowns, np.abs(inverse), np.full(len(y), np.inf)
    z = np.abs(np.eye(n) - inverse @ system.jacobian(y)).sum(axis=-1).max(axis=-1)
    omega = system.lipschitz(inverse)
    count = 0
    while count < LIMIT:
        count += 1
        step = -system.residual(y) @ inverse.T
        size = np.abs(step).max(axis=-1)
        if count == 1:
            rate = z + omega * smallest_radius(size, z, omega)
        y[:, :n] += step
        left = rate * size / (1.0 - rate)
        noise = system.uncertainty(y, np.zeros(y.shape[-1])) @ magnitude.T
        # Near rounding a step is smaller than the noise, or no longer shrinks.
        noisy = (np.abs(step) <= noise).all(axis=-1) | (size < 1e-8) & (size >= 0.5 * previous)
        done, previous = (left <= tolerance) | noisy, size
        if (done | ~(rate <= SLOW)).all():
            break
    left = np.where(left <= tolerance, left, 0.0)
    return y, done & (rate <= SLOW), left, Work(residuals=count * len(y))


def _guessed(system: QuadraticMap, factors: Factors, start: Array, targets: Array) -> Array:
    """Estimates of the poses at the target known coordinates, from one pose, shape (N, size)."""
    starts = np.broadcast_to(start, (len(targets), len(start)))
    guess = np.sum(_straight(system, factors, starts, targets, TERMS), axis=1)
    guess[:, system.unknowns :] = targets
    return np.asarray(guess)


def _straight(system: QuadraticMap, factors: Factors, y: Array, targets: Array, order: int) -> Array:
    """Series along straight paths from poses y to known coordinates, (N, terms, size).

    The residual of y is reduced to zero along the path.

    Args:
        factors: factorisation of C_u at a pose nearby.
        targets: known coordinates at the ends, (N, known coordinates).
    """
    known = np.zeros((len(y), order + 1, targets.shape[-1]))
    known[:, 0], known[:, 1] = y[:, system.unknowns :], targets - y[:, system.unknowns :]
    return expand(system, factors, y, known, system.residual(y))


def _first_false(flags: Flags) -> int:
    return len(flags) if flags.all() else int(np.argmin(flags))


def with_rates(
    system: QuadraticMap,
    y: Array,
    known: Array,
    times: Array,
    derivative: int,
    square_term: SquareVelocityTerm,
    work: Work,
    left: Array | None = None,
) -> Solved:
    """Solved poses y, (N, size), with their time derivatives up to `derivative`.

    Args:
        known: series of the known coordinates, (N, derivative + 1, known coordinates).
        work: work that the poses took.
        left: proven distances of the poses to the exact ones, (N,), in units; zero unless given.
    """
    states = [y, *(np.empty_like(y) for _ in range(derivative))]
    for low in range(0, len(times) if derivative else 0, BLOCK):
        some = slice(low, low + BLOCK)
        # Newton's factors belong to the pose before the last step, which may be farther off than the bound.
        factors = factorise(system.jacobian(y[some]))
        states[1][some] = implicit_rate(system, factors, y[some], known[some, 1], 0.0)
        for d in range(2, derivative + 1):
            if d == 2:
                term = square_term(system, states[1][some])
            else:
                # sum_{0<i<d} C(d, i) B(z_i, z_{d-i})
                mixed = (comb(d, i) * system.polar(states[i][some], states[d - i][some]) for i in range(1, d))
                term = np.asarray(sum(mixed))
            states[d][some] = implicit_rate(system, factors, y[some], factorial(d) * known[some, d], term)
    if derivative:
        work = work + Work(factorisations=len(times))
    rest = np.zeros(len(times)) if left is None else left
    solves = derivative * len(times)
    work = work + Work(rate_solves=solves, unknowns_solved=solves * system.unknowns)
    return Solved(times, tuple(states), rest, work)
