"""The drawing: places of points and directions of a car before anything is solved."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np

from pointcoord.errors import MechanismError
from pointcoord.numerics.arrays import Array
from pointcoord.numerics.double_double import Pair, exact_square, pair_root, two_sum


@dataclass(frozen=True, eq=False)
class Drawing:
    """The drawn points and directions, in the mechanism's own units, each of shape (..., 3).

    Attributes:
        vectors: points, and directions of the car.
        unit: length of one unit, mm.
        lacks: rounding error of directions computed from the user's axes, to be added to the vectors.
    """

    vectors: dict[str, Array]
    unit: Array
    lacks: dict[str, Array] = field(default_factory=dict)

    def edge(self, head: str, tail: str = "") -> Pair:
        """From the point `tail` to the point `head`, as high and low part; without `tail`, a direction."""
        high = self.vectors[head]
        if tail:
            return two_sum(high, -self.vectors[tail])
        return high, self.lacks.get(head, np.zeros_like(high))

    def axis(self, tail: str, head: str) -> Pair:
        """The drawn direction from tail to head, as high and low part, of a length between 1/2 and 1.

        Without a tail: half the unit vector along a direction of the car.

        Raises:
            MechanismError: both points are at the same place.
        """
        scale = self.scale(tail, head)[..., None] if tail else 0.5
        high, low = self.edge(head, tail)
        return high * scale, low * scale

    def scale(self, tail: str, head: str) -> Array:
        """The power of two that scales the drawn distance to between 1/2 and 1, shape (...,).

        Raises:
            MechanismError: both points are at the same place.
        """
        length = self.distance(tail, head)
        if not (length > 0.0).all():
            raise no_length(tail, head)
        return np.ldexp(1.0, -np.frexp(length.real)[1])

    def distance(self, start: str, end: str) -> Array:
        """Drawn distance between two points, shape (...,)."""
        return self.length(start, end)[0]

    def length(self, start: str, end: str) -> Pair:
        """Drawn distance between two points as high and low part."""
        if (start, end) not in self._lengths:
            self._lengths[start, end] = pair_root(exact_square(self.vectors[start], self.vectors[end]))
        return self._lengths[start, end]

    @cached_property
    def _lengths(self) -> dict[tuple[str, str], Pair]:
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


class Placed(NamedTuple):
    """Coordinates that a constraint takes from the drawing: one, or the three of a vector; (...) or (..., 3).

    Attributes:
        values: as computed.
        lacks: rounding error of the values, to be added to them, at most 5 u of them; zero for unknowns,
            which the solver improves anyway.
        doubt: uncertainty of values + lacks.
    """

    values: Array
    lacks: Array | float = 0.0
    doubt: Array | float = 0.0


def no_length(start: str, end: str) -> MechanismError:
    """The error for two points at one place that must be apart for a length or a line."""
    return MechanismError(
        f"link {start} - {end} has no length: both points are at the same place; move one", [start, end]
    )
