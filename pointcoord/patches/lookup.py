"""Finds the patch of given inputs, and tells whether a whole box of inputs is covered by patches."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from pointcoord.numerics.arrays import Array, Flags, Integers
from pointcoord.patches.domain import Domain

# A value this near to the edge of a smallest box, in widths of the box, touches both boxes.
TOUCHING = 1e-3


@dataclass(frozen=True)
class Lookup:
    """The smallest boxes of a domain, each with the number of its patch.

    Attributes:
        domain: the domain that is divided into boxes.
        table: number of each smallest box, negative where there is no patch, (parts, ..., parts).
    """

    domain: Domain
    table: Integers

    @classmethod
    def of(cls, domain: Domain, low: Integers, high: Integers) -> Lookup:
        """The lookup of patches with given corners, (P, p); -1 where there is no patch."""
        table = np.full((domain.parts,) * len(domain.free), -1, dtype=np.int64)
        for number, (first, last) in enumerate(zip(low, high, strict=True)):
            table[part_of(first, last)] = number
        return cls(domain, table)

    def at(self, values: Array) -> Integers:
        """The numbers at values inside the domain, shape (..., p) to (...)."""
        places = self.domain.in_boxes(values).astype(np.int64)
        return np.asarray(self.table[tuple(np.moveaxis(np.minimum(places, self.domain.parts - 1), -1, 0))])

    def at_one(self, values: Sequence[float]) -> int:
        """The number at one set of values, -1 outside the domain; takes a tenth of the time of `at`."""
        box, parts = 0, self.domain.parts
        for value, (low, high, along) in zip(values, self._ends, strict=True):
            if not low <= value <= high:  # NaN is outside too
                return -1
            box = box * parts + min(int((value - low) * along), parts - 1)
        number: int = self.table.item(box)
        return number

    @cached_property
    def _ends(self) -> list[tuple[float, float, float]]:
        """Lower end, upper end and number of smallest boxes per unit, for each input."""
        low, high = self.domain.ends
        columns = (low.tolist(), high.tolist(), (self.domain.parts / (high - low)).tolist())
        return list(zip(*columns, strict=True))

    def everywhere(self, low: Array, high: Array) -> Flags:
        """Whether boxes of values, (N, p), touch only smallest boxes that patches cover, (N,)."""
        return ~self._gaps.any_in(*touched(self.domain, low, high))

    @cached_property
    def _gaps(self) -> Marked:
        return Marked.of(self.table < 0)


@dataclass(frozen=True)
class Marked:
    """A set of smallest boxes of a domain.

    Attributes:
        sums: number of boxes of the set below each corner in all inputs, (parts + 1, ..., parts + 1).
    """

    sums: Integers

    @classmethod
    def of(cls, marks: Flags) -> Marked:
        """The set of boxes that are marked, from a mark for each smallest box."""
        sums = np.zeros(tuple(count + 1 for count in marks.shape), dtype=np.int64)
        inner = marks.astype(np.int64)
        for axis in range(marks.ndim):
            inner = np.cumsum(inner, axis=axis)
        sums[(slice(1, None),) * marks.ndim] = inner
        return cls(sums)

    @classmethod
    def touched_by(cls, domain: Domain, low: Array, high: Array) -> Marked:
        """The set of smallest boxes that boxes of values, (N, p), touch."""
        first, last = touched(domain, low, high)
        inputs = first.shape[1]
        steps = np.zeros((domain.parts + 1,) * inputs, dtype=np.int64)
        for corner in np.ndindex(*(2,) * inputs):
            place = tuple(last[:, i] if corner[i] else first[:, i] for i in range(inputs))
            np.add.at(steps, place, -1 if sum(corner) % 2 else 1)
        for axis in range(inputs):
            steps = np.cumsum(steps, axis=axis)
        return cls.of(steps[(slice(0, -1),) * inputs] > 0)

    def any_in(self, low: Integers, high: Integers) -> Flags:
        """Whether the set has a box between two corners, in smallest boxes, each (N, p), to (N,)."""
        inputs = low.shape[1]
        found = np.zeros(len(low), dtype=np.int64)
        for corner in np.ndindex(*(2,) * inputs):
            place = tuple(high[:, i] if corner[i] else low[:, i] for i in range(inputs))
            found += (-1 if (inputs - sum(corner)) % 2 else 1) * self.sums[place]
        return np.asarray(found > 0)


def touched(domain: Domain, low: Array, high: Array) -> tuple[Integers, Integers]:
    """Corners of the region of smallest boxes that boxes of values touch, in smallest boxes, each (N, p)."""
    last = domain.parts
    first = np.clip(np.floor(domain.in_boxes(low) - TOUCHING), 0, last - 1).astype(np.int64)
    final = np.clip(np.ceil(domain.in_boxes(high) + TOUCHING), 1, last).astype(np.int64)
    return first, np.maximum(final, first + 1)


def part_of(low: Iterable[int], high: Iterable[int]) -> tuple[slice, ...]:
    """The slices of a box in a table of smallest boxes."""
    return tuple(slice(int(a), int(b)) for a, b in zip(low, high, strict=True))
