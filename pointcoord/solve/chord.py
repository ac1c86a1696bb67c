r"""Chord Newton at instants: one factorisation kept for as long as it is good enough.

    u <- u - X C(u, w),      X = C_u^-1 of an earlier pose,

which converges by a constant factor instead of squaring its error. Each instant starts from the pose y0
before, along the tangent T that X gives to the new known coordinates, where the theorem of Newton and
Kantorovich holds on all of that straight way (see `proven_step`, whose eta, z and omega these are).

Then there is one assembly near each y0 + s T, they are one branch, and X contracts towards the last by
k = z + omega r, r the radius of the theorem, which is k = 1 - sqrt((1 - z)^2 - 2 omega eta): after a step d,
|u* - u| <= k |d| / (1 - k). Where that is not so, X is made anew, and if that is not enough the path is
followed in shorter proven steps (see `assembly`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.branch import hidden
from pointcoord.numerics.counters import Work
from pointcoord.numerics.linear import Factors, factorise
from pointcoord.numerics.partial_map import moving_part
from pointcoord.numerics.quadratic import QuadraticMap
from pointcoord.solve.assembly import Pose, blocked
from pointcoord.solve.pointwise import (
    Between,
    Solved,
    SquareVelocityTerm,
    square_velocity_term,
    with_rates,
)
from pointcoord.solve.proven_step import straight_way
from pointcoord.solve.status import COMPLETE, Status
from pointcoord.time_functions import TimeFunction

Array = NDArray[np.float64]

# A slower contraction is worth a new factorisation, which costs as much as some five steps: from 1e-3 to
# rounding, 1e-16, it takes thirteen.
SLOW = 0.1
# Steps from a distance of 1 to rounding at that rate, and as many again for what a bound misjudges.
LIMIT = 32


@dataclass(frozen=True)
class Kept:
    """A factorisation that is kept: X, and the Lipschitz constant of X C_u."""

    inverse: Array
    omega: float

    @classmethod
    def of(cls, system: QuadraticMap, factors: Factors) -> Kept:
        """Of the factors of C_u at some pose."""
        inverse = factors.preconditioner
        return cls(inverse, float(system.lipschitz(inverse, np.ones(system.unknowns))))

    def step(self, rows: Array) -> Array:
        """X times rows."""
        return np.asarray(self.inverse @ rows)


@dataclass(frozen=True)
class Reached:
    """A pose, how far it is from the exact one by proof, and how many residuals it took."""

    y: Array
    left: float
    residuals: int


def solve_by_chord(
    mechanism: Mechanism,
    functions: Mapping[str, TimeFunction],
    pose: Pose,
    times: Array,
    derivative: int,
    square_term: SquareVelocityTerm = square_velocity_term,
    tolerance: float = 0.0,
) -> Solved:
    """Solve at each instant, each from the one before; arguments and result as of `solve_instants`."""
    system, n = mechanism.map, mechanism.map.unknowns
    known = mechanism.known_series({name: f.series(times, derivative) for name, f in functions.items()})
    y, left = np.empty((len(times), system.size)), np.empty(len(times))
    here, rest, work = pose.y, float(pose.left), Work()
    kept = Kept.of(system, pose.factors)
    part = moving_part(system, frozenset())
    between = Between(mechanism, functions, times, part, here)
    beside = between.beside(known[:, 0])
    status: Status = COMPLETE
    for i in range(len(times)):
        if i > 0:
            target = known[i, 0]
            reached = _along_chord(system, kept, here, target, tolerance, beside[i - 1])
            if reached is None:
                factors = factorise(system.jacobian(here))
                work += Work(factorisations=1)
                kept = Kept.of(system, factors)
                if not bool(hidden(system, here, factors)):
                    reached = _along_chord(system, kept, here, target, tolerance, beside[i - 1])
                if reached is None:
                    path = between.follow(here, target, factors, i, beside[i - 1], tolerance)
                    work += path.work
                    if path.done < 1.0:
                        problem = "the mechanism cannot be assembled"
                        status = blocked(mechanism, problem, path, target, path.done < 1.0, float(times[i]))
                        y, left, known, times = y[:i], left[:i], known[:i], times[:i]
                        break
                    kept = Kept.of(system, path.factors)
                    reached = Reached(path.y, float(path.left), 0)
            work += Work(residuals=reached.residuals)
            here, rest = reached.y, reached.left
        y[i], left[i] = here, rest
    y[:, n:] = known[:, 0]
    solved = with_rates(system, y, known, times, derivative, square_term, work, left)
    return replace(solved, status=status)


def _along_chord(
    system: QuadraticMap, kept: Kept, y: Array, target: Array, tolerance: float, beside: Array | None = None
) -> Reached | None:
    """The pose with other known coordinates, on the branch of y; None where X is too old for it, or slow.

    Args:
        beside: as of `straight_way`.
    """
    n = system.unknowns
    with np.errstate(all="ignore"):
        way = straight_way(system, kept.inverse, y, target, beside)
        eta, z = way.norms(np.ones(n))
        rate = 1.0 - float(np.sqrt((1.0 - z) ** 2 - 2.0 * kept.omega * eta))
    # Not a number where nothing is proven.
    if not (z < 1.0 and rate <= SLOW):
        return None
    here = y + way.tangent
    here[n:] = target
    exact_data = np.zeros_like(y)
    previous = np.inf
    for count in range(1, LIMIT + 1):
        step = -kept.step(system.residual(here))
        here[:n] += step
        size = float(np.abs(step).max())
        left = rate * size / (1.0 - rate)
        if left <= tolerance:
            return Reached(here, left, count + 2)
        # Near rounding a step is noise, or no longer shrinks.
        if size < 1e-8:
            noise = np.abs(kept.inverse) @ system.uncertainty(here, exact_data)
            if (np.abs(step) <= noise).all() or size >= 0.5 * previous:
                return Reached(here, 0.0, count + 2)
        previous = size
    return None
