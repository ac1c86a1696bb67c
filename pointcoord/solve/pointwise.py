r"""The paper's own algorithm: Newton at every instant, then two linear solves.

    C(u, w) = 0,    C_u u' = -C_w w',    C_u u'' = -C_w w'' - 2 B(y', y')      (eqs. 1, 19, 22)

Each instant starts from the one before it, so time is a loop; or from the drawing, and then all are solved at
once. The rates are solved for many instants at once either way. This is what the series are measured against.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from pointcoord.data_classes import dataclass
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.counters import Work
from pointcoord.numerics.linear import Factors, factorise
from pointcoord.numerics.quadratic import QuadraticMap
from pointcoord.solve.assembly import Pose, blocked, close_drawing, follow
from pointcoord.solve.status import COMPLETE, Status
from pointcoord.time_functions import TimeFunction

Array = NDArray[np.float64]
SquareVelocityTerm = Callable[[QuadraticMap, Array], Array]

# Instants that are solved at once: their matrices, some six of them, stay below 100 MB.
BLOCK = 4096


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
) -> Solved:
    """Solve at each instant, each from the one before.

    Args:
        pose: assembled at the first instant.
        times: increasing instants, shape (N,), s.
        derivative: highest time derivative to solve for, 0 to 2.
        tolerance: how far a pose may be from the exact assembly, rounding apart, in units.
    Returns:
        The states, up to the first instant that cannot be reached.
    """
    system, n = mechanism.map, mechanism.map.unknowns
    known = mechanism.known_series({name: f.series(times, derivative) for name, f in functions.items()})
    y, left = np.empty((len(times), system.size)), np.empty(len(times))
    here, factors, rest, work = pose.y, pose.factors, pose.left, Work()
    status: Status = COMPLETE
    for i in range(len(times)):
        if i > 0:
            path = follow(system, here, known[i, 0], factors, tolerance)
            work += path.work
            if path.done < 1.0:
                problem = "the mechanism cannot be assembled"
                status = blocked(mechanism, problem, path, known[i, 0], path.done < 1.0, float(times[i]))
                y, left, known, times = y[:i], left[:i], known[:i], times[:i]
                break
            here, factors, rest = path.y, path.factors, path.left
        y[i], left[i] = here, rest
    y[:, n:] = known[:, 0]
    solved = with_rates(system, y, known, times, derivative, square_term, work, left)
    return replace(solved, status=status)


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
        path = follow(system, drawing.y, target, tolerance=tolerance)
        work += path.work
        unfinished = path.done < 1.0
        first = int(np.argmax(unfinished)) if unfinished.any() else len(target)
        parts.append((path.y[:first], path.left[:first]))
        if unfinished.any():
            problem, when = "the mechanism cannot be assembled", float(times[low + first])
            status = blocked(mechanism, problem, path, target, unfinished, when)
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
    states = [y]
    if derivative >= 1:
        # Newton's factors are of the place before its last step, which may be farther off than the bound.
        factors = factorise(system.jacobian(y))
        work = work + Work(factorisations=len(times))
        states.append(_rate(system, factors, y, known[:, 1], 0.0))
    if derivative >= 2:
        states.append(_rate(system, factors, y, 2.0 * known[:, 2], square_term(system, states[1])))
    rest = np.zeros(len(times)) if left is None else left
    return Solved(times, tuple(states), rest, work + Work(rate_solves=derivative * len(times)))


def _rate(system: QuadraticMap, factors: Factors, y: Array, driven: Array, quadratic: Array | float) -> Array:
    """Solve C_u u^(d) = -(C_w w^(d) + quadratic term)."""
    rate = np.zeros_like(y)
    rate[:, system.unknowns :] = driven
    rate[:, : system.unknowns] = -factors.solve(2.0 * system.polar(y, rate) + quadratic)
    return rate
