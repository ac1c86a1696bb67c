r"""The hardpoint corrections that best explain a file, by least squares, and how well it determines them.

The corrections a (mm) minimise, within bounds,

    sum ((q_i(a) - m_i) / s_i)^2 + sum (a_j / prior)^2.

q_i are the computed numbers, m_i the numbers of the file, and s_i their standard deviations (see `problem`).

Let J = dq/da / s = U diag(w) V^T at the solution. The standard deviation of the combination V_k . a from the
file alone is f / w_k mm. f is the r.m.s. of the residual over the degrees of freedom, and at least 1, because
the file has no more digits than those given. If this deviation is not smaller than the prior and the bounds,
the file does not determine the combination: the prior keeps it as small as possible. The covariance of the
corrections that are not on a bound is V diag(1 / (w^2 / f^2 + 1 / prior^2)) V^T, with the others fixed on
their bounds. If f was estimated, the half width of the 95 % interval is a quantile of Student's t(freedom)
times the standard deviation; otherwise a quantile of the normal distribution.

Least squares are scipy's (dogleg in boxes, which ends on bounds exactly: Voglis and Lagaris, WSEAS Conference
on Applied Mathematics, 2004). The prior gives the Jacobian the full rank that the method needs. If a design
cannot be solved, or has no pose at a row, a shorter step is tried. The search has converged if the linear
problem at its end, within the bounds, would reduce the sum of squares by no more than SETTLED f^2: then no
combination is farther from the minimum than a tenth of its standard deviation.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import count

import numpy as np
from scipy.optimize import least_squares, lsq_linear
from scipy.special import ndtri, stdtrit

from pointcoord import PointcoordError, Scene
from validate.arrays import Array, Flags
from validate.fitting.problem import Problem
from validate.measured.poses import Found

# Relative to the sum of squares: the search ends if a step reduces the sum by less.
ENOUGH = 1e-9
SETTLED = 0.01
CONFIDENCE = 0.95
MOST_SOLVES = 60
AT_A_BOUND = 1e-9  # relative to the bounds: a correction this near to a bound lies on it

Told = Callable[[str, int], None]


@dataclass(frozen=True)
class Coordinate:
    """A free coordinate and its correction, mm.

    Attributes:
        deviation: standard deviation of the correction; 0 on a bound, where the correction is fixed.
        low, high: 95 % interval of the correction, within the bounds.
    """

    drawn: float
    correction: float
    corrected: float
    deviation: float
    low: float
    high: float
    on_bound: bool


@dataclass(frozen=True)
class Combination:
    """A direction in the space of corrections.

    Attributes:
        singular_value: change of the numbers for 1 mm along the direction, in their standard deviations.
        deviation: standard deviation from the file alone, mm; infinite if the file does not determine it.
        seen: whether the deviation is smaller than the bounds and the prior.
        parts: components by coordinate, of a unit vector.
    """

    singular_value: float
    deviation: float
    seen: bool
    parts: dict[str, float]


@dataclass(frozen=True)
class Fitted:
    """A column of the file before and after the fit, in our units.

    Attributes:
        before, after: r.m.s. difference.
        known_to: r.m.s. standard deviation of its numbers.
        count: number of the numbers used.
    """

    column: str
    unit: str
    before: float
    after: float
    known_to: float
    count: int


@dataclass(frozen=True)
class Fit:
    """The result of a fit.

    Attributes:
        scene: the corrected scene.
        coordinates: the free coordinates by name.
        columns: the columns of the file.
        combinations: the combinations of corrections, the best determined first.
        factor: f above: the residual in multiples of the rounding of the digits.
        freedom: degrees of freedom: number of numbers less number of combinations that they determine.
        left: sum of squares of the residual, in standard deviations of the numbers.
        largest: the largest residual, in standard deviations of its number.
        bounds, prior: mm.
        converged: whether least squares ended at a minimum.
        solves: number of designs tried.
        failures: the reasons why designs could not be solved, each once.
        notes: what was assumed because it is not given, and rows that were left out.
    """

    scene: Scene
    coordinates: dict[str, Coordinate]
    columns: tuple[Fitted, ...]
    combinations: tuple[Combination, ...]
    factor: float
    freedom: int
    left: float
    largest: float
    bounds: float
    prior: float
    converged: bool
    solves: int
    failures: tuple[str, ...]
    notes: tuple[str, ...]

    @property
    def unseen(self) -> tuple[Combination, ...]:
        """Combinations that the file does not determine: if there are any, the answer is not unique."""
        return tuple(one for one in self.combinations if not one.seen)

    @property
    def residual(self) -> float:
        """The r.m.s. residual over the degrees of freedom, in standard deviations of the numbers."""
        return math.sqrt(self.left / max(self.freedom, 1))

    @property
    def rms(self) -> dict[str, tuple[float, float, int]]:
        """By unit: r.m.s. difference before and after, over all columns of the unit; number of numbers."""
        found = {}
        for unit in dict.fromkeys(column.unit for column in self.columns):
            of = [column for column in self.columns if column.unit == unit]
            counts = np.array([column.count for column in of])
            ends = np.array([(column.before, column.after) for column in of])
            before, after = np.sqrt(np.average(ends**2, axis=0, weights=counts)).tolist()
            found[unit] = before, after, int(counts.sum())
        return found


def fit_hardpoints(
    problem: Problem, solves: int = MOST_SOLVES, told: Told = lambda words, count: None
) -> Fit:
    """Correct the free coordinates of a problem.

    Args:
        solves: largest number of designs tried; the fit then stops without convergence.
        told: is called for progress with a text and the number of designs tried.
    Raises:
        FileError: a number has no derivative at a design of the search.
    """
    bounds, prior = problem.bounds, problem.prior
    rows, zero = problem.measured.rows, np.zeros(len(problem.free))
    designs, tried, failures = {zero.tobytes(): problem.start}, count(1), dict[str, None]()

    def design(amounts: Array) -> Found:
        # Designs are kept: slopes are needed at the last one, or on a bound that is a rounding away from it.
        at = amounts.tobytes()
        if at not in designs:
            told(f"{(number := next(tried))} tried", number)
            designs[at] = problem.solved(amounts)
        return designs[at]

    def left(amounts: Array) -> Array:
        """The residual with corrections; NaN if the design cannot be solved or a row has no pose."""
        misfit = np.full(len(problem.spread), np.nan)
        try:
            there = design(amounts)
            misfit = problem.misfit(there)
            for _, row in np.argwhere(problem.used & ~np.isfinite(problem.numbers(there)))[:1].tolist():
                failures[f"{rows[row]}: {there.reasons.get(row, 'no number')}"] = None
        except PointcoordError as error:
            failures[str(error)] = None
        return np.concatenate([misfit, amounts / prior])

    def slopes(amounts: Array) -> Array:
        return np.concatenate([problem.slopes(design(amounts)), np.eye(len(zero)) / prior])

    solved = least_squares(
        left,
        zero,
        slopes,
        bounds=(-bounds, bounds),
        method="dogbox",
        xtol=1e-12,
        ftol=ENOUGH,
        gtol=1e-14,
        max_nfev=solves,
    )
    amounts, rest = np.asarray(solved.x), np.asarray(solved.fun)
    after = rest[: len(problem.spread)]
    matrix = np.asarray(solved.jac)[: len(after)]
    singular, turned = _known(matrix)
    loose: Flags = np.abs(amounts) < (1.0 - AT_A_BOUND) * bounds
    own, directions = _known(matrix[:, loose])
    freedom = len(after) - int((own > 1.0 / bounds).sum())
    factor = max(1.0, math.sqrt(float(after @ after) / freedom) if freedom > 0 else 1.0)
    deviations = np.zeros(len(zero))
    deviations[loose] = np.sqrt(directions.T**2 @ (1.0 / ((own / factor) ** 2 + prior**-2)))
    tail = 0.5 * (1.0 + CONFIDENCE)
    half = deviations * float(stdtrit(freedom, tail) if factor > 1.0 else ndtri(tail))
    points = problem.scene.mechanism.points
    ends = (name.rpartition(".") for name in problem.free)
    drawn = np.array([float(points[point]["xyz".index(axis)]) for point, _, axis in ends])
    low, high = np.maximum(amounts - half, -bounds), np.minimum(amounts + half, bounds)
    known = (part.tolist() for part in (drawn, amounts, drawn + amounts, deviations, low, high, ~loose))
    coordinates = [Coordinate(*one) for one in zip(*known, strict=True)]
    with np.errstate(divide="ignore"):
        by_file = factor / singular
    combinations = [
        Combination(w, d, d < min(bounds, prior), dict(zip(problem.free, row, strict=True)))
        for row, w, d in zip(turned.tolist(), singular.tolist(), by_file.tolist(), strict=True)
    ]
    better = lsq_linear(solved.jac, -rest, bounds=(-bounds - amounts, bounds - amounts))
    return Fit(
        scene=problem.corrected(amounts),
        coordinates=dict(zip(problem.free, coordinates, strict=True)),
        columns=_columns(problem, problem.misfit(problem.start), after),
        combinations=tuple(combinations),
        factor=factor,
        freedom=freedom,
        left=float(after @ after),
        largest=float(np.abs(after).max()),
        bounds=bounds,
        prior=prior,
        converged=bool(float(rest @ rest) - 2.0 * float(better.cost) <= SETTLED * factor**2),
        solves=int(solved.nfev),
        failures=tuple(failures),
        notes=problem.notes,
    )


def _known(matrix: Array) -> tuple[Array, Array]:
    """As many singular values as the matrix has columns, and the right singular vectors in rows."""
    _, found, vectors = np.linalg.svd(matrix, full_matrices=True)
    return np.concatenate([found, np.zeros(matrix.shape[1] - len(found))]), vectors


def _columns(problem: Problem, before: Array, after: Array) -> tuple[Fitted, ...]:
    """The columns of the file, from the misfits before and after, each (used,)."""
    measured = problem.measured
    which, _ = np.nonzero(problem.used)
    found = list[Fitted]()
    for i, s in enumerate(measured.numbers):
        here = which == i
        if here.any():
            known = problem.spread[here]
            first, last = (float(np.sqrt(np.mean((p[here] * known) ** 2))) for p in (before, after))
            known_to = float(np.sqrt(np.mean(known**2)))
            found.append(Fitted(s.column, s.meaning.unit, first, last, known_to, int(here.sum())))
    return tuple(found)
