"""Parameters of another car or motion by least squares of the given numbers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# What a linear step from where the parameters are ours must leave of the difference, to be worth a search.
LIKELY = 0.5
# What the search may leave of it at most; or of what each number may be off by, which rounder parameters, as
# they are meant, may leave less of.
PROMISING, NEARLY = 0.1, 2.0
MOST_STEPS = 12
# Of the difference: a step that is to lessen it by no more is not gone, and one that does not so by half is
# the last one, for near the parameters that are meant a step lessens it manifold, down to what remains.
SETTLED, MANIFOLD = 1e-3, 0.5
SHARES = (1.0, 0.25)  # of a step, of which the first that lessens the difference is gone
FAR = 1e3  # times the largest difference, as which a number counts that the parameters do not give
# How many times what found amounts leave rounder ones may, where all numbers are within what they may be off,
# and elsewhere; of so many decimals at most. Least squares leave less of rounded numbers than what was meant:
# of 5 that one amount is fitted to by a root of 5/4 on average.
KEPT, CLOSE, DECIMALS = 1.5, 1.1, 5


class Fit(NamedTuple):
    """Parameters, and the root of the sum of squares that they leave of the difference."""

    amounts: Array
    left: float


class _Differences:
    """Given numbers less those that parameters make, and the slopes by each, from one reading."""

    def __init__(self, read: Callable[[Array], Array], theirs: Array, step: float) -> None:
        self._read, self._theirs, self._step = read, theirs, step
        self._far = np.nan
        self._known: dict[bytes, Array] = {}

    def measured_by(self, first: Array) -> None:
        """Take the difference at the start as the measure of numbers that there are none of."""
        self._far = FAR * float(np.abs(first).max())

    def with_slopes(self, at: Array) -> tuple[Array, Array]:
        """The difference, (M,), and its slopes, (M, P)."""
        steps = np.concatenate([np.zeros((1, len(at))), -self._step * np.eye(len(at))])
        gaps = self._read(at + steps) - self._theirs
        if np.isnan(self._far):
            self.measured_by(gaps[0])
        there, *beside = np.nan_to_num(gaps, nan=self._far)
        self._known[at.tobytes()] = there
        return there, (there - np.array(beside)).T / self._step

    def at(self, parameters: Array) -> Array:
        """The difference, (M,)."""
        key = parameters.tobytes()
        if key not in self._known:
            self._known[key] = np.nan_to_num(self._read(parameters[None])[0] - self._theirs, nan=self._far)
        return self._known[key]

    def left(self, parameters: Array) -> float:
        """The root of the sum of its squares."""
        return float(np.linalg.norm(self.at(parameters)))


def fitted(
    read: Callable[[Array], Array],
    start: Sequence[float],
    step: float,
    theirs: Array,
    off: Array | float = 0.0,
    rounded: bool = False,
    known: tuple[Array, Array] | None = None,
) -> Fit | None:
    """Parameters at which `read` is nearest to given numbers; None where that leaves much of the difference.

    Args:
        read: the numbers (B, M) at sets of parameters (B, P); NaN where there are none.
        start: where the parameters are ours. step: of differences by each.
        off: how far the numbers may be from theirs; if all are within it nothing is left.
        rounded: whether, of numbers that are all nearly within what they may be off, the roundest parameters
            that leave as little are taken, which are meant: those by which all are within it go before
            rounder ones.
        known: the difference at the start, (M,), and its slopes, (M, P), where they are.
    """
    differences = _Differences(read, theirs, step)
    begin = np.array(start, dtype=float)
    first, slopes = differences.with_slopes(begin) if known is None else known
    if not np.isfinite(first).all():
        return None
    if known is not None:
        differences.measured_by(first)
    apart = float(np.linalg.norm(first))
    found = _nearest(differences, begin, first, slopes)
    if found is None:
        return None
    least = differences.left(found)
    near = bool((np.abs(differences.at(found)) <= NEARLY * np.asarray(off)).all())
    if least > PROMISING * apart and not near:
        return None

    def kept(one: Array) -> bool:
        return differences.left(one) <= KEPT * least and bool((np.abs(differences.at(one)) <= off).all())

    def close(one: Array) -> bool:
        return differences.left(one) <= CLOSE * least

    if rounded and near:
        meant = roundest(found, DECIMALS, kept)
        found = meant if kept(meant) else roundest(found, DECIMALS, close)
    return Fit(found, differences.left(found))


def _nearest(differences: _Differences, begin: Array, gap: Array, slopes: Array) -> Array | None:
    """By the Gauss-Newton method, with shorter steps where one makes the difference larger."""
    found, least = begin, float(np.linalg.norm(gap))
    for count in range(MOST_STEPS):
        change = np.linalg.lstsq(slopes, -gap, rcond=None)[0]
        expected = float(np.linalg.norm(gap + slopes @ change))
        if count == 0 and not expected <= LIKELY * least:
            return None
        if expected > (1.0 - SETTLED) * least:
            break
        for share in SHARES:
            gap, slopes = differences.with_slopes(found + share * change)
            left = float(np.linalg.norm(gap))
            if left < least:
                break
        else:
            break
        settled = left > MANIFOLD * least
        found, least = found + share * change, left
        if settled:
            break
    return found


def roundest(found: Array | float, decimals: int, fits: Callable[[Array], bool], unit: float = 1.0) -> Array:
    """The roundest of the numbers next to found ones that fits as they do; they themselves if none does.

    Least squares of printed digits miss what was meant by a little.

    Args:
        decimals: how many are tried, from none on. unit: in which the numbers are round.
    """
    rounder = (unit * np.round(np.asarray(found) / unit, places) for places in range(decimals))
    return np.asarray(next((near for near in rounder if fits(near)), found))


def decimals_of(amounts: Array) -> int:
    """How many decimals amounts have, as far as roundness is looked for."""
    return next((n for n in range(DECIMALS) if (np.round(amounts, n) == amounts).all()), DECIMALS)
