r"""Finds sets of a few hardpoint coordinates that explain a file if they are moved; corrects nothing.

Every coordinate that affects the file's numbers is fitted alone, then sets of two and of three, until some
sets of one size explain the file. Not all sets are fitted. Let r be the misfit and J its Jacobian, both in
standard deviations (see `problem`). In the linear problem the sum of squares left by a set S is

    |r|^2 - g_S . (J_S^T J_S + 1 / prior^2)^-1 g_S,    g_S = J_S^T r.

For each size the sets with the smallest value are fitted.

A set explains the file if rounding alone exceeds its sum of squares in at least one of LEVEL files, and no
number is off by more than TWICE its rounding. The second condition is needed because least squares do not
minimise the largest difference. The error of a rounded number is evenly distributed; its square scatters less
than that of a normal error, so the chi-squared test is on the safe side. Two sets explain the file equally
well if their sums of squares differ by no more than the reduction that one further coordinate gains from
rounding alone in 95 of 100 files.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from scipy.special import chdtri

from pointcoord import PointcoordError
from validate.arrays import Array
from validate.fitting.fit import CONFIDENCE, Fit, Told, fit_hardpoints
from validate.fitting.problem import Problem

LARGEST = 3  # coordinates of a set: all of one misread point
LEVEL = 1000.0
TWICE = 2.0 * math.sqrt(3.0)  # in standard deviations: twice the half unit of a rounded number
CANDIDATES = 24  # number of sets of a size that are fitted
SHOWN = 8  # number of nearest sets kept if none explains the file


@dataclass(frozen=True)
class Suspects:
    """Sets of coordinates that may explain a file.

    Attributes:
        left: sum of squares of the misfit of the car as drawn.
        count: number of numbers in this sum.
        drawn: whether the car as drawn explains the file; nothing is fitted then.
        notes: what was assumed because it is not given, and rows that were left out.
        fits: all sets that could be fitted, the smallest sum of squares first.
        tried: by size, number of sets fitted and number of all sets.
        unseen: coordinates whose correction within the bounds does not change the numbers noticeably.
        refused: sets whose designs could not be solved, with the reason.
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
    def residual(self) -> float:
        """The r.m.s. misfit of the car as drawn, in standard deviations of the numbers."""
        return math.sqrt(self.left / self.count)

    @property
    def explaining(self) -> tuple[Fit, ...]:
        """Sets that explain the file, all of one size."""
        return tuple(one for one in self.fits if _explained(one))

    @property
    def nearest(self) -> tuple[Fit, ...]:
        """The sets with the smallest sums of squares among those that do not explain the file."""
        return tuple(one for one in self.fits if not _explained(one))[:SHOWN]

    @property
    def equal(self) -> tuple[Fit, ...]:
        """The best set that explains the file, and the sets that the file cannot tell from it."""
        explaining, margin = self.explaining, float(chdtri(1, 1.0 - CONFIDENCE))
        return tuple(one for one in explaining if one.left - explaining[0].left <= margin)

    @property
    def ended(self) -> bool:
        """Whether all fits converged."""
        return all(one.converged for one in self.fits)


def explains(left: float, largest: float, freedom: int) -> bool:
    """Whether rounding alone explains a misfit, in standard deviations.

    Args:
        left: sum of squares. largest: largest misfit. freedom: degrees of freedom.
    """
    return freedom > 0 and left <= float(chdtri(freedom, 1.0 / LEVEL)) and largest <= TWICE


def _explained(fit: Fit) -> bool:
    return explains(fit.left, fit.largest, fit.freedom)


def suspected(problem: Problem, told: Told = lambda words, count: None) -> Suspects:
    """The sets of a problem's free coordinates that may explain its file.

    Args:
        told: is called for progress with a text and the number of sets fitted.
    Raises:
        FileError: a number of the car as drawn has no derivative.
    """
    free, first = problem.free, problem.misfit(problem.start)
    left, count = float(first @ first), len(first)
    drawn = explains(left, float(np.abs(first).max()), count)
    found = Suspects(left, count, drawn, problem.notes)
    if drawn:
        return found
    slopes = problem.slopes(problem.start)
    seen = [i for i, size in enumerate(np.linalg.norm(slopes, axis=0)) if size * problem.bounds >= 1.0]
    fits, refused, tried = list[Fit](), list[str](), list[tuple[int, int]]()
    for size in range(1, min(LARGEST, len(seen), count - 1) + 1):
        most = len(seen) if size == 1 else CANDIDATES
        sets, here = _ranked(first, slopes, seen, size, problem.prior)[:most], list[Fit]()
        for chosen in sets:
            names = tuple(free[i] for i in chosen)
            told(f"{', '.join(names)} is fitted", len(fits) + len(here) + len(refused) + 1)
            try:
                # The solved car as drawn is reused.
                here.append(fit_hardpoints(replace(problem, free=names)))
            except PointcoordError as error:
                refused.append(f"{', '.join(names)}: {error}")
        tried.append((len(sets), math.comb(len(seen), size)))
        fits += here
        if any(map(_explained, here)):
            break
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
    """All sets of a size, the smallest sum of squares in the linear problem first."""
    sets = np.array(list(combinations(among, size)))
    square, along = slopes.T @ slopes + np.eye(slopes.shape[1]) / prior**2, slopes.T @ misfit
    step = np.linalg.solve(square[sets[:, :, None], sets[:, None, :]], along[sets][..., None])[..., 0]
    order = np.argsort(-np.sum(step * along[sets], axis=1), kind="stable")
    return [tuple(one) for one in sets[order].tolist()]
