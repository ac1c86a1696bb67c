"""Counts a solver's operations, to show that nothing is computed that was not requested."""

from __future__ import annotations

from dataclasses import dataclass, fields
from operator import add, attrgetter


@dataclass(frozen=True)
class Work:
    """Numbers of operations; a batch of matrices counts each of its members.

    Attributes:
        residuals: evaluations of the constraints.
        factorisations: Jacobians built and factorised.
        rate_solves: linear solves for rates (velocity, acceleration and higher orders).
        unknowns_solved: unknowns in those solves, summed.
        segments: power series in the motion.
        series_orders: orders of those series, summed.
        derivatives_evaluated: time derivatives evaluated at the instants (0 position, 1 velocity, ...).
        coordinates_evaluated: coordinates per instant, over all derivatives.
    """

    residuals: int = 0
    factorisations: int = 0
    rate_solves: int = 0
    unknowns_solved: int = 0
    segments: int = 0
    series_orders: int = 0
    derivatives_evaluated: int = 0
    coordinates_evaluated: int = 0

    def __add__(self, other: Work) -> Work:
        return Work(*map(add, _counts(self), _counts(other)))


_counts = attrgetter(*(each.name for each in fields(Work)))
