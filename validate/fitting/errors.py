"""Why hardpoints cannot be fitted."""

from __future__ import annotations

from pointcoord import PointcoordError


class FitError(PointcoordError, ValueError):
    """Nothing can be fitted as it is asked for.

    Args:
        place: what is at fault.
        problem: what is wrong with it.
        allowed: what would be right.
    """

    def __init__(self, place: str, problem: str, allowed: str) -> None:
        self.place = place
        self.problem = problem
        self.allowed = allowed
        super().__init__(f"{place}: {problem}; allowed: {allowed}")
