r"""The way of the inputs over time: between which values they lie, over every span of it.

Poses at instants do not tell what lies between: an input that leaves its reach and comes back between two
of them would not be seen. So a law says between which values it lies over a span of time (`values_over`),
and the boxes of all spans together hold the whole way. They are cut in time where they are too coarse to
tell.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.rounding import EPS
from pointcoord.patches.lookup import Lookup
from pointcoord.time_functions import TimeFunction

Array = NDArray[np.float64]

# Spans to begin with, of a second or a year.
SPANS = 1024
# Spans are cut until they are no wider than the values that they are made of by more than this share of all.
LOOSE = 1e-3
# How often, at most: a span of 1,000 s is cut to a fraction of a nanosecond.
ROUNDS = 16
# What rounding makes of a value, at most, in parts of the largest: no cut takes it away.
ROUNDED = 1e-12
# Of more spans that are too wide it is not the length that makes them so; wider boxes cover no less.
MOST_WIDE = 2**16
# Spans looked at once, and parts that one is cut into.
AT_ONCE, PARTS = 2**16, 4
# A span's box this small, in parts of the smallest box of a domain, tells all that can be told.
SMALL = 0.25


@dataclass(frozen=True)
class Spans:
    """Spans of time in their order, with boxes that hold the inputs.

    Attributes:
        first, last: ends of each, (N,), s. low, high: of the inputs over it, (N, p), rad or mm.
    """

    first: Array
    last: Array
    low: Array
    high: Array

    @classmethod
    def of(cls, laws: Sequence[TimeFunction], first: Array, last: Array) -> Spans:
        """Spans between which no law has a break."""
        bounds = [law.values_over(first, last) for law in laws]
        low, high = (np.stack([bound[end] for bound in bounds], axis=-1) for end in (0, 1))
        # What is not a number is anything.
        unknown = ~(np.isfinite(low) & np.isfinite(high))
        return cls(first, last, np.where(unknown, -np.inf, low), np.where(unknown, np.inf, high))

    def taken(self, places: NDArray[np.intp] | NDArray[np.bool_] | slice) -> Spans:
        """Some of them."""
        return Spans(self.first[places], self.last[places], self.low[places], self.high[places])

    def along(self, columns: list[int]) -> Spans:
        """The same with some of the inputs."""
        return Spans(self.first, self.last, self.low[:, columns], self.high[:, columns])

    def cut(self, laws: Sequence[TimeFunction], parts: int) -> Spans:
        """Each cut into parts of one length."""
        shares = np.arange(parts + 1) / parts
        edges = self.first[:, None] + (self.last - self.first)[:, None] * shares
        edges[:, -1] = self.last
        return Spans.of(laws, edges[:, :-1].ravel(), edges[:, 1:].ravel())

    @property
    def divisible(self) -> NDArray[np.bool_]:
        """Whether time can be told apart inside each, (N,)."""
        size = np.maximum(np.abs(self.first), np.abs(self.last))
        return np.asarray(self.last - self.first > 4.0 * PARTS * EPS * size)


def way_of(functions: Mapping[str, TimeFunction], start: float, stop: float) -> Spans:
    """Spans from start to stop, s, that together are hardly wider than the inputs are.

    Returns:
        Boxes with a column for each of the laws, in their order.
    """
    laws = list(functions.values())
    breaks = [b for law in laws for b in law.breaks if start < b < stop]
    edges = np.unique(np.concatenate([np.linspace(start, stop, SPANS + 1), breaks]))
    if len(edges) < 2:
        edges = np.array([start, stop])
    spans = Spans.of(laws, edges[:-1], edges[1:])
    values = np.stack([law.series(edges, 0)[..., 0] for law in laws], axis=-1)
    for _ in range(ROUNDS):
        # What lies beyond all values at hand is either there, or comes from a span that is too long.
        least, most = values.min(axis=0), values.max(axis=0)
        room = LOOSE * (most - least) + ROUNDED * np.maximum(np.abs(least), np.abs(most))
        wide = ((spans.low < least - room) | (spans.high > most + room)).any(axis=-1) & spans.divisible
        if not wide.any() or np.count_nonzero(wide) > MOST_WIDE:
            break
        parts = spans.taken(wide).cut(laws, PARTS)
        more = np.stack([law.series(parts.first, 0)[..., 0] for law in laws], axis=-1)
        values = np.stack([np.minimum(least, more.min(axis=0)), np.maximum(most, more.max(axis=0))])
        spans = _in_order(spans.taken(~wide), parts)
    return spans


def _in_order(one: Spans, other: Spans) -> Spans:
    first = np.concatenate([one.first, other.first])
    order = np.argsort(first, kind="stable")
    columns = zip((one.last, one.low, one.high), (other.last, other.low, other.high), strict=True)
    return Spans(first[order], *(np.concatenate(pair)[order] for pair in columns))


def covered_until(laws: Sequence[TimeFunction], spans: Spans, lookup: Lookup) -> float:
    """Up to when the whole way of the inputs lies on patches, s; minus infinity if its start does not.

    A span that touches what is not covered is cut until it does not, or until it is so small that the
    input itself does, or is nearer to that than can be told.

    Args:
        laws: of the free inputs of the lookup's domain, in their order.
    """
    low, high = lookup.domain.ends
    smallest = SMALL * (high - low) / lookup.domain.parts
    waiting = spans.taken(~lookup.everywhere(spans.low, spans.high))
    end = np.inf
    while len(waiting.first):
        # The earliest ones first: what comes after the end does not count.
        here, waiting = waiting.taken(slice(0, AT_ONCE)), waiting.taken(slice(AT_ONCE, None))
        final = ((here.high - here.low) <= smallest).all(axis=-1) | ~here.divisible
        if final.any():
            end = min(end, float(here.first[final].min()))
            here = here.taken(~final & (here.first < end))
            waiting = waiting.taken(waiting.first < end)
        if len(here.first):
            parts = here.cut(laws, PARTS)
            parts = parts.taken(~lookup.everywhere(parts.low, parts.high))
            waiting = _in_order(parts, waiting)
    if end == np.inf:
        return float(spans.last[-1])
    return end if end > spans.first[0] else -np.inf
