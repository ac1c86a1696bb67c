"""What can be wrong with a file of results or with the map of its columns."""

from __future__ import annotations

from pointcoord import PointcoordError


class ResultsError(PointcoordError, ValueError):
    """A file of results, or the map of its columns, cannot be used as it is.

    Args:
        source: the file.
        place: the line, column or key at fault; empty for the whole file.
        problem: what is wrong, with the value.
        allowed: what would be right.
    """

    def __init__(self, source: str, place: str, problem: str, allowed: str) -> None:
        self.source = source
        self.place = place
        self.problem = problem
        self.allowed = allowed
        where = f"{source}: {place}" if place else source
        super().__init__(f"{where}: {problem}; allowed: {allowed}")
