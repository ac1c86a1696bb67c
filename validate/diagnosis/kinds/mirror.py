"""Left for right: the car mirrored in its middle plane."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from validate.diagnosis.evidence import Evidence, kind_of
from validate.diagnosis.hypothesis import Hypothesis, Kind
from validate.diagnosis.kinds.axes import in_axes


class Mirror(Kind):
    """Vectors are mirrored, turns go the other way, angles that count outboard stay as they are."""

    name, reach = "mirror", 0

    def hypotheses(self, evidence: Evidence) -> Iterator[Hypothesis]:
        """The one of the whole car."""
        right = evidence.axes.right
        matrix = np.eye(3) - 2.0 * np.outer(right, right)
        exact = bool(np.isin(np.abs(right), (0.0, 1.0)).all())
        rows = in_axes(evidence, matrix, tuple(evidence.held), exact)
        rows |= {r: (evidence.held[r], evidence.allowed[r]) for r in evidence.held if kind_of(r) == "car"}
        yield Hypothesis(self.name, "mirror", "left for right: the car is mirrored", rows, whole=True)


KIND = Mirror()
