"""A comparison instant by instant: the difference of a quantity, and what it is held to there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from validate.comparison.compare import SMALLEST, Comparison, Outcome, gaps_between
from validate.comparison.given import given
from validate.comparison.tolerance import largest_numbers, tolerance

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
        return np.where(self.difference == 0.0, 0.0, self.difference / (self.tolerance + SMALLEST))


def over_time(outcome: Outcome, row: Comparison, instants: Array) -> OverTime | None:
    """A row of an outcome over its instants, (N,); None where one of both gives no such numbers."""
    sides = [given(solution, instants) for solution in outcome.solutions]
    both = sides[0].found & sides[1].found
    one, two = (side.at(both) for side in sides)
    if not both.any() or any(row.name not in side.numbers[row.quantity] for side in (one, two)):
        return None
    count = int(both.sum())
    pairs = [side.numbers[row.quantity][row.name].reshape(count, -1) for side in (one, two)]
    nothing = np.zeros_like(pairs[0])
    claims = [side.claims[row.quantity].get(row.name, nothing).reshape(count, -1) for side in (one, two)]
    # As a whole comparison takes it: the smaller one of both sides.
    largest = min(float(largest_numbers(s.numbers[row.quantity].values(), count).max()) for s in (one, two))
    gap = gaps_between(pairs[0], pairs[1], row.unit)
    allowed = outcome.factor * tolerance(claims[0], claims[1], largest)
    worst = np.argmax(np.where(gap == 0.0, 0.0, gap / (allowed + SMALLEST)), axis=1)
    each = np.arange(count)
    return OverTime(np.asarray(instants)[both], gap[each, worst], allowed[each, worst])
