r"""The hardpoint corrections that best explain a file, by least squares, and what it leaves open.

Corrections a (mm) make

    sum ((q_i(a) - m_i) / s_i)^2 + sum (a_j / prior)^2

least within bounds; q_i is ours, m_i the file's, and s_i their standard deviation (see `problem`).

With J = dq/da / s = U diag(w) V^T at the solution the file knows the combination V_k . a to f / w_k mm; f is
the r.m.s. of what is left over the degrees of freedom, at least 1, for more digits than these were not
given. A combination that it knows no better than the prior or the bounds do it cannot see: the prior settles
it, at as little as possible. The corrections' covariance is V diag(1 / (w^2 / f^2 + 1 / prior^2)) V^T, of
those that end on no bound, the others held there; where f was estimated, what holds in 95 of 100 files is
Student's t(freedom) times as wide as a standard deviation.

Least squares are scipy's (dogleg in boxes, which end on bounds exactly: Voglis and Lagaris, WSEAS Conference
on Applied Mathematics, 2004); the prior gives the Jacobian its full rank, which the method asks for. A design
that cannot be solved, or leaves a row without a pose, is a step too far, and a shorter one is tried. The
search has ended at a minimum if the linear problem there, within the bounds, would leave no more than
SETTLED f^2 less: then no combination is farther from its minimum than a tenth of its own deviation.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import count

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares, lsq_linear
from scipy.special import ndtri, stdtrit

from pointcoord import PointcoordError, Scene
from validate.fitting.problem import Design, Problem

Array = NDArray[np.float64]
Bools = NDArray[np.bool_]

# Parts of what is left: the search ends where a step lessens it by no more.
ENOUGH = 1e-9
SETTLED = 0.01
CONFIDENCE = 0.95
MOST_SOLVES = 60
AT_A_BOUND = 1e-9  # of the bounds, within which a correction lies on one

Told = Callable[[str, int], None]


@dataclass(frozen=True)
class Coordinate:
    """A coordinate that was free, mm.

    Attributes:
        deviation: of the correction; 0 on its bound, where it is held.
        low, high: where the correction lies in 95 of 100 files, within the bounds.
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
    """A direction in the corrections.

    Attributes:
        singular_value: what moving 1 mm along it does to the numbers, in their standard deviations.
        deviation: how well the file alone knows it, mm; infinite if not at all.
        seen: whether that is better than the bounds and the prior.
        parts: by coordinate, of unit length together.
    """

    singular_value: float
    deviation: float
    seen: bool
    parts: dict[str, float]


@dataclass(frozen=True)
class Fitted:
    """A column before and after, in our units.

    Attributes:
        before, after: r.m.s. difference. known_to: r.m.s. of what its numbers are known to.
        count: of numbers that were used.
    """

    column: str
    unit: str
    before: float
    after: float
    known_to: float
    count: int


@dataclass(frozen=True)
class Fit:
    """What came of fitting.

    Attributes:
        scene: corrected.
        coordinates: by name.
        columns: of the file.
        combinations: of the corrections, the best known first.
        factor: f above: how much more is left than the digits explain.
        freedom: how many more numbers there are than combinations that they know.
        left, largest: of what is left, in the numbers' standard deviations: sum of squares, and the largest.
        bounds, prior: mm.
        converged: whether least squares ended at a minimum.
        solves: how many designs were tried. failures: of these that could not be solved, why, each once.
        notes: what was taken without being told, and rows that were left out.
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
        """Combinations that the file cannot see: where there are any the answer is not unique."""
        return tuple(one for one in self.combinations if not one.seen)

    @property
    def rms(self) -> dict[str, tuple[float, float, int]]:
        """By unit: before and after, over all columns of it, and how many numbers these are."""
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
        solves: how many corrections are tried before it stops without having converged.
        told: is called with words and how many designs were tried.
    Raises:
        FileError: where the search comes by, a number has no slope.
    """
    bounds, prior = problem.bounds, problem.prior
    rows, zero = problem.measured.rows, np.zeros(len(problem.free))
    designs, tried, failures = {zero.tobytes(): problem.start}, count(1), dict[str, None]()

    def design(amounts: Array) -> Design:
        # Slopes are asked for where the search has just been, or on a bound that is a rounding away.
        at = amounts.tobytes()
        if at not in designs:
            told(f"{(number := next(tried))} tried", number)
            designs[at] = problem.solved(amounts)
        return designs[at]

    def left(amounts: Array) -> Array:
        """What is left by corrections, NaN where the design cannot be solved or a row has no pose."""
        misfit = np.full(len(problem.spread), np.nan)
        try:
            there = design(amounts)
            misfit = problem.misfit(there)
            if len(lost := np.flatnonzero(problem.used & ~np.isfinite(there.numbers)) % len(rows)):
                reason = there.found.reasons.get(int(lost[0]), "no number")
                failures[f"{rows[lost[0]]}: {reason}"] = None
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
    loose: Bools = np.abs(amounts) < (1.0 - AT_A_BOUND) * bounds
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
    """A singular value for every column of a matrix, and their right singular vectors in rows."""
    _, found, vectors = np.linalg.svd(matrix, full_matrices=True)
    return np.concatenate([found, np.zeros(matrix.shape[1] - len(found))]), vectors


def _columns(problem: Problem, before: Array, after: Array) -> tuple[Fitted, ...]:
    """What misfits were before and after, (used,) each, column by column."""
    measured = problem.measured
    which = np.repeat(np.arange(len(measured.numbers)), len(measured.rows))[problem.used]
    found = list[Fitted]()
    for i, s in enumerate(measured.numbers):
        here = which == i
        if here.any():
            known = problem.spread[here]
            first, last = (float(np.sqrt(np.mean((p[here] * known) ** 2))) for p in (before, after))
            known_to = float(np.sqrt(np.mean(known**2)))
            found.append(Fitted(s.column, s.meaning.unit, first, last, known_to, int(here.sum())))
    return tuple(found)
