"""The error of a file of another program, or of the map or the names that describe it."""

from __future__ import annotations

from pointcoord import PointcoordError


class FileError(PointcoordError, ValueError):
    """A file of results or hardpoints, or the map or file of names that describes it, cannot be used.

    Args:
        source: the file.
        place: the line (its number, or in words), column or key at fault; empty or 0 for the whole file.
        problem: what is wrong, with the value.
        allowed: what would be right, or what to try.
    """

    def __init__(self, source: str, place: str | int, problem: str, allowed: str) -> None:
        self.source = source
        self.place = f"line {place}" if place and isinstance(place, int) else str(place or "")
        self.problem = problem
        where = f"{source}: {self.place}" if self.place else source
        super().__init__(f"{where}: {problem}", allowed)
