r"""The path of the inputs over time, enclosed: boxes that contain the inputs over spans of time.

Poses at instants do not show what happens between them: an input could leave its range and come back between
two instants. So every law gives the smallest and largest value over a span of time (`values_over`). The boxes
of all spans together contain the whole path. Spans whose boxes are too large to decide a question are cut.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from pointcoord.numerics.arrays import Array, Flags, Indices
from pointcoord.numerics.rounding import EPS
from pointcoord.patches.lookup import Lookup
from pointcoord.time_functions import TimeFunction

# Number of spans to begin with, whatever the duration.
SPANS = 1024
# A span is cut if its box exceeds the range of all computed values by more than this share of the range.
LOOSE = 1e-3
# Most rounds of cutting: a span of 1,000 s is cut to a fraction of a nanosecond.
ROUNDS = 16
# Largest rounding error of a value, relative to the largest value: cutting does not reduce it.
ROUNDED = 1e-12
# If more spans are too wide, their length is not the reason. They are left wide, which is still safe.
MOST_WIDE = 2**16
# Spans that are checked at once, and parts into which a span is cut.
AT_ONCE, PARTS = 2**16, 4
# A span whose box is this small, relative to the smallest box of a domain, is not cut further.
SMALL = 0.25


@dataclass(frozen=True)
class Spans:
    """Spans of time in order, with boxes that contain the inputs.

    Attributes:
        first, last: first and last instant of each span, (N,), s.
        low, high: lower and upper bound of the inputs over each span, (N, p), rad or mm.
    """

    first: Array
    last: Array
    low: Array
    high: Array

    @classmethod
    def of(cls, laws: Sequence[TimeFunction], first: Array, last: Array) -> Spans:
        """Spans with given ends, inside which no law has a break."""
        bounds = [law.values_over(first, last) for law in laws]
        low, high = (np.stack([bound[end] for bound in bounds], axis=-1) for end in (0, 1))
        # A bound that is not finite says nothing: the input may have any value.
        unknown = ~(np.isfinite(low) & np.isfinite(high))
        return cls(first, last, np.where(unknown, -np.inf, low), np.where(unknown, np.inf, high))

    def taken(self, places: Indices | Flags | slice) -> Spans:
        """Some of the spans."""
        return Spans(self.first[places], self.last[places], self.low[places], self.high[places])

    def along(self, columns: list[int]) -> Spans:
        """The spans with some of the inputs only."""
        return Spans(self.first, self.last, self.low[:, columns], self.high[:, columns])

    def cut(self, laws: Sequence[TimeFunction], parts: int) -> Spans:
        """The spans, each cut into parts of equal length."""
        shares = np.arange(parts + 1) / parts
        edges = self.first[:, None] + (self.last - self.first)[:, None] * shares
        edges[:, -1] = self.last
        return Spans.of(laws, edges[:, :-1].ravel(), edges[:, 1:].ravel())

    @property
    def divisible(self) -> Flags:
        """Whether each span is long enough to be cut, above the rounding of its instants, (N,)."""
        size = np.maximum(np.abs(self.first), np.abs(self.last))
        return np.asarray(self.last - self.first > 4.0 * PARTS * EPS * size)


def way_of(functions: Mapping[str, TimeFunction], start: float, stop: float) -> Spans:
    """Spans from start to stop, s, whose boxes together hardly exceed the range of the inputs.

    Returns:
        Spans with a column for each law, in the order of the laws.
    """
    laws = list(functions.values())
    breaks = [b for law in laws for b in law.breaks if start < b < stop]
    edges = np.unique(np.concatenate([np.linspace(start, stop, SPANS + 1), breaks]))
    if len(edges) < 2:
        edges = np.array([start, stop])
    spans = Spans.of(laws, edges[:-1], edges[1:])
    values = np.stack([law.series(edges, 0)[..., 0] for law in laws], axis=-1)
    for _ in range(ROUNDS):
        # A bound beyond all computed values is either reached by the input or due to a span that is too long.
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
    """Instant up to which the path of the inputs lies on patches, s; minus infinity if its start does not.

    A span whose box touches a region that is not covered is cut, until no part touches the region or until
    the part is so small that the path touches it or comes too near to distinguish.

    Args:
        laws: laws of the free inputs of the lookup's domain, in their order.
    """
    low, high = lookup.domain.ends
    smallest = SMALL * (high - low) / lookup.domain.parts
    waiting = spans.taken(~lookup.everywhere(spans.low, spans.high))
    end = np.inf
    while len(waiting.first):
        # The earliest spans first: spans after the end do not matter.
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
