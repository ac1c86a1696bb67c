r"""The step rule: how long a series holds, and of which order it should be, from how its terms fall.

A segment is as long as its last two terms allow: at its end they, and what they contribute to the derivatives
that are asked for, are below the tolerance relative to the size of that derivative. The terms that were left
out are smaller still.

All series are of one order p, the one that costs least for the tolerance e. A series of terms that fall as
rho^-k, cut where its last one is e, has the length h(p) = rho exp(-B / p), B = -ln e (Jorba and Zou, Exp.
Math. 14 (2005) 99). A segment of order p costs as much as SEGMENT + p orders do, which is least per second at

    p = (B + sqrt(B^2 + 4 B SEGMENT)) / 2.

Jorba and Zou's own order, B / 2 + 1, is the best where the cost of an order grows with it and a segment costs
nothing beside them; here a chain of it takes 2 to 9 times as long.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from math import perm

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.multi_index import powers
from pointcoord.numerics.rounding import EPS

Array = NDArray[np.float64]

# A smaller truncation than this, relative to a derivative's size, drowns in the rounding of its sum.
FINEST = 4.0 * EPS
# Of a larger one what is proven of a segment (see `proven_step`) would say how long it is, and not its terms.
COARSEST = 1e-5
# Orders, at most: beyond 40 little is gained at any tolerance. Up to SAFE the rates of an input stay numbers
# however fast it is, 1e12 per second and more.
MOST, SAFE = 40, 20
# What a segment costs beside its orders, in orders: fitted to the times of thirty chains of 3 to 100 segments
# and of orders from 8 to 40.
SEGMENT = 25.0
# A series of fewer terms, of a single instant or of a car at rest, does not show how terms fall.
SHORT = 6


@dataclass(frozen=True)
class Settings:
    """How a chain is cut.

    Attributes:
        tolerance: allowed truncation, in the mechanism's units, between FINEST and COARSEST; for a derivative
            the same fraction of that derivative's size.
        derivative: highest time derivative that will be evaluated.
        hopeful: whether a chain goes on to the most segments where its first ones tell that it needs more.
    """

    tolerance: float
    derivative: int
    hopeful: bool = True

    @property
    def kept(self) -> Settings:
        """The same with a tolerance that can be kept."""
        kept = min(max(self.tolerance, FINEST), COARSEST)
        return self if kept == self.tolerance else replace(self, tolerance=kept)


def order_for(tolerance: float) -> int:
    """The order of the series that cost least per second for a tolerance; see the formula above."""
    b = -np.log(tolerance)
    return int(min(np.ceil(0.5 * (b + np.sqrt(b * (b + 4.0 * SEGMENT)))), MOST))


def lengths_by_sizes(logs: Array, settings: Settings) -> Array:
    r"""Lengths of segments in their own time unit, (members,).

    With c_k the largest k-th coefficient, the d-th derivative of either of the last two terms at s is
    k!/(k-d)! c_k s^(k-d); it must not exceed half the tolerance times the size of the d-th derivative,
    max_k k!/(k-d)! c_k s^(k-d) (for d = 0: the mechanism's size, 1). A term j stays below a multiple a of an
    earlier one k up to s = (a c_k / c_j)^(1/(j-k)), so that the longest s is the least of the greatest of
    these. Last terms that are missing or small by chance are taken for what the ones before them come to
    (see `gone_on`).

    Args:
        logs: logarithms of the coefficients, (members, orders).
    """
    logs = logs.copy()
    logs[:, 0] = 0.0
    logs[:, -2:] = gone_on(logs)
    room, exponents = _room(logs.shape[-1], settings.derivative, settings.tolerance)
    # Of two terms that are missing both there is nothing to compare, and without last terms there is no end.
    with np.errstate(invalid="ignore", over="ignore"):
        ends = (logs[:, None, None, :] - logs[:, None, -2:, None] + room) * exponents
        longest = np.fmin.reduce(np.fmax.reduce(ends, axis=-1), axis=(1, 2))
        return np.where(np.isnan(longest), np.inf, np.exp(longest))


@lru_cache(maxsize=256)
def _room(count: int, derivative: int, tolerance: float) -> tuple[Array, Array]:
    """Logarithms of what two last terms j have beside all terms k, (derivatives, 2, terms), and 1 / (j - k).

    Minus infinity where a term does not count: j itself and later ones, and for d = 0 all but the first,
    which stands for the mechanism's size.
    """
    falling, order = _falling(count, derivative), np.arange(count)
    with np.errstate(invalid="ignore"):
        room = np.log(0.5 * tolerance) + falling[:, None, :] - falling[:, -2:, None]
    ahead = order[-2:, None] - order
    room[np.broadcast_to(ahead <= 0, room.shape) | np.isnan(room)] = -np.inf
    room[0, :, 1:] = -np.inf
    return room, 1.0 / np.maximum(ahead, 1.0)


def gone_on(logs: Array) -> Array:
    """Logarithms of the last two coefficients, at least what those before them come to, (members, 2).

    Every other term is missing where an input is at rest, all but each n-th where it begins as t^n, and close
    to such a place they are small; a pair of singular places beside the axis makes terms swing. The last two
    then tell nothing of those that follow. So each term of the last half of a series goes on as terms fell
    from the largest of the half before it to the largest of that one. Terms that end for good, of which the
    last half has none, stay missing.
    """
    if logs.shape[-1] < SHORT:
        return logs[:, -2:]
    later, fall = logs[:, logs.shape[-1] // 2 :], _fall(logs)
    last = later - fall[:, None] * np.arange(later.shape[-1] - 1.0, -1.0, -1.0)
    return np.stack([last[:, :-1].max(axis=-1) + fall, last.max(axis=-1)], axis=-1)


def _fall(logs: Array) -> Array:
    """How much the logarithms of terms fall from one to the next over the last half, (members,)."""
    middle, members = logs.shape[-1] // 2, np.arange(len(logs))
    before, after = 1 + logs[:, 1:middle].argmax(axis=-1), middle + logs[:, middle:].argmax(axis=-1)
    with np.errstate(invalid="ignore"):
        fall = (logs[members, before] - logs[members, after]) / (after - before)
    # Of terms that do not fall, or that begin here, the length that they allow says more.
    return np.where(np.isfinite(fall), np.maximum(fall, 0.0), 0.0)


def degrees_lacking(series: Array, inputs: int, order: int, rates: Array, settings: Settings) -> Array:
    r"""How many degrees more a series in inputs takes if terms go on to fall, 0 if none, (designs,).

    Where degrees fall to a part f from one to the next, and e is what the last one, p, comes to at least
    as those before it do, what is left out comes to no more, in the d-th rate of s, than

        sum_{j > 0} (p + j)^d f^j e <= (p + 1)^d f (1 + f) / (1 - f)^(d + 1) e.

    With v and a the largest rates of s it is e for d = 0, v times that for d = 1 and v^2 times that for
    d = 2 and a times that for d = 1. With 1 + f at most 2, it is held to half the tolerance of the size
    of each: of the mechanism, v c_1, and a c_1 or 2 v^2 c_2.

    Args:
        series: of the unknown coordinates, powers first, shape (powers, designs, unknowns).
        inputs: how many. order: its degree.
        rates: the largest first and second rate of each s, per s and s^2, shape (inputs, 2).
    """
    every, (v, a) = powers(inputs, order), rates.T
    edges = [every.first_of(degree) for degree in range(order + 1)]
    terms = np.abs(series)
    logs = np.log(np.add.reduceat(terms, edges, axis=0).max(axis=-1)).T
    logs[:, 0] = 0.0
    turned = (v**every.exponents).prod(axis=-1)
    first, again, second = (
        (terms[edges[k] : edges[k + 1]].max(axis=-1) * by[:, None]).max(axis=0)
        for k, by in ((1, v), (1, a), (2, 2.0 * turned[edges[2] : edges[3]]))
    )
    fall = 0.5 * np.maximum(logs[:, -4:-2].max(axis=-1) - logs[:, -2:].max(axis=-1), 0.0)
    gap, fastest, bent = -np.expm1(-fall), v.max() * (order + 1), a.max() * (order + 1)
    allowed = [
        gap,
        first / fastest * gap**2,
        np.maximum(again, second) / (fastest**2 / gap + bent) * gap**2,
    ][: settings.derivative + 1]
    excess = gone_on(logs)[:, 1] - fall - np.log(0.25 * settings.tolerance * np.min(allowed, axis=0))
    more = excess / fall
    # Of p + n degrees the factors are larger by (1 + n / p)^d.
    more += settings.derivative * np.log1p(np.maximum(more, 0.0) / order) / fall
    return np.where(np.isnan(more), np.inf, np.where(excess > 0.0, more, 0.0))


def last_magnitudes(series: Array, length: float = 1.0) -> Array:
    """Magnitudes of the last two terms, at least what the ones before come to, (2, size) (see `gone_on`).

    How terms fall is looked at where the segment ends, whatever unit of time the coefficients are in: in a
    longer unit those of a series that serves well may rise.

    Args:
        series: coefficients, (order + 1, size).
        length: of the segment, in their unit of time.
    """
    sizes = np.abs(series)
    if len(sizes) < SHORT:
        return sizes[-2:]
    later, unit = sizes[len(sizes) // 2 :], np.log(length)
    fall = float(_fall(log_sizes(series) + unit * np.arange(len(sizes)))[0]) + unit
    ahead = np.exp(-fall * np.arange(len(later) - 1.0, -1.0, -1.0))[:, None]
    return np.stack([(later[:-1] * ahead[1:]).max(axis=0), (later * ahead).max(axis=0)])


@lru_cache(maxsize=256)
def _falling(count: int, derivative: int) -> Array:
    """log k!/(k-d)! for d up to a derivative and k below a count, minus infinity for k < d, (d, k).

    The power of s is that of the term itself in every row: a common factor of a row changes no comparison.
    """
    rows = [[float(perm(k, d)) for k in range(count)] for d in range(derivative + 1)]
    with np.errstate(divide="ignore"):
        return np.asarray(np.log(np.array(rows)))


def log_sizes(series: Array) -> Array:
    """Logarithm of the largest coefficient of each order, (members, orders)."""
    size = np.abs(series).max(axis=-1).reshape(-1, series.shape[-2])
    with np.errstate(divide="ignore"):
        return np.asarray(np.log(size))
