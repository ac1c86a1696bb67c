"""What summing a series leaves out and rounds."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.rounding import EPS

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Summed:
    """How a derivative of the coordinates was summed from a series, (N, size), units per s^d.

    Attributes:
        last, before: the magnitudes of the last two terms, and of the two before them.
        terms: the magnitudes of all terms. Their own rounding goes with them and with the condition number,
            also where they cancel.
    """

    last: Array
    before: Array
    terms: Array

    def expected(self, value: Array, condition: Array, time: Array) -> Array:
        """Error of the sum by what is left out and by rounding, beside that of its value, (N, size).

        Terms that go on as they did, by a factor of q every two, leave out last q / (1 - q); the last two
        are counted with it, and q as at most 0.95.

        Args:
            value: the sum, per `time` s^d.
        """
        terms = self.terms * time[:, None]
        cancelled = np.maximum(terms - np.abs(value), 0.0).max(axis=-1)
        rounded = EPS * (terms + (condition * cancelled)[:, None])
        largest = [part.max(axis=-1) for part in (self.last, self.before)]
        with np.errstate(divide="ignore", invalid="ignore"):
            falling = np.clip(np.nan_to_num(largest[0] / largest[1], posinf=1.0), 0.0, 0.95)
        return np.asarray(self.last * (time / (1.0 - falling))[:, None] + rounded)
