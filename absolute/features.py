"""Points and directions fixed to bodies, each kept once, in one table for all bodies."""

from collections.abc import Sequence

import numpy as np

from absolute.solution import Array

# (body, place) of a feature.
Pick = tuple[int, int]


class Features:
    """Collects features in body axes; when all are in, `tables` and `flat` make arrays of them."""

    def __init__(self, bodies: int) -> None:
        self.bodies = bodies
        self._vectors: list[list[Array]] = [[] for _ in range(bodies)]
        self._points: list[list[float]] = [[] for _ in range(bodies)]
        self._places: dict[tuple[int, bytes, bool], Pick] = {}

    def add(self, body: int, vector: Array, is_point: bool) -> Pick:
        """(body, place) of a feature given in body axes."""
        key = (body, vector.tobytes(), is_point)
        if key not in self._places:
            self._places[key] = (body, len(self._vectors[body]))
            self._vectors[body].append(vector)
            self._points[body].append(float(is_point))
        return self._places[key]

    def tables(self) -> tuple[Array, Array]:
        """Vectors (bodies, places, 3), padded with zeros, and 1.0 where a feature is a point."""
        vectors = np.zeros((len(self._vectors), self._width, 3))
        is_point = np.zeros((len(self._vectors), self._width, 1))
        for body, (held, points) in enumerate(zip(self._vectors, self._points, strict=True)):
            if held:
                vectors[body, : len(held)] = held
                is_point[body, : len(held), 0] = points
        return vectors, is_point

    def flat(self, picks: Sequence[Sequence[Pick]]) -> list[list[int]]:
        """Places in the flattened table."""
        width = self._width
        return [[body * width + place for body, place in pick] for pick in picks]

    @property
    def _width(self) -> int:
        return max(len(held) for held in self._vectors)
