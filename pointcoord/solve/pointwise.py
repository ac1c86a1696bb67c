r"""The paper's own algorithm: Newton at every instant, then two linear solves.

    C(u, w) = 0,    C_u u' = -C_w w',    C_u u'' = -C_w w'' - 2 B(y', y')      (eqs. 1, 19, 22)

Each instant is reached from the one before it, by proof. That is no loop over time: from a pose y0 with
X = C_u(y0)^-1 the poses of many instants ahead are guessed by a few terms of the series along the straight
way to their inputs (see `power_series`) and corrected all at once, by Newton's method, or with X kept for as
long as it serves (`chord`),

    u <- u - X C(u, w);

then each is proven to continue the one before it, straight (see `proven_step`). Where that does not lead on,
or a turn takes more than a radian, the path is followed in shorter proven steps, along which inputs go in
proportion. Or each instant is reached from the drawing (`cold`). The rates are solved for many instants at
once in any case. This is what the series are measured against.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from math import comb, factorial

import numpy as np
from numpy.typing import NDArray

from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.counters import Work
from pointcoord.numerics.kantorovich import smallest_radius
from pointcoord.numerics.linear import Factors, factorise
from pointcoord.numerics.newton import implicit_rate, newton_refine
from pointcoord.numerics.partial_map import PartialMap
from pointcoord.numerics.power_series import expand
from pointcoord.numerics.quadratic import QuadraticMap
from pointcoord.numerics.rounding import EPS
from pointcoord.solve.assembly import LONGEST, Pose, blocked, by_inputs, close_drawing, driven_to
from pointcoord.solve.follower import Law, follow
from pointcoord.solve.place import Place, starting_place, whole_place
from pointcoord.solve.proven_step import WHOLE, hidden, prove
from pointcoord.solve.status import COMPLETE, Status
from pointcoord.time_functions import TimeFunction

Array = NDArray[np.float64]
SquareVelocityTerm = Callable[[QuadraticMap, Array], Array]
Values = Mapping[str, Array]
"""Of every input at all instants, each (N,)."""
How = tuple[float, bool]
"""The tolerance, and whether a factorisation is kept."""
Reached = tuple[Array, Array, Work, Status]
"""The poses that were reached, what is left of each, what they took, and what stopped them."""

# Instants that are solved at once: a matrix for each takes 1 MB, which a processor keeps at hand. With
# 4,096 at once 40,000 instants take half as long again; with 64 no less than with 512.
BLOCK = 512
# Instants ahead that are tried first; twice as many after all of them were proven.
FIRST_AHEAD = 8
# Terms of the way there: with more the guess is nearer than Newton's first step needs.
TERMS = 3
# Where n eps cond(C_u) is larger, rounding may be more than that.
ROUNDED = 1e-2
# Of a kept X a slower contraction is worth a new factorisation, which costs as much as some five steps.
SLOW = 0.1
# Steps from a distance of 1 to rounding at that rate, and as many again for what a bound misjudges.
LIMIT = 32
PROBLEM = "the mechanism cannot be assembled"


@dataclass(frozen=True)
class Solved:
    """States at instants, as many of those that were asked for as could be reached.

    Attributes:
        times: (N,), s.
        states: y and its time derivatives, each (N, size).
        left: proven distance of each pose to the exact assembly, rounding apart, in units, (N,).
        work: what it cost.
        status: how it ended.
    """

    times: Array
    states: tuple[Array, ...]
    left: Array
    work: Work
    status: Status = COMPLETE

    def coordinates(self, instants: Array) -> list[Array]:
        """The states at some of the times, each of shape (..., size)."""
        places = np.searchsorted(self.times, instants)
        return [state[places] for state in self.states]


InstantSolver = Callable[
    [Mechanism, Mapping[str, TimeFunction], Pose, Array, int, SquareVelocityTerm, float], Solved
]
"""A way to solve for poses and their rates at instants: the states, up to the first instant that cannot be
reached; see `solve_instants` for what it is given."""


def square_velocity_term(system: QuadraticMap, velocity: Array) -> Array:
    """(C_q q')_q q' = 2 B(y', y'), the paper's eq. (23) as it should be, shape (..., rows)."""
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
    """Solve at each instant, each from the one before.

    Args:
        pose: assembled at the first instant.
        times: increasing instants, shape (N,), s.
        derivative: highest time derivative to solve for.
        tolerance: how far a pose may be from the exact assembly, rounding apart, in units.
        chord: whether a factorisation is kept for as many instants as it serves.
        cold: whether each instant is reached by itself from the closed drawing instead, also the first. Which
            branch that leads to does not depend on the motion, but it depends on the way: where poses that do
            not exist lie between, it is refused, though a motion might lead around them.
    Returns:
        The states, up to the first instant that cannot be reached. What stands still is solved once, but for
        instants by themselves.
    """
    known = mechanism.known_series({name: f.series(times, derivative) for name, f in functions.items()})
    values = {name: f.series(times, 0)[:, 0] for name, f in functions.items()}
    if cold:
        y, left, work, status = _from_drawing(mechanism, values, times, tolerance)
    else:
        part = mechanism.moving_part(functions)
        begun, how = starting_place(part, pose), (tolerance, chord)
        y, left, work, status = _one_from_another(mechanism, part, begun, values, known[:, :1], times, how)
    known, times = known[: len(y)], times[: len(y)]
    y[:, mechanism.map.unknowns :] = known[:, 0]
    solved = with_rates(mechanism.map, y, known, times, derivative, square_term, work, left)
    return replace(solved, status=status)


def _from_drawing(mechanism: Mechanism, values: Values, times: Array, tolerance: float) -> Reached:
    """All from the closed drawing."""
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
    mechanism: Mechanism, part: PartialMap, begun: Place, values: Values, known: Array, times: Array, how: How
) -> Reached:
    """Each from the one before, of what moves; known: of the whole, (N, 1, known coordinates)."""
    system, (tolerance, chord) = part.system, how
    turned = sum(
        (np.abs(np.diff(values[name])) for name in mechanism.topology.turning), np.zeros(len(times) - 1)
    )
    # Instants that are reached round, and the end.
    far = np.append(np.flatnonzero(turned > LONGEST) + 1, len(times))
    goals = part.known(begun.y, known)[:, 0]
    y, left = np.empty((len(times), system.size)), np.empty(len(times))
    y[:1], left[:1] = begun.y, begun.left
    factors, work, done, ahead, status = begun.factors, begun.work, 1, FIRST_AHEAD, COMPLETE
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
        target: Array | Law = goal
        if turn > LONGEST:
            target = _of_part(part, begun.y, by_inputs(mechanism, ends, known[done]))
        longest = LONGEST / max(turn, LONGEST)
        path = follow(system, here, target, factors.reshaped((1,)), tolerance, longest=longest).reshaped(())
        work += path.work
        unfinished = path.done < 1.0
        if unfinished:
            place, when = whole_place(part, path.y, path.factors), float(times[done])
            stopped = blocked(mechanism, PROBLEM, place.y, place.factors, known[done, 0], unfinished, when)
            status = Status(stopped)
            break
        y[done], left[done], factors = path.y, path.left, path.factors
        done += 1
    return part.back(y[:done]), left[:done], work, status


def _of_part(part: PartialMap, y: Array, law: Law) -> Law:
    """A law of what is known to the whole as one of what is known to a part, with a pose of it, (size,)."""

    def of_part(members: NDArray[np.intp], shares: Array, order: int) -> Array:
        return part.known(y, law(members, shares, order))

    return of_part


def _ahead(
    system: QuadraticMap, start: Array, factors: Factors, targets: Array, tolerance: float, chord: bool
) -> tuple[int, Array, Array, Work]:
    """Poses with known coordinates one after the other, as many as are proven to continue a pose.

    Args:
        start: the pose, (size,). factors: of C_u there. targets: (N, known coordinates).
    Returns:
        How many, the poses, what is left of each, and what all that were tried took.
    """
    n, none = system.unknowns, (0, np.empty((0, len(start))), np.empty(0))
    if not (len(targets) and n * EPS * factors.condition <= ROUNDED) or bool(hidden(system, start, factors)):
        return *none, Work()
    inverse = factors.preconditioner
    with np.errstate(all="ignore"):
        guess = _guessed(system, factors, start, targets)
    # A guess that is not finite ends what is tried.
    finite = _first_false(np.asarray(np.isfinite(guess).all(axis=-1)))
    if not finite:
        return *none, Work(residuals=3 * len(targets))
    if chord:
        with np.errstate(all="ignore"):
            y, found, left, work = _by_chord(system, inverse, guess[:finite], tolerance)
    else:
        reached = newton_refine(system, guess[:finite], tolerance=tolerance)
        y, found, left, work = reached.y, reached.converged, reached.left, reached.work
    poses = np.concatenate([start[None], y])
    here, following = poses[:-1], poses[1:]
    with np.errstate(all="ignore"):
        series = _straight(system, factors, here, following[:, n:], 1)
        rest = np.stack([system.residual(here), 2.0 * system.polar(here, series[:, 1])])
        proof = prove(system, inverse, series, rest, WHOLE)
        apart = np.abs(following - series.sum(axis=1))[:, :n] + left[:, None]
        good = found & (proof.length == 1.0) & proof.within(apart)
    count = _first_false(np.asarray(good))
    return count, y[:count], left[:count], work + Work(residuals=3 * len(good))


def _by_chord(
    system: QuadraticMap, inverse: Array, y: Array, tolerance: float
) -> tuple[Array, NDArray[np.bool_], Array, Work]:
    """Poses from guesses of them, by steps with one inverse.

    Within r, the radius of the theorem about a guess (see `kantorovich`), X contracts by k = z + omega r:
    after a step d, |u* - u| <= k |d| / (1 - k).

    Returns:
        The poses, which of them are as good as asked, what is left of each, rounding apart, and the work.
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
        # Near rounding a step is noise, or no longer shrinks.
        noisy = (np.abs(step) <= noise).all(axis=-1) | (size < 1e-8) & (size >= 0.5 * previous)
        done, previous = (left <= tolerance) | noisy, size
        if (done | ~(rate <= SLOW)).all():
            break
    left = np.where(left <= tolerance, left, 0.0)
    return y, done & (rate <= SLOW), left, Work(residuals=count * len(y))


def _guessed(system: QuadraticMap, factors: Factors, start: Array, targets: Array) -> Array:
    """Poses near those with known coordinates, from one pose, shape (N, size)."""
    starts = np.broadcast_to(start, (len(targets), len(start)))
    guess = np.sum(_straight(system, factors, starts, targets, TERMS), axis=1)
    guess[:, system.unknowns :] = targets
    return np.asarray(guess)


def _straight(system: QuadraticMap, factors: Factors, y: Array, targets: Array, order: int) -> Array:
    """Series of straight ways to known coordinates, (N, terms, size); what poses y lack is taken back.

    Args:
        factors: of C_u at a pose nearby. targets: (N, known coordinates).
    """
    known = np.zeros((len(y), order + 1, targets.shape[-1]))
    known[:, 0], known[:, 1] = y[:, system.unknowns :], targets - y[:, system.unknowns :]
    return expand(system, factors, y, known, system.residual(y))


def _first_false(flags: NDArray[np.bool_]) -> int:
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
    """Solved poses y, (N, size), with as many of their time derivatives as asked for.

    Args:
        known: series of the known coordinates, (N, derivative + 1, known coordinates).
        work: what the poses took.
        left: how far these may be from the exact ones, (N,), in units; nothing unless given.
    """
    states = [y, *(np.empty_like(y) for _ in range(derivative))]
    for low in range(0, len(times) if derivative else 0, BLOCK):
        some = slice(low, low + BLOCK)
        # Newton's factors are of the place before its last step, which may be farther off than the bound.
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
