"""What is wrong with a mechanism's tables: where, what, and what is allowed."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence

from pydantic import ValidationError

from pointcoord.wording import meant, shown

# What pydantic says in Python's terms, in those of a file.
WORDS = {
    "bool_type": "true or false",
    "dataclass_type": "a table",
    "dict_type": "a table",
    "model_type": "a table",
    "string_too_short": "a name",
    "string_type": "a name",
    "too_short": "one name or more",
    "tuple_type": "a list of names",
}


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


def known_keys(table: object, known: Collection[str], what: str) -> object:
    """A table that has no other keys than the known ones.

    Raises:
        TableFault: it has.
    """
    for key in table if isinstance(table, Mapping) else ():
        if key not in known:
            raise no_such(f"key of {what}", key, known, (key,))
    return table


def fault_of(error: ValidationError, place: Sequence[str | int] = ()) -> TableFault:
    """What pydantic found first, in a table at a place."""
    first = error.errors(include_url=False)[0]
    where = (*place, *first["loc"])
    cause = first.get("ctx", {}).get("error")
    if isinstance(cause, TableFault):
        return TableFault((*where, *cause.place), cause.problem, cause.allowed)
    if first["type"] == "missing":
        return TableFault(where, "this key is missing")
    allowed = WORDS.get(first["type"]) or first["msg"].removeprefix("Input should be ")
    return TableFault(where, f"is {shown(first['input'])}", allowed)
