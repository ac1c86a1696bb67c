"""Which number of y is what: the order of the coordinates of a mechanism.

Unknown ones first: three per moving point, then one per slide. Known ones after them: the constants 0
and 1, three per chassis point, three per direction, one per driven coordinate, one squared length per
link. All lengths are in units of the mechanism's size, measured from its own origin.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from pointcoord.errors import UnknownName

Triple = tuple[int, int, int]


@dataclass(frozen=True)
class Layout:
    """Names of the coordinates in the order of y."""

    moving: tuple[str, ...]
    ratios: tuple[str, ...]
    chassis: tuple[str, ...]
    directions: tuple[str, ...]
    driven: tuple[str, ...]
    squared_lengths: tuple[tuple[str, str], ...]

    @property
    def unknowns(self) -> int:
        """How many coordinates are unknown."""
        return 3 * len(self.moving) + len(self.ratios)

    @property
    def zero(self) -> int:
        """Index of the constant 0."""
        return self.unknowns

    @property
    def one(self) -> int:
        """Index of the constant 1."""
        return self.unknowns + 1

    @cached_property
    def _vectors(self) -> dict[str, int]:
        first = {name: 3 * i for i, name in enumerate(self.moving)}
        known = self.unknowns + 2
        first |= {name: known + 3 * i for i, name in enumerate((*self.chassis, *self.directions))}
        return first

    @cached_property
    def _scalars(self) -> dict[str, int]:
        first = {name: 3 * len(self.moving) + i for i, name in enumerate(self.ratios)}
        known = self.unknowns + 2 + 3 * (len(self.chassis) + len(self.directions))
        return first | {name: known + i for i, name in enumerate(self.driven)}

    @property
    def size(self) -> int:
        """How many coordinates there are in all."""
        vectors = 3 * (len(self.chassis) + len(self.directions))
        return self.unknowns + 2 + vectors + len(self.driven) + len(self.squared_lengths)

    def vector(self, name: str) -> Triple:
        """Indices of the three coordinates of a point or a direction."""
        if name not in self._vectors:
            raise UnknownName("point or direction", name, self._vectors)
        first = self._vectors[name]
        return first, first + 1, first + 2

    def scalar(self, name: str) -> int:
        """Index of a slide's ratio or of a driven coordinate."""
        if name not in self._scalars:
            raise UnknownName("slide or driven coordinate", name, self._scalars)
        return self._scalars[name]

    def squared_length(self, start: str, end: str) -> int:
        """Index of the squared length of the link from start to end."""
        if (start, end) not in self.squared_lengths:
            raise UnknownName("link", f"{start} - {end}", (f"{a} - {b}" for a, b in self.squared_lengths))
        return self.size - len(self.squared_lengths) + self.squared_lengths.index((start, end))

    def describe(self, index: int) -> str:
        """An unknown coordinate in words, such as 'y of tie_rod_outer'."""
        if index < 3 * len(self.moving):
            return f"{'xyz'[index % 3]} of {self.moving[index // 3]}"
        return self.ratios[index - 3 * len(self.moving)]
