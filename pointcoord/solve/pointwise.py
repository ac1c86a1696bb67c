r"""The paper's own algorithm: Newton at every instant, then two linear solves.

    C(u, w) = 0,    C_u u' = -C_w w',    C_u u'' = -C_w w'' - 2 B(y', y')      (eqs. 1, 19, 22)

Each instant is reached from the one before it, by proof. That is no loop over time: from a pose y0 with
X = C_u(y0)^-1 the poses of many instants ahead are guessed by three terms of the straight way to their
inputs,

    u1 = -X C_w dw,    u2 = -X B(y1, y1),    u3 = -X 2 B(y1, y2),

and corrected by Newton's method, all at once; then each is proven to continue the one before it, straight
or, of a turn by more than a radian, round (see `proven_step`). By `chord` X is kept for as long as it is good
enough,

    u <- u - X C(u, w),

from the end of the tangent T that X gives, one instant after the other. Where the theorem of Newton and
Kantorovich holds all along y0 + s T, X contracts towards the end by k = z + omega r, r the radius of the
theorem: after a step d, |u* - u| <= k |d| / (1 - k).

Where neither leads on the path is followed in shorter proven steps. Or each instant is reached from the
drawing (`solve_from_drawing`). The rates are solved for many instants at once in any case. This is what the
series are measured against.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.branch import hidden
from pointcoord.numerics.counters import Work
from pointcoord.numerics.kantorovich import smallest_radius
from pointcoord.numerics.linear import Factors, factorise
from pointcoord.numerics.newton import implicit_rate, newton_refine
from pointcoord.numerics.partial_map import PartialMap
from pointcoord.numerics.quadratic import QuadraticMap
from pointcoord.numerics.rounding import EPS
from pointcoord.solve.assembly import LONGEST, Pose, blocked, close_drawing, driven_to
from pointcoord.solve.follower import follow
from pointcoord.solve.place import Path, starting_place, whole_place
from pointcoord.solve.proven_step import SHARES, straight_way
from pointcoord.solve.status import COMPLETE, Status
from pointcoord.time_functions import TimeFunction

Array = NDArray[np.float64]
SquareVelocityTerm = Callable[[QuadraticMap, Array], Array]

# Instants that are solved at once: a matrix for each takes 1 MB, which a processor keeps at hand. With
# 4,096 at once 40,000 instants take half as long again; with 64 no less than with 512.
BLOCK = 512
# Instants ahead that are tried first; twice as many after all of them were proven.
FIRST_AHEAD = 8
# Where n eps cond(C_u) is larger, rounding may be more than that.
ROUNDED = 1e-2
# Of a kept X a slower contraction is worth a new factorisation, which costs as much as some five steps: from
# 1e-3 to rounding, 1e-16, it takes thirteen.
SLOW = 0.1
# Steps from a distance of 1 to rounding at that rate, and as many again for what a bound misjudges.
LIMIT = 32


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


class InstantSolver(Protocol):
    """A way to solve for poses and their rates at instants; see `solve_instants` for what it is given."""

    def __call__(
        self,
        mechanism: Mechanism,
        functions: Mapping[str, TimeFunction],
        pose: Pose,
        times: Array,
        derivative: int,
        square_term: SquareVelocityTerm,
        tolerance: float,
        /,
    ) -> Solved:
        """The states, up to the first instant that cannot be reached."""
        ...


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
) -> Solved:
    """Solve at each instant, each from the one before.

    Args:
        pose: assembled at the first instant.
        times: increasing instants, shape (N,), s.
        derivative: highest time derivative to solve for, 0 to 2.
        tolerance: how far a pose may be from the exact assembly, rounding apart, in units.
        chord: whether a factorisation is kept for as many instants as it serves.
    Returns:
        The states, up to the first instant that cannot be reached. What stands still is solved once.
    """
    system, n = mechanism.map, mechanism.map.unknowns
    known = mechanism.known_series({name: f.series(times, derivative) for name, f in functions.items()})
    y, left = np.empty((len(times), system.size)), np.empty(len(times))
    y[:1], left[:1] = pose.y, pose.left
    part = mechanism.moving_part(functions)
    begun = starting_place(part, pose)
    here, factors, work, done = begun.y, begun.factors, begun.work, 1
    lead, ahead = (_by_chord, len(times)) if chord else (_proven_ahead, FIRST_AHEAD)
    goals = part.known(here, known[:, :1])[:, 0]
    between = Between(mechanism, functions, times, part, here)
    beside = between.beside(goals)
    status: Status = COMPLETE
    while done < len(times):
        targets = goals[done : done + ahead]
        strip = beside[done - 1 : done - 1 + ahead]
        found = lead(part.system, here, factors, targets, tolerance, strip)
        work += found.work
        count = len(found.left)
        y[done : done + count], left[done : done + count] = part.back(found.y), found.left
        done += count
        if not chord:
            ahead = min(2 * ahead, BLOCK) if count == len(targets) else max(count, FIRST_AHEAD)
        if done == len(times):
            break
        if count:
            here = found.y[-1]
            factors = factorise(part.system.jacobian(here))
            work += Work(factorisations=1)
            continue
        path = between.follow(here, goals[done], factors, done, beside[done - 1], tolerance)
        work += path.work
        if path.done < 1.0:
            problem = "the mechanism cannot be assembled"
            place = whole_place(part, path.y, path.factors)
            stop = blocked(mechanism, problem, place, known[done, 0], path.done < 1.0, float(times[done]))
            status = Status(stop)
            y, left, known, times = y[:done], left[:done], known[:done], times[:done]
            break
        here, factors = path.y, path.factors
        y[done], left[done] = part.back(here), path.left
        done += 1
    y[:, n:] = known[:, 0]
    solved = with_rates(system, y, known, times, derivative, square_term, work, left)
    return replace(solved, status=status)


@dataclass(frozen=True)
class Between:
    """What the known coordinates do between instants.

    Attributes:
        part: whose coordinates they are; here: a pose of it.
    """

    mechanism: Mechanism
    functions: Mapping[str, TimeFunction]
    times: Array
    part: PartialMap
    here: Array

    def known(self, instants: Array) -> Array:
        """At instants, (N, known coordinates)."""
        known = self.mechanism.known_series({n: f.series(instants, 0) for n, f in self.functions.items()})
        return self.part.known(self.here, known)[:, 0]

    def at_shares(self, number: int, _: NDArray[np.intp], shares: Array) -> Array:
        """On the way to an instant, by its number; see `Law`."""
        first, last = self.times[number - 1 : number + 1]
        return self.known(np.where(shares == 1.0, last, first + (last - first) * shares))

    def beside(self, goals: Array) -> Array:
        """How far they go beside the ways between instants, (N - 1, known coordinates), as far as is known.

        What is solved at instants goes straight from one to the next; something that turns by more than
        LONGEST goes infinitely far beside that.
        """
        off = np.zeros((len(self.times) - 1, goals.shape[-1]))
        off[self.turned > LONGEST] = np.inf
        return off

    @cached_property
    def turned(self) -> Array:
        """By how much inputs turn between instants, rad, (N - 1,)."""
        places = self.times[:-1, None] + np.diff(self.times)[:, None] * np.concatenate([[0.0], SHARES, [1.0]])
        turned = np.zeros(len(places))
        for name in self.mechanism.topology.turning:
            values = self.functions[name].series(places.ravel(), 0).reshape(places.shape)
            turned += np.abs(np.diff(values)).sum(axis=-1)
        return turned

    def follow(
        self, y: Array, goal: Array, factors: Factors, number: int, beside: Array, tolerance: float
    ) -> Path:
        """The proven path to an instant, by its number, from the pose at the one before it."""
        if not beside.any():
            return follow(self.part.system, y, goal, factors, tolerance)
        longest = LONGEST / max(float(self.turned[number - 1]), LONGEST)
        law = partial(self.at_shares, number)
        return follow(self.part.system, y, law, factors, tolerance, longest=longest)


@dataclass(frozen=True)
class _Ahead:
    """Poses that are proven to continue each other, as of `Solved`, and what all that were tried took."""

    y: Array
    left: Array
    work: Work


def _proven_ahead(
    system: QuadraticMap,
    start: Array,
    factors: Factors,
    targets: Array,
    tolerance: float,
    beside: Array | None = None,
) -> _Ahead:
    """Poses with known coordinates one after the other, as many as are proven to continue a pose.

    Args:
        start: the pose, (size,). factors: of C_u there. targets: (N, known coordinates).
        beside: as of `straight_way`.
    """
    n, none = system.unknowns, _Ahead(np.empty((0, len(start))), np.empty(0), Work())
    if not n * EPS * factors.condition <= ROUNDED or bool(hidden(system, start, factors)):
        return none
    inverse = factors.preconditioner
    with np.errstate(all="ignore"):
        guess = _guessed(system, inverse, start, targets)
    # A guess that is not finite ends what is tried.
    finite = np.asarray(np.isfinite(guess).all(axis=-1))
    reached = newton_refine(system, guess[: _first_false(finite)], tolerance=tolerance)
    poses = np.concatenate([start[None], reached.y])
    here, following = poses[:-1], poses[1:]
    with np.errstate(all="ignore"):
        beside = None if beside is None else beside[: len(here)]
        way = straight_way(system, inverse, here, following[:, n:], beside)
        omega = float(system.lipschitz(inverse, np.ones(n)))
        apart = np.abs(following - here - way.tangent)[:, :n] + reached.left[:, None]
        proof = way.proof(omega, np.ones(n))
        good = reached.converged & proof.holds & proof.within(apart)
    count = _first_false(np.asarray(good))
    return _Ahead(reached.y[:count], reached.left[:count], reached.work + Work(residuals=3 * len(good)))


def _by_chord(
    system: QuadraticMap,
    start: Array,
    factors: Factors,
    targets: Array,
    tolerance: float,
    beside: Array | None = None,
) -> _Ahead:
    """The same one after the other, by the inverse at the start alone, as many as it serves."""
    n, poses, left, residuals = system.unknowns, [np.empty((0, len(start)))], list[float](), 0
    if not n * EPS * factors.condition <= ROUNDED or bool(hidden(system, start, factors)):
        return _Ahead(poses[0], np.empty(0), Work())
    inverse, here = factors.preconditioner, start
    omega = system.lipschitz(inverse)
    for i, target in enumerate(targets):
        with np.errstate(all="ignore"):
            way = straight_way(system, inverse, here, target, None if beside is None else beside[i])
            eta, z = way.norms(np.ones(n))
            rate = float(z + omega * smallest_radius(eta, z, omega))
        if not rate <= SLOW:
            break
        here = here + way.tangent
        here[n:] = target
        rest, steps = _contracted(system, inverse, here, rate, tolerance)
        residuals += steps + 2
        if rest is None:
            break
        poses.append(here[None])
        left.append(rest)
    return _Ahead(np.concatenate(poses), np.array(left), Work(residuals=residuals))


def _contracted(
    system: QuadraticMap, inverse: Array, y: Array, rate: float, tolerance: float
) -> tuple[float | None, int]:
    """Carry a place, which is written over, to its pose by steps that contract at a rate.

    Returns:
        What is proven to be left, rounding apart, None where steps do not shrink to that; and the steps.
    """
    previous = np.inf
    for count in range(1, LIMIT + 1):
        step = -(inverse @ system.residual(y))
        y[: system.unknowns] += step
        size = float(np.abs(step).max())
        left = rate * size / (1.0 - rate)
        if left <= tolerance:
            return left, count
        # Near rounding a step is noise, or no longer shrinks.
        if size < 1e-8:
            noise = np.abs(inverse) @ system.uncertainty(y, np.zeros_like(y))
            if (np.abs(step) <= noise).all() or size >= 0.5 * previous:
                return 0.0, count
        previous = size
    return None, LIMIT


def _guessed(system: QuadraticMap, inverse: Array, start: Array, targets: Array) -> Array:
    """Three terms of the straight way to known coordinates, shape (N, size)."""
    n = system.unknowns
    first, second, third = (np.zeros((len(targets), len(start))) for _ in range(3))
    first[:, n:] = targets - start[n:]
    first[:, :n] = -(2.0 * system.polar(start, first) + system.residual(start)) @ inverse.T
    second[:, :n] = -system.residual(first) @ inverse.T
    third[:, :n] = -2.0 * system.polar(first, second) @ inverse.T
    guess = start + (first + (second + third))
    guess[:, n:] = targets
    return guess


def _first_false(flags: NDArray[np.bool_]) -> int:
    return len(flags) if flags.all() else int(np.argmin(flags))


def solve_from_drawing(
    mechanism: Mechanism,
    functions: Mapping[str, TimeFunction],
    pose: Pose,
    times: Array,
    derivative: int,
    square_term: SquareVelocityTerm = square_velocity_term,
    tolerance: float = 0.0,
) -> Solved:
    """Solve at each instant by itself, on a straight way from the closed drawing; all of them at once.

    Which branch that leads to does not depend on the motion, but it depends on the way: where poses that do
    not exist lie between, it is refused, though a motion might lead around them.

    Args, result: as of `solve_instants`; the pose at the first instant is solved again with the others.
    """
    system = mechanism.map
    known = mechanism.known_series({name: f.series(times, derivative) for name, f in functions.items()})
    drawing = close_drawing(mechanism, float(times[0]), tolerance)
    work, parts = drawing.work, []
    status: Status = COMPLETE
    for low in range(0, len(times), BLOCK):
        target = known[low : low + BLOCK, 0]
        inputs = {name: f.series(times[low : low + BLOCK], 0)[:, 0] for name, f in functions.items()}
        _, path = driven_to(mechanism, inputs, drawing, tolerance)
        work += path.work
        unfinished = path.done < 1.0
        first = int(np.argmax(unfinished)) if unfinished.any() else len(target)
        parts.append((path.y[:first], path.left[:first]))
        if unfinished.any():
            problem, when = "the mechanism cannot be assembled", float(times[low + first])
            status = Status(blocked(mechanism, problem, path, target, unfinished, when))
            known, times = known[: low + first], times[: low + first]
            break
    y, left = (np.concatenate(part) for part in zip(*parts, strict=True))
    y[:, system.unknowns :] = known[:, 0]
    solved = with_rates(system, y, known, times, derivative, square_term, work, left)
    return replace(solved, status=status)


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
        if derivative >= 2:
            term = square_term(system, states[1][some])
            states[2][some] = implicit_rate(system, factors, y[some], 2.0 * known[some, 2], term)
    if derivative:
        work = work + Work(factorisations=len(times))
    rest = np.zeros(len(times)) if left is None else left
    solves = derivative * len(times)
    work = work + Work(rate_solves=solves, unknowns_solved=solves * system.unknowns)
    return Solved(times, tuple(states), rest, work)
