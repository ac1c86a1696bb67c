"""A comparison instant by instant: the difference of a quantity, and what it is held to there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from validate.comparison.compare import Comparison, Outcome, Pair, shares
from validate.comparison.given import given_by_both

Array = NDArray[np.float64]


@dataclass(frozen=True)
class OverTime:
    """Of each instant the component that comes closest to its tolerance, arrays of shape (N,).

    Attributes:
        times: s. difference, tolerance: in the unit of the quantity; a difference that is infinite is of
            numbers of which one is none.
    """

    times: Array
    difference: Array
    tolerance: Array

    @property
    def share(self) -> Array:
        """Difference / tolerance, (N,); 0 where nothing differs."""
        return shares(self.difference, self.tolerance)


def over_time(outcome: Outcome, row: Comparison, instants: Array) -> OverTime | None:
    """A row of an outcome over its instants, (N,); None where one of both gives no such numbers."""
    times, one, two = given_by_both(*outcome.solutions, instants)
    pair = Pair(row.quantity, (one, two), outcome.factor)
    if row.name not in pair.names:
        return None
    gap, allowed = pair.gap(row.name), pair.allowed(row.name)
    each, worst = np.arange(len(gap)), np.argmax(shares(gap, allowed), axis=1)
    return OverTime(times, gap[each, worst], allowed[each, worst])
