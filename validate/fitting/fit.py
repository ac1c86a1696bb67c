r"""The hardpoint corrections that best explain a file, by least squares, and how well it determines them.

The corrections a (mm) minimise, within bounds,

    sum ((q_i(a) - m_i) / s_i)^2 + sum (a_j / prior)^2.

q_i are the computed numbers, m_i the numbers of the file, and s_i their standard deviations (see `problem`).

Let J = dq/da / s = U diag(w) V^T at the solution. The standard deviation of the combination V_k . a from the
file alone is f / w_k mm. f is the r.m.s. of the residual over the degrees of freedom, and at least 1, because
the file has no more digits than those given. If this deviation is not smaller than the prior and the bounds,
the file does not determine the combination: the prior keeps it as small as possible. The covariance of the
corrections that are not on a bound is (J^T J / f^2 + 1 / prior^2)^-1, with the others fixed on their bounds.
If f was estimated, the half width of the 95 % interval is a quantile of Student's t(freedom) times the
standard deviation; otherwise a quantile of the normal distribution.

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

import numpy as np
from scipy.optimize import least_squares, lsq_linear
from scipy.special import chdtri, ndtri, stdtrit

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
LEVEL = 1000.0
TWICE = 2.0 * math.sqrt(3.0)  # in standard deviations: twice the half unit of a rounded number

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
        coordinates: the free coordinates by name.
        columns: the columns of the file.
        combinations: the combinations of corrections, the best determined first.
        factor: f above: the residual in multiples of the rounding of the digits.
        freedom: degrees of freedom: number of numbers less number of combinations that they determine.
        rest: the residual, (numbers,), in standard deviations of the numbers.
        converged: whether least squares ended at a minimum.
        solves: number of designs tried.
        failures: the reasons why designs could not be solved, each once.
    """

    problem: Problem
    coordinates: dict[str, Coordinate]
    columns: tuple[Fitted, ...]
    combinations: tuple[Combination, ...]
    factor: float
    freedom: int
    rest: Array
    converged: bool
    solves: int
    failures: tuple[str, ...]

    @property
    def scene(self) -> Scene:
        """The corrected scene."""
        return self.problem.corrected([one.correction for one in self.coordinates.values()])

    @property
    def unseen(self) -> tuple[Combination, ...]:
        """Combinations that the file does not determine: if there are any, the answer is not unique."""
        return tuple(one for one in self.combinations if not one.seen)

    @property
    def left(self) -> float:
        """The sum of squares of the residual."""
        return float(self.rest @ self.rest)

    @property
    def residual(self) -> float:
        """The r.m.s. residual over the degrees of freedom, in standard deviations of the numbers."""
        return math.sqrt(self.left / max(self.freedom, 1))

    @property
    def explains(self) -> bool:
        """Whether rounding alone explains the residual."""
        return explains(self.rest, self.freedom)

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


def explains(rest: Array, freedom: int) -> bool:
    """Whether rounding alone explains a residual, in standard deviations.

    It does if its sum of squares is exceeded in at least one of LEVEL files, and no number is off by more
    than TWICE its rounding. The second condition is needed because least squares do not minimise the largest
    difference. The error of a rounded number is evenly distributed; its square scatters less than that of a
    normal error, so the chi-squared test is on the safe side.
    """
    small = freedom > 0 and float(rest @ rest) <= float(chdtri(freedom, 1.0 / LEVEL))
    return small and bool((np.abs(rest) <= TWICE).all())


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
    bounds, prior, zero = problem.bounds, problem.prior, np.zeros(len(problem.free))
    designs, failures = {zero.tobytes(): problem.start}, dict[str, None]()

    def design(amounts: Array) -> Found:
        # Designs are kept: slopes are needed at the last one, or on a bound that is a rounding away from it.
        at = amounts.tobytes()
        if at not in designs:
            told(f"{len(designs)} tried", len(designs))
            designs[at] = problem.solved(amounts)
        return designs[at]

    def left(amounts: Array) -> Array:
        """The residual with corrections; NaN if the design cannot be solved or a row has no pose."""
        misfit = np.full(len(problem.spread), np.nan)
        try:
            there = design(amounts)
            misfit = problem.misfit(there)
            failures.update(dict.fromkeys(problem.missing(there)))
        except PointcoordError as error:
            failures[str(error)] = None
        return np.concatenate([misfit, amounts / prior])

    def slopes(amounts: Array) -> Array:
        return np.concatenate([problem.slopes(design(amounts)), np.eye(len(zero)) / prior])

    ends = {"xtol": 1e-12, "ftol": ENOUGH, "gtol": 1e-14, "max_nfev": solves}
    solved = least_squares(left, zero, slopes, bounds=(-bounds, bounds), method="dogbox", **ends)
    amounts, rest, matrix = np.asarray(solved.x), solved.fun[: -len(zero)], solved.jac[: -len(zero)]
    loose: Flags = np.abs(amounts) < (1.0 - AT_A_BOUND) * bounds
    singular = np.linalg.svd(matrix[:, loose], compute_uv=False)
    freedom = len(rest) - int((singular > 1.0 / bounds).sum())
    factor = max(1.0, math.sqrt(float(rest @ rest) / freedom) if freedom > 0 else 1.0)
    deviations = np.zeros(len(zero))
    known = np.concatenate([matrix[:, loose] / factor, np.eye(int(loose.sum())) / prior])
    deviations[loose] = np.linalg.norm(np.linalg.pinv(known), axis=1)
    better = lsq_linear(solved.jac, -solved.fun, bounds=(-bounds - amounts, bounds - amounts))
    gain = float(solved.fun @ solved.fun) - 2.0 * float(better.cost)
    return Fit(
        problem=problem,
        coordinates=_coordinates(problem, amounts, deviations, loose, freedom if factor > 1.0 else None),
        columns=_columns(problem, problem.misfit(problem.start), rest),
        combinations=_combinations(problem, matrix, factor),
        factor=factor,
        freedom=freedom,
        rest=rest,
        converged=gain <= SETTLED * factor**2,
        solves=int(solved.nfev),
        failures=tuple(failures),
    )


def _coordinates(
    problem: Problem, amounts: Array, deviations: Array, loose: Flags, freedom: int | None
) -> dict[str, Coordinate]:
    """The coordinates with their corrections, (free,).

    Args:
        freedom: degrees of freedom, if the size of the errors was estimated from the residual.
    """
    bounds, tail = problem.bounds, 0.5 * (1.0 + CONFIDENCE)
    half = deviations * float(ndtri(tail) if freedom is None else stdtrit(freedom, tail))
    low, high = np.maximum(amounts - half, -bounds), np.minimum(amounts + half, bounds)
    points = problem.scene.mechanism.points
    ends = (name.rpartition(".") for name in problem.free)
    drawn = np.array([points[point]["xyz".index(axis)] for point, _, axis in ends])
    known = (part.tolist() for part in (drawn, amounts, drawn + amounts, deviations, low, high, ~loose))
    return {name: Coordinate(*one) for name, *one in zip(problem.free, *known, strict=True)}


def _combinations(problem: Problem, matrix: Array, factor: float) -> tuple[Combination, ...]:
    """The combinations of corrections, from the Jacobian, (numbers, free)."""
    _, singular, directions = np.linalg.svd(matrix, full_matrices=True)
    found, most = list[Combination](), min(problem.bounds, problem.prior)
    # There are as many directions as coordinates; those without a singular value change nothing.
    sizes = np.pad(singular, (0, len(directions) - len(singular)))
    for size, direction in zip(sizes.tolist(), directions.tolist(), strict=True):
        deviation, parts = factor / size if size else math.inf, zip(problem.free, direction, strict=True)
        found.append(Combination(size, deviation, deviation < most, dict(parts)))
    return tuple(found)


def _columns(problem: Problem, before: Array, after: Array) -> tuple[Fitted, ...]:
    """The columns of the file, from the misfits before and after, each (used,)."""
    which, _ = np.nonzero(problem.used)
    found = list[Fitted]()
    for i, s in enumerate(problem.measured.numbers):
        if count := int((here := which == i).sum()):
            known = problem.spread[here]
            ends = np.stack([known * before[here], known * after[here], known])
            first, last, known_to = np.sqrt(np.mean(ends**2, axis=1)).tolist()
            found.append(Fitted(s.column, s.meaning.unit, first, last, known_to, count))
    return tuple(found)
