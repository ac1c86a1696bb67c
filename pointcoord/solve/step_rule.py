r"""The step rule: the length and the order of a series, from the rate at which its terms fall.

A segment is as long as its last two terms allow: at its end the two terms, and their contributions to the
requested derivatives, are below the tolerance times the size of that derivative. The truncated terms are
smaller still.

All series are of one order p, the cheapest one for the tolerance e. A series whose terms fall as rho^-k, and
whose last term is e at the end, has the length h(p) = rho exp(-B / p), B = -ln e (Jorba and Zou, Exp. Math.
14 (2005) 99). A segment of order p costs as much as SEGMENT + p orders. The cost per second is least at

    p = (B + sqrt(B^2 + 4 B SEGMENT)) / 2.

Jorba and Zou's order, B / 2 + 1, is best if the cost of an order grows with the order and a segment has no
other cost. Here a chain with their order takes 2 to 9 times as long.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from math import perm

import numpy as np

from pointcoord.numerics.arrays import Array
from pointcoord.numerics.multi_index import powers
from pointcoord.numerics.rounding import EPS

# A smaller truncation error, relative to the size of a derivative, drowns in the rounding of its sum.
FINEST = 4.0 * EPS
# At a larger tolerance the proof of a segment (see `proven_step`) would limit its length, and not its terms.
COARSEST = 1e-5
# Largest order: beyond 40 little is gained at any tolerance. Up to order SAFE the rates of an input stay
# finite, however fast the input is, 1e12 per second and more.
MOST, SAFE = 40, 20
# Cost of a segment in addition to its orders, in orders: fitted to the times of thirty chains of 3 to 100
# segments and of orders from 8 to 40.
SEGMENT = 25.0
# A series of fewer terms, for a single instant or a car at rest, does not show how its terms fall.
SHORT = 6


@dataclass(frozen=True)
class Settings:
    """How a motion is divided into segments.

    Attributes:
        tolerance: allowed truncation error, in the mechanism's units, between FINEST and COARSEST; for a
            derivative, the allowed truncation error divided by the size of that derivative.
        derivative: highest time derivative that will be evaluated.
        hopeful: whether a chain goes on to MOST_SEGMENTS though its first segments show that it needs more.
    """

    tolerance: float
    derivative: int
    hopeful: bool = True

    @property
    def kept(self) -> Settings:
        """The settings with the tolerance limited to FINEST .. COARSEST."""
        kept = min(max(self.tolerance, FINEST), COARSEST)
        return self if kept == self.tolerance else replace(self, tolerance=kept)


def order_for(tolerance: float) -> int:
    """The order p of the series that cost least per second at a tolerance (formula of the module)."""
    b = -np.log(tolerance)
    return int(min(np.ceil(0.5 * (b + np.sqrt(b * (b + 4.0 * SEGMENT)))), MOST))


def lengths_by_sizes(logs: Array, settings: Settings) -> Array:
    r"""Lengths of segments in the unit of time of the series, (members,).

    With c_k the largest k-th coefficient, the d-th derivative of term k at s is k!/(k-d)! c_k s^(k-d). For
    either of the last two terms j it must not exceed half the tolerance times the size of the d-th
    derivative, max_k k!/(k-d)! c_k s^(k-d) (for d = 0: the mechanism's size, 1). Term j stays below a times
    an earlier term k up to s = (a c_k / c_j)^(1/(j-k)). The length is the largest s over all k, and the
    smallest of these over j and d. Last terms that are missing or small by chance are replaced by an
    extrapolation of the terms before them (see `gone_on`).

    Args:
        logs: logarithms of the coefficients, (members, orders).
    """
    logs = logs.copy()
    logs[:, 0] = 0.0
    logs[:, -2:] = gone_on(logs)
    room, exponents = _room(logs.shape[-1], settings.derivative, settings.tolerance)
    # Two missing terms give NaN, which is ignored. Without last terms the length is infinite.
    with np.errstate(invalid="ignore", over="ignore"):
        ends = (logs[:, None, None, :] - logs[:, None, -2:, None] + room) * exponents
        longest = np.fmin.reduce(np.fmax.reduce(ends, axis=-1), axis=(1, 2))
        return np.where(np.isnan(longest), np.inf, np.exp(longest))


@lru_cache(maxsize=256)
def _room(count: int, derivative: int, tolerance: float) -> tuple[Array, Array]:
    """Logarithms of the allowed ratio c_j s^(j-k) / c_k, (derivatives, 2, terms), and 1 / (j - k).

    j are the last two terms, k all terms. The logarithm is minus infinity where a term k does not count: j
    and later terms, and for d = 0 all terms but the first, which stands for the mechanism's size.
    """
    falling, order = _falling(count, derivative), np.arange(count)
    with np.errstate(invalid="ignore"):
        room = np.log(0.5 * tolerance) + falling[:, None, :] - falling[:, -2:, None]
    ahead = order[-2:, None] - order
    room[np.broadcast_to(ahead <= 0, room.shape) | np.isnan(room)] = -np.inf
    room[0, :, 1:] = -np.inf
    return room, 1.0 / np.maximum(ahead, 1.0)


def gone_on(logs: Array) -> Array:
    """Logarithms of the last two coefficients, at least as large as extrapolated, (members, 2).

    The last two terms may say nothing about the terms that follow. Every other term is missing where an input
    is at rest, and all but each n-th term where the input begins as t^n; near such an instant these terms are
    small. A pair of complex singularities makes terms swing. So each term of the second half of a series is
    extrapolated to the end with the rate at which terms fall from the largest of the first half to the
    largest of the second half. Where the second half has no terms at all, the last two stay missing.
    """
    if logs.shape[-1] < SHORT:
        return logs[:, -2:]
    later, fall = logs[:, logs.shape[-1] // 2 :], _fall(logs)
    last = later - fall[:, None] * np.arange(later.shape[-1] - 1.0, -1.0, -1.0)
    return np.stack([last[:, :-1].max(axis=-1) + fall, last.max(axis=-1)], axis=-1)


def convergence_radius(logs: Array) -> Array:
    """Estimated radius of convergence of series in their unit, (members,); infinite without later terms.

    Args:
        logs: logarithms of the coefficients, (members, orders).
    """
    rate = _rate(logs)
    return np.where(np.isnan(rate), np.inf, np.exp(rate))


def _fall(logs: Array) -> Array:
    """Fall of the logarithms of terms from one term to the next over the second half, (members,)."""
    # Terms that do not fall, or that only begin in the second half, are not extrapolated: fall 0.
    fall = _rate(logs)
    return np.where(np.isfinite(fall), np.maximum(fall, 0.0), 0.0)


def _rate(logs: Array) -> Array:
    """Mean fall of the logarithms from the largest term of the first half to that of the second, (members,).

    Infinite, with its sign, where a half has no terms; NaN where both have none.
    """
    middle, members = logs.shape[-1] // 2, np.arange(len(logs))
    before, after = 1 + logs[:, 1:middle].argmax(axis=-1), middle + logs[:, middle:].argmax(axis=-1)
    with np.errstate(invalid="ignore"):
        return np.asarray((logs[members, before] - logs[members, after]) / (after - before))


def degrees_lacking(series: Array, inputs: int, order: int, rates: Array, settings: Settings) -> Array:
    r"""Number of further degrees that a series in inputs needs, 0 if none, (designs,).

    Let terms fall by a factor f from one degree to the next, and let e be the size of the last degree p, at
    least as large as extrapolated from the degrees before. The d-th derivative by s of the truncated terms is
    then at most

        sum_{j > 0} (p + j)^d f^j e <= (p + 1)^d f (1 + f) / (1 - f)^(d + 1) e.

    With v and a the largest first and second rates of s, the truncation error of a coordinate is this sum for
    d = 0; that of a velocity is v times the sum for d = 1; and that of an acceleration is v^2 times the sum
    for d = 2 plus a times the sum for d = 1. With 1 + f at most 2, each must be below half the tolerance
    times the size of its quantity: the mechanism's size, v c_1, and a c_1 or 2 v^2 c_2.

    Args:
        series: series of the unknown coordinates, powers first, shape (powers, designs, unknowns).
        inputs: number of inputs.
        order: degree of the series.
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
    # With p + n degrees the factors (p + 1)^d are larger by (1 + n / p)^d.
    more += settings.derivative * np.log1p(np.maximum(more, 0.0) / order) / fall
    return np.where(np.isnan(more), np.inf, np.where(excess > 0.0, more, 0.0))


def last_magnitudes(series: Array, length: float = 1.0) -> Array:
    """Magnitudes of the last two terms, at least as large as extrapolated, (2, size) (see `gone_on`).

    The fall of the terms is measured at the end of the segment. In the coefficients' unit of time, which may
    be longer, the terms of a good series may rise.

    Args:
        series: coefficients, (order + 1, size).
        length: length of the segment, in the coefficients' unit of time.
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

    The factor s^-d of the d-th derivative is left out: it is common to a row and changes no comparison.
    """
    rows = [[float(perm(k, d)) for k in range(count)] for d in range(derivative + 1)]
    with np.errstate(divide="ignore"):
        return np.asarray(np.log(np.array(rows)))


def log_sizes(series: Array) -> Array:
    """Logarithm of the largest coefficient of each order, (members, orders)."""
    size = np.abs(series).max(axis=-1).reshape(-1, series.shape[-2])
    with np.errstate(divide="ignore"):
        return np.asarray(np.log(size))
