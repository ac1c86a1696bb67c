r"""Which few hardpoint coordinates, moved, would explain a file: a diagnosis, that corrects nothing.

Every coordinate that the file sees is fitted alone, then sets of two and of three, until some sets of a size
explain the file. Not all sets are fitted. With r the misfit and J its slopes, both in standard deviations
(see `fit`), a set S leaves in the linear problem

    |r|^2 - g_S . (J_S^T J_S + 1 / prior^2)^-1 g_S,    g_S = J_S^T r.

Of each size those that leave least are fitted: of all sets, by the slopes of the car as drawn, and of the
best of the size before with one more coordinate, by the slopes where that one ended.

A set explains the file if its sum of squares is one that rounding exceeds in one of LEVEL files, and no
number is farther off than TWICE what its digits allow, for least squares make no largest difference least. A
number that is evenly spread over its half unit has squares that scatter less than those of a normal one, so
that chi-squared is on the safe side. Two sets explain it equally well if their sums of squares differ by less
than what one coordinate more explains of nothing but rounding in 95 of 100 files.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtri

from pointcoord import PointcoordError, Scene
from validate.fitting.fit import BOUNDS, CONFIDENCE, PRIOR, Fit, Problem, fit_hardpoints, require_limits
from validate.measured.mapping import Measured
from validate.measured.tolerances import out_of_reach

Array = NDArray[np.float64]
Set = tuple[str, ...]

LARGEST = 3  # coordinates of a set: a point that is misread
LEVEL = 1000.0
TWICE = 2.0 * math.sqrt(3.0)  # standard deviations of a number that is rounded
# Sets of a size that are fitted by the slopes of the drawing, and as many beside a better start.
CANDIDATES = 12
STARTS = 3  # sets that one more coordinate is put to
SHOWN = 8  # sets that explain nothing are kept for being nearest


@dataclass(frozen=True)
class Suspects:
    """Sets of coordinates that would explain a file.

    Attributes:
        explaining: those that do, by what they leave, of one size. Empty if as drawn it is explained.
        nearest: of the sets that do not, those that leave least.
        tried: by size, how many sets were fitted, and how many there are.
        unseen: coordinates whose correction within the bounds changes nothing that the file shows.
        left, count: the sum of squares of the car as drawn, and of how many numbers.
        drawn: whether as drawn it explains the file.
        refused: sets whose designs could not be solved, and why.
        ended: whether all other fits came to an end.
        notes: what was taken without being told, and rows that were left out.
    """

    explaining: tuple[Fit, ...]
    nearest: tuple[Fit, ...]
    tried: tuple[tuple[int, int], ...]
    unseen: Set
    left: float
    count: int
    drawn: bool
    refused: tuple[str, ...]
    ended: bool
    notes: tuple[str, ...]

    @property
    def equal(self) -> tuple[Fit, ...]:
        """The best of those that explain it, and those that the file cannot tell from it."""
        told = float(chdtri(1, 1.0 - CONFIDENCE))
        return tuple(one for one in self.explaining if one.left - self.explaining[0].left <= told)


def explains(left: float, largest: float, freedom: int) -> bool:
    """Whether a misfit is no more than rounding, in standard deviations."""
    return freedom > 0 and left <= float(chdtri(freedom, 1.0 / LEVEL)) and largest <= TWICE


def suspected(
    scene: Scene,
    measured: Measured,
    among: Sequence[str] = (),
    bounds: float = BOUNDS,
    prior: float = PRIOR,
    accuracy: float = 0.0,
    told: Callable[[str, int], None] = lambda words, count: None,
) -> Suspects:
    """The sets of coordinates that would explain a file.

    Args:
        among: coordinates such as lower_ball_joint.z, or points for all three; empty: of every point.
        bounds, prior, accuracy, told: as `fit_hardpoints` takes them; told counts sets.
    Raises:
        As `fit_hardpoints`.
    """
    require_limits(bounds, prior, accuracy)
    problem = Problem.of(scene, measured, among, accuracy)
    free = problem.curves.free
    first = problem.misfit(problem.first)
    left, notes = float(first @ first), (*problem.curves.driven.notes, *out_of_reach(measured, problem.start))
    drawn = explains(left, float(np.abs(first).max()), len(first))
    if drawn:
        return Suspects((), (), (), (), left, len(first), True, (), True, notes)
    slopes = problem.slopes(np.zeros(len(free)))
    seen = [i for i, size in enumerate(np.linalg.norm(slopes, axis=0)) if size * bounds >= 1.0]
    unseen = tuple(name for i, name in enumerate(free) if i not in seen)
    found, refused, tried, every = list[Fit](), list[str](), list[tuple[int, int]](), list[Fit]()
    for size in range(1, min(LARGEST, len(seen), len(first) - 1) + 1):
        sets = [(i,) for i in seen] if size == 1 else _ranked(first, slopes, seen, size, prior)[:CANDIDATES]
        for start in found[:STARTS]:
            sets += _beside(problem, start, seen, prior)[: CANDIDATES // STARTS]
        sets, found = list(dict.fromkeys(sets)), []
        for chosen in sets:
            names = [free[i] for i in chosen]
            told(f"{', '.join(names)} is fitted", len(every) + len(refused) + 1)
            try:
                fit = fit_hardpoints(scene, measured, names, bounds, prior, accuracy)
            except PointcoordError as error:
                refused.append(f"{', '.join(names)}: {error}")
                continue
            found.append(fit)
            every.append(fit)
        tried.append((len(sets), math.comb(len(seen), size)))
        found.sort(key=lambda one: one.left)
        if any(explains(one.left, one.largest, one.freedom) for one in found):
            break
    explaining = tuple(one for one in found if explains(one.left, one.largest, one.freedom))
    others = sorted((one for one in every if one not in explaining), key=lambda one: one.left)
    ended = all(one.converged for one in every)
    nearest = tuple(others[:SHOWN])
    return Suspects(
        explaining, nearest, tuple(tried), unseen, left, len(first), False, tuple(refused), ended, notes
    )


def _ranked(
    misfit: Array, slopes: Array, among: Sequence[int], size: int, prior: float
) -> list[tuple[int, ...]]:
    """Sets of a size, by what they leave in the linear problem."""
    sets = np.array(list(combinations(among, size)))
    square, along = slopes.T @ slopes + np.eye(slopes.shape[1]) / prior**2, slopes.T @ misfit
    step = np.linalg.solve(square[sets[:, :, None], sets[:, None, :]], along[sets][..., None])[..., 0]
    order = np.argsort(-np.sum(step * along[sets], axis=1), kind="stable")
    return [tuple(one) for one in sets[order].tolist()]


def _beside(problem: Problem, start: Fit, seen: Sequence[int], prior: float) -> list[tuple[int, ...]]:
    """A fitted set with one more coordinate, likewise, by the slopes where it ended."""
    free = problem.curves.free
    chosen = [free.index(name) for name in start.coordinates]
    amounts = np.zeros(len(free))
    amounts[chosen] = [one.correction for one in start.coordinates.values()]
    try:
        misfit, slopes = problem.misfit(problem.curves.at(amounts)), problem.slopes(amounts)
    except PointcoordError:
        return []
    if not np.isfinite(misfit).all():
        return []
    others = [i for i in seen if i not in chosen]
    # What the set explains already is taken out, so that each other one counts by what it adds.
    basis, _ = np.linalg.qr(slopes[:, chosen])
    rest = slopes - basis @ (basis.T @ slopes)
    return [tuple(sorted((*chosen, *one))) for one in _ranked(misfit, rest, others, 1, prior)]
