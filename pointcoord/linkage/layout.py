"""Which number of y is what: the order of the coordinates of a mechanism.

Unknown ones first: three per moving point, three per vector of a body, then one per slide. Known ones after
them: the constants 0 and 1, three per chassis point, three per direction, one per driven coordinate, one per
constant of the drawing, one squared length per link. All lengths are in units of the mechanism's size,
measured from its own origin.
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
    vectors: tuple[str, ...] = ()
    constants: tuple[str, ...] = ()

    @cached_property
    def unknowns(self) -> int:
        """How many coordinates are unknown."""
        return 3 * (len(self.moving) + len(self.vectors)) + len(self.ratios)

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
        first = {name: 3 * i for i, name in enumerate((*self.moving, *self.vectors))}
        known = self.unknowns + 2
        first |= {name: known + 3 * i for i, name in enumerate((*self.chassis, *self.directions))}
        return first

    @cached_property
    def _scalars(self) -> dict[str, int]:
        slides = 3 * (len(self.moving) + len(self.vectors))
        first = {name: slides + i for i, name in enumerate(self.ratios)}
        known = self.unknowns + 2 + 3 * (len(self.chassis) + len(self.directions))
        return first | {name: known + i for i, name in enumerate((*self.driven, *self.constants))}

    @cached_property
    def _lengths(self) -> dict[tuple[str, str], int]:
        first = self.size - len(self.squared_lengths)
        return {ends: first + i for i, ends in enumerate(self.squared_lengths)}

    @cached_property
    def size(self) -> int:
        """How many coordinates there are in all."""
        vectors = 3 * (len(self.chassis) + len(self.directions))
        scalars = len(self.driven) + len(self.constants) + len(self.squared_lengths)
        return self.unknowns + 2 + vectors + scalars

    def vector(self, name: str) -> Triple:
        """Indices of the three coordinates of a point, a direction or a vector of a body."""
        if name not in self._vectors:
            raise UnknownName("point, direction or vector", name, self._vectors)
        first = self._vectors[name]
        return first, first + 1, first + 2

    def span(self, name: str) -> slice:
        """The same three as a slice."""
        first, _, last = self.vector(name)
        return slice(first, last + 1)

    def scalar(self, name: str) -> int:
        """Index of a slide's place, of a driven coordinate or of a constant of the drawing."""
        if name not in self._scalars:
            raise UnknownName("slide, driven coordinate or constant", name, self._scalars)
        return self._scalars[name]

    def squared_length(self, start: str, end: str) -> int:
        """Index of the squared length of the link from start to end."""
        if (start, end) not in self._lengths:
            raise UnknownName("link", f"{start} - {end}", (f"{a} - {b}" for a, b in self.squared_lengths))
        return self._lengths[start, end]

    def places_in(self, whole: Layout) -> list[int]:
        """Where the coordinates are in a layout that has them all, in this one's order."""
        scalars = (*self.driven, *self.constants)
        return [
            *(i for name in (*self.moving, *self.vectors) for i in whole.vector(name)),
            *(whole.scalar(name) for name in self.ratios),
            whole.zero,
            whole.one,
            *(i for name in (*self.chassis, *self.directions) for i in whole.vector(name)),
            *(whole.scalar(name) for name in scalars),
            *(whole.squared_length(*ends) for ends in self.squared_lengths),
        ]

    def describe(self, index: int) -> str:
        """An unknown coordinate in words, such as 'y of' a point."""
        vectors = (*self.moving, *self.vectors)
        if index < 3 * len(vectors):
            return f"{'xyz'[index % 3]} of {vectors[index // 3]}"
        return self.ratios[index - 3 * len(vectors)]
