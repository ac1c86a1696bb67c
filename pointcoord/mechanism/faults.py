"""What is wrong with a mechanism's tables: where, what, and what is allowed."""

from __future__ import annotations

from collections.abc import Iterable

from pointcoord.wording import meant, shown


class TableFault(ValueError):
    """A table of a mechanism is not as it must be.

    Args:
        place: keys from the top of the mechanism's tables. problem: with the value. allowed: what would be.
    """

    def __init__(self, place: Iterable[str | int], problem: str, allowed: str = "") -> None:
        self.place, self.problem, self.allowed = tuple(place), problem, allowed
        super().__init__(problem)


def no_such(kind: str, name: object, known: Iterable[str], place: Iterable[str | int]) -> TableFault:
    """The fault of a name that nothing has."""
    there = tuple(known)
    hint = meant(name, there) if isinstance(name, str) else ""
    return TableFault(place, f"no {kind} is called {shown(name)}{hint}", ", ".join(there) or "none")
