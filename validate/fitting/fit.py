r"""The hardpoint corrections that best explain a file, by least squares, and what it leaves open.

Corrections a (mm) make

    sum ((q_i(a) - m_i) / s_i)^2 + sum (a_j / prior)^2

least within bounds; q_i is ours, m_i the file's. A number rounded to its last digit is evenly spread over its
half unit h_i, and has the standard deviation h_i / sqrt(3); so has what the rounding of the independent
columns does to it, and the accuracy that the user states:

    s_i = (h_i + S_i + a_i) / sqrt(3), and at least LEAST.

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
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import count

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares, lsq_linear
from scipy.special import ndtri, stdtrit

from pointcoord import PointcoordError, Scene, designs_of
from pointcoord.sweeping.designs import coordinates_named
from validate.errors import UsageError
from validate.extras import needed
from validate.fitting.curves import Curves
from validate.measured.mapping import Measured
from validate.measured.poses import Found, at_either_end
from validate.measured.tolerances import out_of_reach
from validate.tables.errors import FileError

Array = NDArray[np.float64]
Bools = NDArray[np.bool_]

BOUNDS = 25.0  # mm, that no hardpoint of a drawing of this car is off by
# Then they are five standard deviations out, which of 1e6 coordinates less than one is beyond. A wider prior
# lets rounding of digits move hardpoints along what the file hardly sees: with 100 mm by 24 mm together where
# one is off by 5, in a table of four decimals.
PRIOR = BOUNDS / 5.0
# What a number is known to at best, however many digits it has: 0.1 um, and what that is on a wheel.
LEAST = {"mm": 1e-4, "rad": 3e-7}
OTHERS = 1e-4  # N or %
# Parts of what is left: the search ends where a step lessens it by no more.
ENOUGH = 1e-9
SETTLED = 0.01
CONFIDENCE = 0.95
MOST_SOLVES = 60
ENDS = ("before", "after")
AT_A_BOUND = 1e-9  # of the bounds, within which a correction lies on one


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
        some = needed("fit", "pandas").DataFrame([vars(column) for column in self.columns])
        found = {}
        for unit, of in some.groupby("unit", sort=False):
            before, after = (float(np.sqrt(np.average(of[k] ** 2, weights=of["count"]))) for k in ENDS)
            found[str(unit)] = before, after, int(of["count"].sum())
        return found


def require_limits(bounds: float, prior: float, accuracy: float, mark: str = "") -> None:
    """Refuse limits of a fit that are none.

    Args:
        mark: what stands before the name of each where it is told, such as that of an option.
    Raises:
        UsageError: one is no finite number, or too small.
    """
    for name, value in (("bounds", bounds), ("prior", prior), ("accuracy", accuracy)):
        zero = name == "accuracy"
        if not (math.isfinite(value) and (value > 0.0 or (zero and value == 0.0))):
            least = "from 0 up" if zero else "above 0"
            raise UsageError(f"{mark}{name} is {value:g}; allowed: a finite number {least}")


@dataclass(frozen=True)
class Problem:
    """A file's numbers beside those of the car as drawn, in standard deviations s_i.

    Attributes:
        start: the car as drawn. first: its numbers, (columns * rows,).
        used: which of these both have, likewise. spread: s_i of the used ones.
    """

    curves: Curves
    start: Found
    first: Array
    used: Bools
    spread: Array

    @classmethod
    def of(cls, scene: Scene, measured: Measured, free: Sequence[str], accuracy: float) -> Problem:
        """See `fit_hardpoints`."""
        curves = Curves(scene, measured, free_coordinates(scene, free))
        start = curves.solved(np.zeros(len(curves.free)))
        first, theirs = curves.numbers(start), np.concatenate([s.values for s in measured.numbers])
        used: Bools = np.isfinite(first) & np.isfinite(theirs)
        if not used.any():
            why = next(iter(start.reasons.values()), "no number is both there and ours")
            allowed = "rows that the scene's car can have"
            raise FileError(measured.source, "", f"no row can be used ({why})", allowed)
        return cls(curves, start, first, used, _spread(curves, first, accuracy)[used])

    def misfit(self, numbers: Array) -> Array:
        """Ours less theirs, (used,); whole turns apart is the same angle."""
        series = self.curves.measured.numbers
        columns = zip(series, numbers.reshape(len(series), -1), strict=True)
        apart = np.concatenate([s.apart(own, s.values) for s, own in columns])
        return np.asarray(apart[self.used] / self.spread)

    def slopes(self, amounts: Array) -> Array:
        """How it changes with each coordinate, (used, free), 1/mm."""
        return self.curves.slopes(amounts, self.used) / self.spread[:, None]


def fit_hardpoints(
    scene: Scene,
    measured: Measured,
    free: Sequence[str] = (),
    bounds: float = BOUNDS,
    prior: float = PRIOR,
    accuracy: float = 0.0,
    solves: int = MOST_SOLVES,
    told: Callable[[str, int], None] = lambda words, count: None,
) -> Fit:
    """Fit a scene's hardpoints to a file.

    Args:
        free: coordinates such as lower_ball_joint.z, or points for all three; empty: of every point.
        bounds: that corrections keep, mm, above 0.
        prior: how far off hardpoints are thought to be, a standard deviation, mm, above 0.
        accuracy: how far off the file's numbers may be beside their digits, each in its own unit.
        solves: how many corrections are tried before it stops without having converged.
        told: is called with words and how many designs were tried.
    Raises:
        UnknownName: no point or axis is called so.
        UsageError: a coordinate is there twice, or bounds, prior or accuracy are none.
        FileError: no number of the file can be used.
        PointcoordError: the scene as drawn cannot be solved.
    """
    require_limits(bounds, prior, accuracy)
    problem = Problem.of(scene, measured, free, accuracy)
    curves, start, spread, used = problem.curves, problem.start, problem.spread, problem.used
    zero, first = np.zeros(len(curves.free)), problem.first
    tried, failures = count(1), dict[str, None]()

    def left(amounts: Array) -> Array:
        """What is left by corrections, NaN where the design cannot be solved or a row has no pose."""
        numbers = first if not amounts.any() else np.full(len(first), np.nan)
        if amounts.any():
            told(f"{(at := next(tried))} tried", at)
            try:
                found = curves.solved(amounts)
                numbers = curves.numbers(found)
                if len(lost := np.flatnonzero(used & ~np.isfinite(numbers)) % len(measured.rows)):
                    reason = found.reasons.get(int(lost[0]), "no number")
                    failures[f"{measured.rows[lost[0]]}: {reason}"] = None
            except PointcoordError as error:
                failures[str(error)] = None
        return np.concatenate([problem.misfit(numbers), amounts / prior])

    def slopes(amounts: Array) -> Array:
        return np.concatenate([problem.slopes(amounts), np.eye(len(zero)) / prior])

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
    after = rest[: len(spread)]
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
    ends = (name.rpartition(".") for name in curves.free)
    drawn = np.array([float(scene.mechanism.points[point]["xyz".index(axis)]) for point, _, axis in ends])
    low, high = np.maximum(amounts - half, -bounds), np.minimum(amounts + half, bounds)
    known = (part.tolist() for part in (drawn, amounts, drawn + amounts, deviations, low, high, ~loose))
    coordinates = [Coordinate(*one) for one in zip(*known, strict=True)]
    with np.errstate(divide="ignore"):
        by_file = factor / singular
    combinations = [
        Combination(w, d, d < min(bounds, prior), dict(zip(curves.free, row, strict=True)))
        for row, w, d in zip(turned.tolist(), singular.tolist(), by_file.tolist(), strict=True)
    ]
    better = lsq_linear(solved.jac, -rest, bounds=(-bounds - amounts, bounds - amounts))
    return Fit(
        scene=curves.design(amounts),
        coordinates=dict(zip(curves.free, coordinates, strict=True)),
        columns=_columns(measured, used, problem.misfit(first) * spread, after * spread, spread),
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
        notes=(*curves.driven.notes, *out_of_reach(measured, start)),
    )


def _known(matrix: Array) -> tuple[Array, Array]:
    """A singular value for every column of a matrix, and their right singular vectors in rows."""
    _, found, vectors = np.linalg.svd(matrix, full_matrices=True)
    return np.concatenate([found, np.zeros(matrix.shape[1] - len(found))]), vectors


def free_coordinates(scene: Scene, free: Sequence[str]) -> tuple[str, ...]:
    """Coordinates by their names; a point is all three of its own; none: all that a drawing is free to have.

    A rack that goes along with the end of its tie rod is not free.

    Raises:
        UnknownName: no point or axis is called so.
        UsageError: one is there twice.
    """
    topology, drawn = scene.mechanism.topology, scene.mechanism.points
    if not free:
        every = {f"{name}.{axis}": 0.0 for name in topology.required_points for axis in "xyz"}
        going = designs_of(scene, offsets=every).following
        free = [name for name in drawn if name not in going]
    found = [coordinate for name in free for coordinate in coordinates_named(name, drawn)]
    twice = next((name for name in found if found.count(name) > 1), "")
    if twice:
        raise UsageError(f"--free: {twice} is there twice; allowed: each coordinate once")
    return tuple(found)


def _spread(curves: Curves, here: Array, accuracy: float) -> Array:
    """Standard deviation of every number of the car as drawn, (columns * rows,)."""
    measured, zero = curves.measured, np.zeros(len(curves.free))
    values, swing = [s.values for s in measured.independent], np.zeros(len(here))
    for _, ends in at_either_end(values, [s.off for s in measured.independent]):
        swing += np.max([np.nan_to_num(np.abs(curves.at(zero, end) - here)) for end in ends], axis=0)
    off = np.concatenate([s.off + s.accuracy_or(accuracy) for s in measured.numbers])
    least = [LEAST.get(s.meaning.unit.partition("/")[0], OTHERS) for s in measured.numbers]
    return np.asarray(np.maximum((off + swing) / math.sqrt(3.0), np.repeat(least, len(measured.rows))))


def _columns(
    measured: Measured, used: Bools, before: Array, after: Array, spread: Array
) -> tuple[Fitted, ...]:
    """What was before and after, column by column; the three are of the used numbers."""
    which, found = np.repeat(np.arange(len(measured.numbers)), len(measured.rows))[used], list[Fitted]()
    for i, s in enumerate(measured.numbers):
        here = which == i
        if here.any():
            first, last, known = (float(np.sqrt(np.mean(p[here] ** 2))) for p in (before, after, spread))
            count = int(here.sum())
            found.append(Fitted(s.column, s.meaning.unit, first, last, known, count))
    return tuple(found)
