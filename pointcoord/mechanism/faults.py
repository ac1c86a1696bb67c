"""What is wrong with a file's tables: where, what, and what is allowed; and what pydantic says, likewise."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from pointcoord.errors import SceneError
from pointcoord.wording import meant, shown, shown_key

# What pydantic says in Python's terms, and a file in its own.
WORDS = {
    "missing": "this key is missing",
    "dataclass_type": "Input should be a table",
    "dict_type": "Input should be a table",
    "model_type": "Input should be a table",
    "string_too_short": "Input should be a name",
    "tuple_type": "Input should be a list",
}
# Faults that say themselves what is given.
COMPLETE = ("missing", "too_short", "too_long", "value_error")


class TableFault(ValueError):
    """A table is not as it must be.

    Args:
        place: keys from the top of the tables. problem: with the value. allowed: what would be.
    """

    def __init__(self, place: Iterable[str | int], problem: str, allowed: str = "") -> None:
        self.place, self.problem, self.allowed = tuple(place), problem, allowed
        super().__init__(problem)

    def under(self, *place: str | int) -> TableFault:
        """The same of tables that stand at a place of others."""
        return TableFault((*place, *self.place), self.problem, self.allowed)

    def of_file(self, source: str, others: int = 0) -> SceneError:
        """The error of a file, by its name, in which this is the fault and so many others are too."""
        more = f" (and {others} more)" if others else ""
        return SceneError(source, ".".join(map(shown_key, self.place)), self.problem + more, self.allowed)


def no_such(kind: str, name: object, known: Iterable[str], place: Iterable[str | int] = ()) -> TableFault:
    """The fault of a name that nothing has."""
    there = tuple(known)
    hint = meant(name, there) if isinstance(name, str) else ""
    return TableFault(place, f"no {kind} is called {shown(name)}{hint}", ", ".join(there) or "none")


def known_name(kind: str, name: object, known: Collection[str], place: Iterable[str | int] = ()) -> None:
    """Pass if something has the name.

    Raises:
        TableFault: nothing has.
    """
    if name not in known:
        raise no_such(kind, name, known, place)


def known_keys(table: object, known: Collection[str]) -> object:
    """A table that has no other keys than the known ones.

    Raises:
        TableFault: it has.
    """
    given = table if isinstance(table, Mapping) else {}
    for key in given:
        if key not in known:
            hint = meant(str(key), (name for name in known if name not in given))
            raise TableFault((key,), f"there is no such key{hint}", ", ".join(known))
    return table


def faults_of(error: ValidationError, place: Sequence[str | int] = ()) -> list[TableFault]:
    """What pydantic found in a table at a place."""
    return [_fault(found, place) for found in error.errors(include_url=False)]


def _fault(found: ErrorDetails, place: Sequence[str | int]) -> TableFault:
    where, value = (*place, *found["loc"]), found["input"]
    cause: object = found.get("ctx", {}).get("error")
    if isinstance(cause, TableFault):
        return cause.under(*where)
    if found["type"] == "missing" and isinstance(where[-1], int):
        return TableFault(where, f"a number is missing: there are {where[-1]} where three belong")
    said = str(cause) if cause else found["msg"].replace("Tuple", "List").replace(" after validation", "")
    words = WORDS.get(found["type"]) or said
    told = found["type"] in COMPLETE or isinstance(value, Mapping | BaseModel)
    return TableFault(where, words if told else f"{words}, not {shown(value)}")
