r"""Finds sets of a few hardpoint coordinates that explain a file if they are moved; corrects nothing.

Every coordinate that affects the file's numbers is fitted alone, then sets of two and of three, until some
sets of one size explain the file. Not all sets are fitted. Let r be the misfit and J its Jacobian, both in
standard deviations (see `problem`). In the linear problem the sum of squares left by a set S is

    |r|^2 - g_S . (J_S^T J_S + 1 / prior^2)^-1 g_S,    g_S = J_S^T r.

For each size the sets with the smallest value are fitted. Two sets explain the file equally well if their
sums of squares differ by no more than the reduction that one further coordinate gains from rounding alone in
95 of 100 files.
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
from validate.fitting.fit import CONFIDENCE, Fit, Told, explains, fit_hardpoints
from validate.fitting.problem import Problem

LARGEST = 3  # coordinates of a set: all of one misread point
CANDIDATES = 24  # number of sets of a size that are fitted
SHOWN = 8  # number of nearest sets kept if none explains the file


@dataclass(frozen=True)
class Suspects:
    """Sets of coordinates that may explain a file.

    Attributes:
        rest: the misfit of the car as drawn, (numbers,), in standard deviations of the numbers.
        drawn: whether the car as drawn explains the file; nothing is fitted then.
        fits: all sets that could be fitted, the smallest sum of squares first.
        tried: by size, number of sets fitted and number of all sets.
        unseen: coordinates whose correction within the bounds does not change the numbers noticeably.
        refused: sets whose designs could not be solved, with the reason.
    """

    problem: Problem
    rest: Array
    drawn: bool
    fits: tuple[Fit, ...] = ()
    tried: tuple[tuple[int, int], ...] = ()
    unseen: tuple[str, ...] = ()
    refused: tuple[str, ...] = ()

    @property
    def residual(self) -> float:
        """The r.m.s. misfit of the car as drawn, in standard deviations of the numbers."""
        return math.sqrt(float(self.rest @ self.rest) / len(self.rest))

    @property
    def explaining(self) -> tuple[Fit, ...]:
        """Sets that explain the file, all of one size."""
        return tuple(one for one in self.fits if one.explains)

    @property
    def nearest(self) -> tuple[Fit, ...]:
        """The sets with the smallest sums of squares among those that do not explain the file."""
        return tuple(one for one in self.fits if not one.explains)[:SHOWN]

    @property
    def equal(self) -> tuple[Fit, ...]:
        """The best set that explains the file, and the sets that the file cannot tell from it."""
        explaining, margin = self.explaining, float(chdtri(1, 1.0 - CONFIDENCE))
        return tuple(one for one in explaining if one.left - explaining[0].left <= margin)

    @property
    def certain(self) -> bool:
        """Whether the file is explained, or all fits converged."""
        return self.drawn or bool(self.explaining) or all(one.converged for one in self.fits)


def suspected(problem: Problem, told: Told = lambda words, count: None) -> Suspects:
    """The sets of a problem's free coordinates that may explain its file.

    Args:
        told: is called for progress with a text and the number of sets fitted.
    Raises:
        FileError: a number of the car as drawn has no derivative.
    """
    free, first = problem.free, problem.misfit(problem.start)
    found = Suspects(problem, first, explains(first, len(first)))
    if found.drawn:
        return found
    slopes = problem.slopes(problem.start)
    seen = np.flatnonzero(np.linalg.norm(slopes, axis=0) * problem.bounds >= 1.0).tolist()
    fits, refused, tried = list[Fit](), list[str](), list[tuple[int, int]]()
    for size in range(1, min(LARGEST, len(seen), len(first) - 1) + 1):
        most = len(seen) if size == 1 else CANDIDATES
        sets = _ranked(first, slopes, seen, size, problem.prior)[:most]
        for chosen in sets:
            names = tuple(free[i] for i in chosen)
            told(f"{', '.join(names)} is fitted", len(fits) + len(refused) + 1)
            try:
                # The solved car as drawn is reused.
                fits.append(fit_hardpoints(replace(problem, free=names)))
            except PointcoordError as error:
                refused.append(f"{', '.join(names)}: {error}")
        tried.append((len(sets), math.comb(len(seen), size)))
        if any(one.explains for one in fits):
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
