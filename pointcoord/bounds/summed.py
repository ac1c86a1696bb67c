"""Truncation and rounding error of the sum of a series."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pointcoord.numerics.arrays import Array
from pointcoord.numerics.rounding import EPS


@dataclass(frozen=True)
class Summed:
    """Magnitudes of the terms that add up to a derivative of the coordinates, (N, size), units per s^d.

    Attributes:
        last, before: sum of the magnitudes of the last two terms, and of the two terms before them.
        terms: sum of the magnitudes of all terms. The rounding error of the terms is in proportion to this
            sum and to the condition number, also where terms cancel.
    """

    last: Array
    before: Array
    terms: Array

    def expected(self, value: Array, condition: Array, time: Array) -> Array:
        """Truncation and rounding error of the sum, in addition to the rounding of its value, (N, size).

        If each two terms are q times the two terms before, the truncated terms add up to last q / (1 - q).
        The last two terms are added to them, which gives last / (1 - q), and q is limited to 0.95.

        Args:
            value: the sum, in the unit of time of `time`.
            condition: condition number of C_u, (N,).
            time: power d of the unit of time, s^d, (N,).
        """
        terms = self.terms * time[:, None]
        cancelled = np.maximum(terms - np.abs(value), 0.0).max(axis=-1)
        rounded = EPS * (terms + (condition * cancelled)[:, None])
        largest = [part.max(axis=-1) for part in (self.last, self.before)]
        with np.errstate(divide="ignore", invalid="ignore"):
            falling = np.clip(np.nan_to_num(largest[0] / largest[1], posinf=1.0), 0.0, 0.95)
        return np.asarray(self.last * (time / (1.0 - falling))[:, None] + rounded)
