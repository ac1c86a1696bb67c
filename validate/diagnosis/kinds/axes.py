"""Other axes: permuted and turned round, or turned by any angle; the same for all points."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import permutations, product

import numpy as np
from numpy.typing import NDArray

from validate.diagnosis.evidence import Evidence, Row, kind_of
from validate.diagnosis.hypothesis import Hypothesis, Kind, WouldBe

Array = NDArray[np.float64]


def in_axes(evidence: Evidence, matrix: Array, rows: tuple[Row, ...], exact: bool) -> dict[Row, WouldBe]:
    """Vectors in other axes; what a body turns by keeps its sense only where the axes stay right-handed."""
    found: dict[Row, WouldBe] = {}
    for row in rows:
        if kind_of(row) != "car":
            axial = np.linalg.det(matrix) if kind_of(row) == "body" else 1.0
            allowed = evidence.allowed[row] if exact else evidence.rounded(row)
            found[row] = (evidence.held[row] @ (np.sign(axial) * matrix).T, allowed @ np.abs(matrix).T)
    return found


class Axes(Kind):
    """Axes swapped, with or without other signs."""

    name, opens, reach = "axes", True, 0

    def hypotheses(self, evidence: Evidence) -> Iterator[Hypothesis]:
        """All permutations with signs."""
        if all(kind_of(row) == "car" for row in evidence.wrong):
            return
        for places in permutations(range(3)):
            for signs in product((1.0, -1.0), repeat=3):
                matrix = np.zeros((3, 3))
                matrix[range(3), places] = signs
                if places == (0, 1, 2) and (np.prod(signs) < 0.0 or all(s > 0.0 for s in signs)):
                    continue  # nothing, or a matter of signs or of sides
                named = ["-" * (s < 0.0) + "xyz"[p] for s, p in zip(signs, places, strict=True)]
                if not evidence.wants(tuple(named)):
                    continue
                words = f"other axes: its x, y, z are our {', '.join(named)}"
                rows = in_axes(evidence, matrix, (*evidence.wrong, *evidence.beside), True)
                yield Hypothesis(
                    self.name, tuple(named), words, rows, cost=1.5 + 0.01 * sum(s < 0.0 for s in signs)
                )


KIND = Axes()
