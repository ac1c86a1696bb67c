"""Layout: the order of a mechanism's coordinates in the vector y.

Unknowns come first: three per moving point, three per vector of a body, then one per slide. Known ones
follow: the constants 0 and 1, three per chassis point, three per direction, one per driven coordinate, one
per constant of the drawing. All lengths are in units of the mechanism's size, measured from its own origin.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

Triple = tuple[int, int, int]


@dataclass(frozen=True)
class Layout:
    """Names of the coordinates in the order of y."""

    moving: tuple[str, ...]
    ratios: tuple[str, ...]
    chassis: tuple[str, ...]
    directions: tuple[str, ...]
    driven: tuple[str, ...]
    vectors: tuple[str, ...] = ()
    constants: tuple[str, ...] = ()

    @cached_property
    def unknowns(self) -> int:
        """Number of unknowns, which is also the index of the constant 0 after them."""
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
    def _places(self) -> tuple[dict[str, slice], dict[str, int], int]:
        """Slices of vectors by name, indices of scalars by name, and the number of all coordinates."""
        vectors, scalars, first = dict[str, slice](), dict[str, int](), 0
        for triples, singles in (
            ((*self.moving, *self.vectors), self.ratios),
            ((*self.chassis, *self.directions), (*self.driven, *self.constants)),
        ):
            for name in triples:
                vectors[name] = slice(first, first + 3)
                first += 3
            for name in singles:
                scalars[name] = first
                first += 1
            first += 2 if first == self.unknowns else 0
        return vectors, scalars, max(first, self.one + 1)

    @property
    def size(self) -> int:
        """Number of all coordinates."""
        return self._places[2]

    def span(self, name: str) -> slice:
        """The three coordinates of a point, a direction or a vector of a body."""
        return self._places[0][name]

    def vector(self, name: str) -> Triple:
        """Indices of a vector's three coordinates, also of three constants; of "" the constant 0's."""
        if not name:
            return self.zero, self.zero, self.zero
        if name in self._places[0]:
            first = self.span(name).start
            return first, first + 1, first + 2
        x, y, z = (self.scalar(component) for component in per_axis(name))
        return x, y, z

    def scalar(self, name: str) -> int:
        """Index of a slide's place, a driven coordinate or a constant of the drawing."""
        return self._places[1][name]

    def place(self, name: str) -> slice | int:
        """Slice of a vector, or index of a scalar."""
        vectors, scalars, _ = self._places
        return vectors[name] if name in vectors else scalars[name]

    def places_in(self, whole: Layout) -> list[int]:
        """Indices of these coordinates in a larger layout that contains all of them, in this order."""
        vectors, scalars, size = self._places
        found = [whole.zero, whole.one] * (size // 2 + 1)
        for name, span in vectors.items():
            found[span] = whole.vector(name)
        for name, place in scalars.items():
            found[place] = whole.scalar(name)
        found[self.zero : self.one + 1] = whole.zero, whole.one
        return found[:size]

    def describe(self, index: int) -> str:
        """An unknown coordinate in words, such as 'y of' a point."""
        vectors = (*self.moving, *self.vectors)
        if index < 3 * len(vectors):
            return f"{'xyz'[index % 3]} of {vectors[index // 3]}"
        return self.ratios[index - 3 * len(vectors)]


def per_axis(name: str) -> tuple[str, ...]:
    """A name for each of three components."""
    return tuple(f"{name} ({axis})" for axis in "xyz")
