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
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares, lsq_linear
from scipy.special import ndtri, stdtrit

from pointcoord import PointcoordError, Scene, UnknownName, designs_of
from validate.errors import UsageError
from validate.fitting.curves import Curves
from validate.measured.mapping import Measured
from validate.measured.poses import Found, at_either_end
from validate.plain_text import shown
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
# Parts of what is left: the search ends where a step lessens it by no more.
ENOUGH = 1e-9
SETTLED = 0.01
CONFIDENCE = 0.95
# Of the bounds, or of the prior if that is less: how far a correction may go along what the file cannot see,
# where it is asked what the file alone knows. So a coordinate is unknown that has a quarter of such a
# combination.
OPEN = 4.0
MOST_SOLVES = 60
NAMED = 3  # rows that are left out, one by one
KEPT = 3  # solved designs that are remembered
AT_A_BOUND = 1e-9  # of the bounds, within which a correction lies on one


@dataclass(frozen=True)
class Combination:
    """A direction in the corrections.

    Attributes:
        parts: by coordinate, of unit length together.
        singular: what moving 1 mm along it does to the numbers, in their standard deviations.
        deviation: how well the file alone knows it, mm; infinite if not at all.
        seen: whether that is better than the bounds and the prior.
    """

    parts: dict[str, float]
    singular: float
    deviation: float
    seen: bool


@dataclass(frozen=True)
class Fitted:
    """A column before and after, in our units.

    Attributes:
        before, after: r.m.s. difference. digits: r.m.s. of what its numbers are known to.
        count: of numbers that were used.
    """

    column: str
    unit: str
    before: float
    after: float
    digits: float
    count: int


@dataclass(frozen=True)
class Fit:
    """What came of fitting.

    Attributes:
        scene: corrected.
        drawn, corrections: by coordinate, mm.
        deviations: by coordinate, mm; of one on its bound 0: it is held there.
        unknown: coordinates that the file alone does not know to within the bounds and the prior.
        widening: how many deviations to either side hold in 95 of 100 files.
        columns: of the file.
        combinations: of the corrections, the best known first.
        factor: f above: how much more is left than the digits explain.
        freedom: how many more numbers there are than combinations that they know.
        bounds, prior: mm.
        converged: whether least squares ended at a minimum.
        solves: how many designs were tried. failures: of these that could not be solved, why, each once.
        notes: what was taken without being told, and rows that were left out.
    """

    scene: Scene
    drawn: dict[str, float]
    corrections: dict[str, float]
    deviations: dict[str, float]
    unknown: tuple[str, ...]
    widening: float
    columns: tuple[Fitted, ...]
    combinations: tuple[Combination, ...]
    factor: float
    freedom: int
    bounds: float
    prior: float
    converged: bool
    solves: int
    failures: tuple[str, ...]
    notes: tuple[str, ...]

    @property
    def unseen(self) -> tuple[Combination, ...]:
        """Combinations that the file cannot see."""
        return tuple(one for one in self.combinations if not one.seen)

    @property
    def unique(self) -> bool:
        """Whether the file alone settles every correction, to within the bounds and better than the prior."""
        return not self.unseen

    @property
    def on_bounds(self) -> tuple[str, ...]:
        """Coordinates whose correction would go farther if it could."""
        return tuple(n for n, amount in self.corrections.items() if _on_bound(amount, self.bounds))

    def interval(self, coordinate: str) -> tuple[float, float]:
        """Where the correction lies in 95 of 100 files, mm, and within the bounds."""
        half, amount = self.widening * self.deviations[coordinate], self.corrections[coordinate]
        return max(amount - half, -self.bounds), min(amount + half, self.bounds)

    def rms(self, unit: str) -> tuple[float, float, int]:
        """Before and after, over all columns of a unit, and how many numbers these are."""
        some = [column for column in self.columns if column.unit == unit]
        count = sum(column.count for column in some)
        before, after = (
            math.sqrt(sum(getattr(column, when) ** 2 * column.count for column in some) / max(count, 1))
            for when in ("before", "after")
        )
        return before, after, count


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
    measured, left_out = _without_derivatives(measured)
    curves = Curves(scene, measured, free_coordinates(scene, free))
    zero = np.zeros(len(curves.free))
    start = curves.solved(zero)
    first, theirs = curves.numbers(start), np.concatenate([s.values for s in measured.numbers])
    used: Bools = np.isfinite(first) & np.isfinite(theirs)
    if not used.any():
        why = next(iter(start.reasons.values()), "no number is both there and ours")
        allowed = "rows that the scene's car can have"
        raise FileError(measured.source, "", f"no row can be used ({why})", allowed)
    spread = _spread(curves, accuracy)[used]
    turns = np.concatenate([np.full(len(s.values), s.meaning.unit == "rad") for s in measured.numbers])[used]
    search = _Search(curves, used, {zero.tobytes(): start}, told)

    def gap(numbers: Array) -> Array:
        """Ours less theirs; whole turns apart is the same angle."""
        apart = numbers[used] - theirs[used]
        return np.asarray(np.where(turns, (apart + np.pi) % (2.0 * np.pi) - np.pi, apart))

    def left(amounts: Array) -> Array:
        return np.concatenate([gap(search.numbers(amounts)) / spread, amounts / prior])

    def slopes(amounts: Array) -> Array:
        known = curves.slopes(amounts, used) / spread[:, None]
        return np.concatenate([known, np.eye(len(zero)) / prior])

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
    amounts = np.asarray(solved.x)
    after = gap(search.numbers(amounts))
    whole, rest = slopes(amounts), left(amounts)
    matrix = whole[: len(after)]
    _, singular, turned = np.linalg.svd(matrix, full_matrices=True)
    singular = np.concatenate([singular, np.zeros(len(zero) - len(singular))])
    held: Bools = np.array([_on_bound(amount, bounds) for amount in amounts.tolist()])
    _, own, directions = np.linalg.svd(matrix[:, ~held], full_matrices=True)
    own = np.concatenate([own, np.zeros(int((~held).sum()) - len(own))])
    freedom = len(after) - int((own > 1.0 / bounds).sum())
    estimated = math.sqrt(float(np.sum((after / spread) ** 2)) / freedom) if freedom > 0 else 1.0
    factor = max(1.0, estimated)
    with np.errstate(divide="ignore"):
        deviations = factor / singular
    known = min(bounds, prior)  # beforehand
    variance, alone = np.zeros(len(zero)), np.zeros(len(zero))
    variance[~held] = directions.T**2 @ (1.0 / ((own / factor) ** 2 + prior**-2))
    alone[~held] = directions.T**2 @ (1.0 / ((own / factor) ** 2 + (OPEN * known) ** -2))
    tail = 0.5 * (1.0 + CONFIDENCE)
    better = lsq_linear(whole, -rest, bounds=(-bounds - amounts, bounds - amounts))
    return Fit(
        curves.design(amounts),
        {name: _place(scene, name) for name in curves.free},
        dict(zip(curves.free, amounts.tolist(), strict=True)),
        dict(zip(curves.free, np.sqrt(variance).tolist(), strict=True)),
        tuple(
            name for name, open_ in zip(curves.free, np.sqrt(alone).tolist(), strict=True) if open_ >= known
        ),
        float(stdtrit(freedom, tail) if factor > 1.0 else ndtri(tail)),
        _columns(measured, used, gap(first), after, spread),
        tuple(
            Combination(
                dict(zip(curves.free, row.tolist(), strict=True)), float(w), float(d), bool(d < known)
            )
            for row, w, d in zip(turned, singular, deviations, strict=True)
        ),
        factor,
        freedom,
        bounds,
        prior,
        bool(float(rest @ rest) - 2.0 * float(better.cost) <= SETTLED * factor**2),
        int(solved.nfev),
        tuple(search.failures),
        (*left_out, *_notes(curves, start)),
    )


def _without_derivatives(measured: Measured) -> tuple[Measured, tuple[str, ...]]:
    """The file without columns that are derivatives, and that they are left out.

    Raises:
        FileError: there are no others.
    """
    curves = tuple(s for s in measured.numbers if not s.meaning.per)
    slopes = [shown(s.column) for s in measured.numbers if s.meaning.per]
    if not curves:
        problem = f"holds derivatives only ({', '.join(slopes)})"
        raise FileError(measured.source, "", problem, "the curves themselves, such as an angle over travel")
    notes = [f"{', '.join(slopes)} is not fitted to: derivatives are not, their curves are"] if slopes else []
    return replace(measured, numbers=curves), tuple(notes)


def _notes(curves: Curves, start: Found) -> tuple[str, ...]:
    """Inputs that the file does not give, and rows that are left out."""
    drawn = [
        f"{name} is as drawn in every design: the file does not give it" for name in curves.driven.as_drawn
    ]
    lost = [
        f"{curves.measured.rows[row]} is left out: {reason}" for row, reason in sorted(start.reasons.items())
    ]
    more = [f"{len(lost) - NAMED} more rows are left out"] if len(lost) > NAMED else []
    return (*drawn, *lost[:NAMED], *more)


class _Search:
    """Designs that least squares ask for, each solved once."""

    def __init__(
        self, curves: Curves, used: Bools, solved: dict[bytes, Found], told: Callable[[str, int], None]
    ) -> None:
        self.curves, self.used, self.told = curves, used, told
        self.tried = 0
        self.failures: dict[str, None] = {}
        self._solved = solved

    def numbers(self, amounts: Array) -> Array:
        """Of every column, NaN where a design has no pose."""
        try:
            found = self._design(amounts)
        except PointcoordError as error:
            self.failures[str(error)] = None
            return np.full(len(self.used), np.nan)
        numbers = self.curves.numbers(found)
        lost = np.flatnonzero(self.used & ~np.isfinite(numbers))
        if len(lost):
            rows = self.curves.measured.rows
            row = int(lost[0]) % len(rows)
            self.failures[f"{rows[row]}: {found.reasons.get(row, 'no number')}"] = None
        return numbers

    def _design(self, amounts: Array) -> Found:
        key = amounts.tobytes()
        if key not in self._solved:
            self.tried += 1
            self.told(f"{self.tried} tried", self.tried)
            solved = self.curves.solved(amounts)
            # A rejected step is followed by a shorter one from the last that was taken.
            self._solved = dict([*self._solved.items()][-KEPT:]) | {key: solved}
        return self._solved[key]


def _on_bound(amount: float, bounds: float) -> bool:
    return abs(amount) >= (1.0 - AT_A_BOUND) * bounds


def _place(scene: Scene, coordinate: str) -> float:
    point, _, axis = coordinate.partition(".")
    return float(scene.mechanism.points[point]["xyz".index(axis)])


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
    found: list[str] = []
    for name in free:
        point, dot, axis = name.partition(".")
        if point not in drawn:
            raise UnknownName("point", point, tuple(drawn))
        if dot and (len(axis) != 1 or axis not in "xyz"):
            raise UnknownName(f"axis of {point}", axis, tuple("xyz"))
        found += [name] if dot else [f"{name}.{axis}" for axis in "xyz"]
    twice = next((name for name in found if found.count(name) > 1), "")
    if twice:
        raise UsageError(f"--free: {twice} is there twice; allowed: each coordinate once")
    return tuple(found)


def _spread(curves: Curves, accuracy: float) -> Array:
    """Standard deviation of every number, (columns * rows,)."""
    measured = curves.measured
    zero = np.zeros(len(curves.free))
    values = [s.values for s in measured.independent]
    swing = np.zeros(len(values[0]) * len(measured.numbers))
    here = curves.at(zero)
    for _, ends in at_either_end(values, [s.off for s in measured.independent]):
        gaps = [np.nan_to_num(np.abs(curves.at(zero, end) - here)) for end in ends]
        swing += np.max(gaps, axis=0)
    off = np.concatenate([s.off + s.accuracy_or(accuracy) for s in measured.numbers])
    least = np.concatenate(
        [np.full(len(s.values), LEAST[s.meaning.unit.partition("/")[0]]) for s in measured.numbers]
    )
    return np.asarray(np.maximum((off + swing) / math.sqrt(3.0), least))


def _columns(
    measured: Measured, used: Bools, before: Array, after: Array, spread: Array
) -> tuple[Fitted, ...]:
    """What was before and after, column by column; the three are of the used numbers."""
    which = np.repeat(np.arange(len(measured.numbers)), len(measured.rows))[used]
    found = []
    for i, s in enumerate(measured.numbers):
        mine = which == i
        if mine.any():
            rms = [float(np.sqrt(np.mean(part[mine] ** 2))) for part in (before, after, spread)]
            found.append(Fitted(s.column, s.meaning.unit, rms[0], rms[1], rms[2], int(mine.sum())))
    return tuple(found)
