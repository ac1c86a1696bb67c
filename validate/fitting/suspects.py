r"""Which few hardpoint coordinates, moved, would explain a file: a diagnosis, that corrects nothing.

Every coordinate that the file sees is fitted alone, then sets of two and of three, until some sets of a size
explain the file. Not all sets are fitted. With r the misfit and J its slopes, both in standard deviations
(see `problem`), a set S leaves in the linear problem

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
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtri

from pointcoord import PointcoordError
from validate.fitting.fit import CONFIDENCE, Fit, Told, fit_hardpoints
from validate.fitting.problem import Problem

Array = NDArray[np.float64]

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
        fits: of all sets that could be fitted, by what they leave.
        tried: by size, how many sets were fitted, and how many there are.
        unseen: coordinates whose correction within the bounds changes nothing that the file shows.
        left, count: the sum of squares of the car as drawn, and of how many numbers.
        drawn: whether as drawn it explains the file; then nothing is fitted.
        refused: sets whose designs could not be solved, and why.
        notes: what was taken without being told, and rows that were left out.
    """

    left: float
    count: int
    drawn: bool
    notes: tuple[str, ...]
    fits: tuple[Fit, ...] = ()
    tried: tuple[tuple[int, int], ...] = ()
    unseen: tuple[str, ...] = ()
    refused: tuple[str, ...] = ()

    @property
    def explaining(self) -> tuple[Fit, ...]:
        """Sets that explain the file, all of one size."""
        return tuple(one for one in self.fits if _explained(one))

    @property
    def nearest(self) -> tuple[Fit, ...]:
        """Of the sets that do not, those that leave least."""
        return tuple(one for one in self.fits if not _explained(one))[:SHOWN]

    @property
    def equal(self) -> tuple[Fit, ...]:
        """The best of those that explain it, and those that the file cannot tell from it."""
        explaining, told = self.explaining, float(chdtri(1, 1.0 - CONFIDENCE))
        return tuple(one for one in explaining if one.left - explaining[0].left <= told)

    @property
    def ended(self) -> bool:
        """Whether all fits came to an end."""
        return all(one.converged for one in self.fits)


def explains(left: float, largest: float, freedom: int) -> bool:
    """Whether a misfit is no more than rounding, in standard deviations."""
    return freedom > 0 and left <= float(chdtri(freedom, 1.0 / LEVEL)) and largest <= TWICE


def _explained(fit: Fit) -> bool:
    return explains(fit.left, fit.largest, fit.freedom)


def suspected(problem: Problem, told: Told = lambda words, count: None) -> Suspects:
    """The sets of a problem's free coordinates that would explain its file.

    Args:
        told: is called with words and how many sets were fitted.
    Raises:
        FileError: a number of the car as drawn has no slope.
    """
    free, first = problem.free, problem.misfit(problem.start)
    left, count = float(first @ first), len(first)
    drawn = explains(left, float(np.abs(first).max()), count)
    found = Suspects(left, count, drawn, problem.notes)
    if drawn:
        return found
    slopes = problem.slopes(problem.start)
    seen = [i for i, size in enumerate(np.linalg.norm(slopes, axis=0)) if size * problem.bounds >= 1.0]
    fits, refused, tried, best = list[Fit](), list[str](), list[tuple[int, int]](), list[Fit]()
    for size in range(1, min(LARGEST, len(seen), count - 1) + 1):
        most = len(seen) if size == 1 else CANDIDATES
        sets = _ranked(first, slopes, seen, size, problem.prior)[:most]
        for start in best:
            sets += _beside(problem, start, seen)[: CANDIDATES // STARTS]
        sets, here = list(dict.fromkeys(sets)), list[Fit]()
        for chosen in sets:
            names = [free[i] for i in chosen]
            told(f"{', '.join(names)} is fitted", len(fits) + len(here) + len(refused) + 1)
            try:
                here.append(fit_hardpoints(problem.among(names)))
            except PointcoordError as error:
                refused.append(f"{', '.join(names)}: {error}")
        tried.append((len(sets), math.comb(len(seen), size)))
        fits += here
        if any(map(_explained, here)):
            break
        best = sorted(here, key=lambda one: one.left)[:STARTS]
    return replace(
        found,
        fits=tuple(sorted(fits, key=lambda one: one.left)),
        tried=tuple(tried),
        unseen=tuple(name for i, name in enumerate(free) if i not in seen),
        refused=tuple(refused),
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


def _beside(problem: Problem, start: Fit, seen: Sequence[int]) -> list[tuple[int, ...]]:
    """A fitted set with one more coordinate, likewise, by the slopes where it ended."""
    free = problem.free
    chosen = [free.index(name) for name in start.coordinates]
    amounts = np.zeros(len(free))
    amounts[chosen] = [one.correction for one in start.coordinates.values()]
    try:
        design = problem.solved(amounts)
        misfit, slopes = problem.misfit(design), problem.slopes(design)
    except PointcoordError:
        return []
    if not np.isfinite(misfit).all():
        return []
    others = [i for i in seen if i not in chosen]
    # What the set explains already is taken out, so that each other one counts by what it adds.
    basis, _ = np.linalg.qr(slopes[:, chosen])
    rest = slopes - basis @ (basis.T @ slopes)
    return [tuple(sorted((*chosen, *one))) for one in _ranked(misfit, rest, others, 1, problem.prior)]
