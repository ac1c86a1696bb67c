r"""The hardpoint corrections that best explain a file, by least squares, and what it leaves open.

Corrections a (mm) make

    sum ((q_i(a) - m_i) / s_i)^2 + sum (a_j / prior)^2

least within bounds; q_i is ours, m_i the file's. A number rounded to its last digit is evenly spread over its
half unit h_i, and has the standard deviation h_i / sqrt(3); so has what the rounding of the independent
columns does to it, and the accuracy that the user states:

    s_i = (h_i + S_i + a_i) / sqrt(3), and at least LEAST.

With J = dq/da / s = U diag(w) V^T at the solution the file knows the combination V_k . a to f / w_k mm; f is
the r.m.s. of what is left over the degrees of freedom, at least 1, for more digits than these were not
given. A combination that it knows no better than to the bounds it cannot see: the prior alone settles it, at
as little as possible. The corrections' covariance is V diag(1 / (w^2 / f^2 + 1 / prior^2)) V^T.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from pointcoord import Scene, UnknownName, designs_of
from pointcoord.data_classes import dataclass
from validate.fitting.curves import STEP, Curves
from validate.fitting.errors import FitError
from validate.measured.mapping import Measured

Array = NDArray[np.float64]
Bools = NDArray[np.bool_]

BOUNDS, PRIOR = 25.0, 100.0  # mm
# What a number is known to at best, however many digits it has: 0.1 um, and what that is on a wheel.
LEAST = {"mm": 1e-4, "rad": 3e-7}
# Of what is left: corrections that change it by less are within a thousandth of their own deviation.
ENOUGH = 1e-6
MOST_SOLVES = 60
AT_A_BOUND = 1e-3  # of the bounds, within which a correction lies on one


@dataclass(frozen=True)
class Combination:
    """A direction in the corrections.

    Attributes:
        parts: by coordinate, of unit length together.
        singular: what moving 1 mm along it does to the numbers, in their standard deviations.
        deviation: how well the file alone knows it, mm; infinite if not at all.
        seen: whether that is better than the bounds.
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
        corrections, deviations: by coordinate, mm.
        columns: of the file.
        combinations: of the corrections, the best known first.
        factor: f above: how much more is left than the digits explain.
        bounds, prior: mm.
        truncation: largest error of the slopes by their step, in parts of the largest slope of its
            coordinate.
        converged: whether least squares ended at a minimum.
        notes: rows that were left out.
    """

    scene: Scene
    corrections: dict[str, float]
    deviations: dict[str, float]
    columns: tuple[Fitted, ...]
    combinations: tuple[Combination, ...]
    factor: float
    bounds: float
    prior: float
    truncation: float
    converged: bool
    notes: tuple[str, ...]

    @property
    def unseen(self) -> tuple[Combination, ...]:
        """Combinations that the file cannot see."""
        return tuple(one for one in self.combinations if not one.seen)

    @property
    def unique(self) -> bool:
        """Whether the file alone settles every correction to within the bounds."""
        return not self.unseen

    @property
    def on_bounds(self) -> tuple[str, ...]:
        """Coordinates whose correction would go farther if it could."""
        least = (1.0 - AT_A_BOUND) * self.bounds
        return tuple(name for name, amount in self.corrections.items() if abs(amount) >= least)

    def rms(self, unit: str) -> tuple[float, float, int]:
        """Before and after, over all columns of a unit, and how many numbers these are."""
        some = [column for column in self.columns if column.unit == unit]
        count = sum(column.count for column in some)
        before, after = (
            math.sqrt(sum(getattr(column, when) ** 2 * column.count for column in some) / max(count, 1))
            for when in ("before", "after")
        )
        return before, after, count


def fit_hardpoints(
    scene: Scene,
    measured: Measured,
    free: Sequence[str] = (),
    bounds: float = BOUNDS,
    prior: float = PRIOR,
    accuracy: float = 0.0,
    solves: int = MOST_SOLVES,
) -> Fit:
    """Fit a scene's hardpoints to a file.

    Args:
        free: coordinates such as lower_ball_joint.z, or points for all three; empty: of every point.
        bounds: that corrections keep, mm.
        prior: how far off hardpoints are thought to be, a standard deviation, mm.
        accuracy: how far off the file's numbers may be beside their digits, each in its own unit.
        solves: how many corrections are tried before it stops without having converged.
    Raises:
        UnknownName: no point or axis is called so.
        FitError: bounds or prior no number above 0, or fewer numbers than none.
        PointcoordError: the scene as drawn cannot be solved.
    """
    for name, value in (("the bounds", bounds), ("the prior", prior)):
        if not (math.isfinite(value) and value > 0.0):
            raise FitError(name, f"is {value:g} mm", "a finite number above 0")
    curves = Curves(scene, measured, free_coordinates(scene, free))
    zero = np.zeros(len(curves.free))
    found = curves.found(zero)
    first, theirs = curves.read(found), np.concatenate([s.values for s in measured.numbers])
    used: Bools = np.isfinite(first) & np.isfinite(theirs)
    if not used.any():
        why = next(iter(found.reasons.values()), "no number is both there and ours")
        raise FitError(measured.source, f"no row can be used ({why})", "rows that the scene's car can have")
    spread = _spread(curves, accuracy)[used]
    turns = np.concatenate([np.full(len(s.values), s.meaning.unit == "rad") for s in measured.numbers])[used]

    def gap(numbers: Array) -> Array:
        """Ours less theirs; whole turns apart is the same angle."""
        apart = numbers[used] - theirs[used]
        return np.asarray(np.where(turns, (apart + np.pi) % (2.0 * np.pi) - np.pi, apart))

    def left(amounts: Array) -> Array:
        return np.concatenate([gap(curves.at(amounts)) / spread, amounts / prior])

    def slopes(amounts: Array) -> Array:
        known = curves.slopes(amounts, used) / spread[:, None]
        return np.concatenate([known, np.eye(len(zero)) / prior])

    solved = least_squares(
        left, zero, slopes, bounds=(-bounds, bounds), xtol=1e-8, ftol=ENOUGH, gtol=1e-12, max_nfev=solves
    )
    amounts = np.asarray(solved.x)
    matrix = curves.slopes(amounts, used) / spread[:, None]
    coarse = curves.slopes(amounts, used, 2.0 * STEP) / spread[:, None]
    after = gap(curves.at(amounts))
    rest = float(np.sum((after / spread) ** 2))
    _, singular, turned = np.linalg.svd(matrix, full_matrices=True)
    singular = np.concatenate([singular, np.zeros(len(zero) - len(singular))])
    freedom = len(after) - int((singular > 1.0 / bounds).sum())
    factor = max(1.0, math.sqrt(rest / freedom)) if freedom > 0 else 1.0
    with np.errstate(divide="ignore"):
        deviations = factor / singular
    variance = turned.T**2 @ (1.0 / ((singular / factor) ** 2 + prior**-2))
    largest = np.abs(matrix).max(axis=0)
    apart = np.abs(coarse - matrix).max(axis=0) / 3.0
    seen_at_all = largest > 1e-6 * largest.max()
    return Fit(
        curves.design(amounts),
        dict(zip(curves.free, amounts.tolist(), strict=True)),
        dict(zip(curves.free, np.sqrt(variance).tolist(), strict=True)),
        _columns(measured, used, gap(first), after, spread),
        tuple(
            Combination(
                dict(zip(curves.free, row.tolist(), strict=True)), float(w), float(d), bool(d < bounds)
            )
            for row, w, d in zip(turned, singular, deviations, strict=True)
        ),
        factor,
        bounds,
        prior,
        float(np.max(apart[seen_at_all] / largest[seen_at_all], initial=0.0)),
        bool(solved.status > 0),
        tuple(f"{measured.rows[row]} is left out: {reason}" for row, reason in sorted(found.reasons.items())),
    )


def free_coordinates(scene: Scene, free: Sequence[str]) -> tuple[str, ...]:
    """Coordinates by their names; a point is all three of its own; none: all that a drawing is free to have.

    A rack that goes along with the end of its tie rod is not free.

    Raises:
        UnknownName: no point or axis is called so.
        FitError: one is there twice.
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
        raise FitError("--free", f"{twice} is there twice", "each coordinate once")
    return tuple(found)


def _spread(curves: Curves, accuracy: float) -> Array:
    """Standard deviation of every number, (columns * rows,)."""
    measured = curves.measured
    zero = np.zeros(len(curves.free))
    values = [s.values for s in measured.independent]
    swing = np.zeros(len(values[0]) * len(measured.numbers))
    here = curves.at(zero)
    for i, s in enumerate(measured.independent):
        if s.off.any():
            ends = [
                curves.at(zero, [v + side * s.off if k == i else v for k, v in enumerate(values)])
                for side in (-1.0, 1.0)
            ]
            swing += np.max([np.nan_to_num(np.abs(end - here)) for end in ends], axis=0)
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
