"""A factor that is no known unit's: one for a whole row, and far enough from 1 to be meant.

A factor near 1 is what least squares makes of any small difference, such as that of two cars.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from validate.diagnosis.evidence import Evidence, kind_of
from validate.diagnosis.hypothesis import Hypothesis, Kind

NEAR = 0.01


class Factor(Kind):
    """One factor for all numbers of a quantity, by least squares."""

    name, last = "factor", True

    def hypotheses(self, evidence: Evidence) -> Iterator[Hypothesis]:
        """One for each quantity, and for each number of the car."""
        for quantity in evidence.wrong_quantities:
            rows = evidence.wrong_of(quantity)
            for some in [(row,) for row in rows] if kind_of(rows[0]) == "car" else [rows]:
                ours = np.concatenate([evidence.held[row].ravel() for row in some])
                theirs = np.concatenate([evidence.given[row].ravel() for row in some])
                square = float(ours @ ours)
                factor = float(ours @ theirs) / square if square > 0.0 else np.nan
                if np.isfinite(factor) and factor != 0.0 and abs(factor - 1.0) > NEAR:
                    found = {
                        row: (factor * evidence.held[row], abs(factor) * evidence.rounded(row))
                        for row in some
                    }
                    if any(evidence.left(row, *numbers) > 1.0 for row, numbers in found.items()):
                        continue
                    yield Hypothesis(self.name, f"{factor:.9g}", f"{factor:.7g} times ours", found, 1, 2.0)


KIND = Factor()
