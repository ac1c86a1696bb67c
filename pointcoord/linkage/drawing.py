"""The drawing: where every point and direction of a car stands, before anything is solved."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.double_double import Pair
from pointcoord.numerics.vectors import lengths

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Drawing:
    """The drawn points and directions, in the mechanism's own units, each of shape (..., 3).

    Attributes:
        vectors: points, and the car's directions.
        unit: the length that is 1, mm.
        lacks: what the directions that are products of the user's lack by rounding.
    """

    vectors: dict[str, Array]
    unit: Array
    lacks: dict[str, Array] = field(default_factory=dict)

    def pair(self, name: str) -> Pair:
        """A point or a direction as high and low."""
        high = self.vectors[name]
        return high, self.lacks.get(name, np.zeros_like(high))

    def distance(self, start: str, end: str) -> Array:
        """Drawn distance between two points, shape (...,)."""
        if (start, end) not in self._distances:
            self._distances[start, end] = lengths(self.vectors[start] - self.vectors[end])
        return self._distances[start, end]

    @cached_property
    def _distances(self) -> dict[tuple[str, str], Array]:
        return {}

    def stacked(self, names: Sequence[str]) -> Array:
        """Drawn points as one array, shape (..., points, 3)."""
        own = [self.vectors[name] for name in names]
        one = all(vector.ndim == 1 for vector in own)
        return np.array(own) if one else np.stack(np.broadcast_arrays(*own), axis=-2)

    def along(self, start: str, end: str, direction: str) -> Array:
        """Component of the drawn vector from start to end along a direction, shape (...,)."""
        difference = self.vectors[end] - self.vectors[start]
        return np.asarray(np.sum(difference * self.vectors[direction], axis=-1))


@dataclass(frozen=True)
class Placed:
    """Coordinates of y that a constraint reads off the drawing.

    Attributes:
        places: their indices in y.
        values: shape (..., len(places)).
        lacks: what the values lack by rounding, at most 5 u of themselves; zero for unknowns, which the
            solver improves anyway.
        doubt: how uncertain values + lacks still are.
    """

    places: tuple[int, ...]
    values: Array
    lacks: Array | float = 0.0
    doubt: Array | float = 0.0
