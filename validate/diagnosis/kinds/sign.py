"""The other sign: of components of vectors, or of an angle (toe in or out)."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import numpy as np

from validate.diagnosis.evidence import Evidence, Row, kind_of
from validate.diagnosis.hypothesis import Hypothesis, Kind, WouldBe


class Sign(Kind):
    """Components along the user's axes, one, two or all; an angle as a whole."""

    name, opens, closes, reach = "sign", True, True, 0

    def hypotheses(self, evidence: Evidence) -> Iterator[Hypothesis]:
        """All seven of vectors, and one for each number of the car."""
        vectors = [row for row in evidence.wrong if kind_of(row) != "car"]
        # Rows that agree as well, so that it is known whether they would under the fault.
        both = [*vectors, *(row for row in evidence.beside if kind_of(row) != "car")]
        for signs in product((1.0, -1.0), repeat=3):
            flipped = [axis for axis, sign in zip("xyz", signs, strict=True) if sign < 0.0]
            if flipped and vectors and evidence.wants(flipped.__repr__()):
                rows: dict[Row, WouldBe] = {
                    row: (evidence.held[row] * np.array(signs), evidence.allowed[row]) for row in both
                }
                words = f"the other sign of {' and '.join(flipped)}"
                yield Hypothesis(self.name, flipped.__repr__(), words, rows, cost=1.0 + 0.1 * len(flipped))
        cars = {
            row: (-evidence.held[row], evidence.allowed[row])
            for row in evidence.wrong
            if kind_of(row) == "car"
        }
        if cars:
            yield Hypothesis(self.name, "angle", "the other sign", cars)


KIND = Sign()
