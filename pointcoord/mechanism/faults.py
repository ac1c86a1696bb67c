"""Errors in the tables of a file, with place, problem and allowed values; and pydantic's errors as such."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import Any

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from pointcoord.errors import SceneError
from pointcoord.wording import meant, shown, shown_key

# Pydantic's messages that speak of Python types -> messages that speak of the file.
WORDS = {
    "missing": "this key is missing",
    "dataclass_type": "Input should be a table",
    "dict_type": "Input should be a table",
    "model_type": "Input should be a table",
    "string_too_short": "Input should be a name",
    "tuple_type": "Input should be a list",
}
# Errors whose message contains the value already.
COMPLETE = ("missing", "too_short", "too_long", "value_error")
MOST_KEYS = 3  # of further errors, in a message


class TableFault(ValueError):
    """An error in a table.

    Args:
        place: keys from the top of the tables. problem: with the value. allowed: what would be right.
    """

    def __init__(self, place: Iterable[str | int], problem: str, allowed: str = "") -> None:
        self.place, self.problem, self.allowed = tuple(place), problem, allowed
        super().__init__(problem)

    def under(self, *place: str | int) -> TableFault:
        """The same error in tables that are part of larger tables, at `place`."""
        return TableFault((*place, *self.place), self.problem, self.allowed)

    @property
    def key(self) -> str:
        """The place as dotted keys."""
        return ".".join(shown_key(one) for one in self.place if one != "")

    def of_file(self, source: str, others: Sequence[TableFault] = ()) -> SceneError:
        """This error as an error of a file; `others` are further errors in it, named by their keys."""
        keys = list(dict.fromkeys(one.key for one in others))
        rest = f" and {len(keys) - MOST_KEYS} more" if len(keys) > MOST_KEYS else ""
        more = f" (also look at: {', '.join(keys[:MOST_KEYS])}{rest})" if keys else ""
        return SceneError(source, self.key, self.problem + more, self.allowed)


def no_such(kind: str, name: object, known: Iterable[str], place: Iterable[str | int] = ()) -> TableFault:
    """The error for an unknown name."""
    there = tuple(known)
    hint = meant(name, there) if isinstance(name, str) else ""
    return TableFault(place, f"no {kind} is called {shown(name)}{hint}", ", ".join(there) or "none")


def known_name(kind: str, name: object, known: Collection[str], place: Iterable[str | int] = ()) -> None:
    """Check that a name is known.

    Raises:
        TableFault: it is unknown.
    """
    if name not in known:
        raise no_such(kind, name, known, place)


def known_keys(table: object, known: Collection[str]) -> object:
    """The table, checked to have only known keys.

    Raises:
        TableFault: a key is unknown.
    """
    given = table if isinstance(table, Mapping) else {}
    for key in given:
        if key not in known:
            hint = meant(str(key), (name for name in known if name not in given))
            raise TableFault((key,), f"there is no such key{hint}", ", ".join(known))
    return table


def faults_of(
    error: ValidationError, place: Sequence[str | int] = (), written: object = None
) -> list[TableFault]:
    """Pydantic's errors in a table at a place.

    Args:
        written: the table before lengths were converted to mm; messages show its values.
    """
    return [_fault(found, place, written) for found in error.errors(include_url=False)]


def _fault(found: ErrorDetails, place: Sequence[str | int], written: object) -> TableFault:
    where, value = (*place, *found["loc"]), _value_at(written, found["loc"], found["input"])
    cause: object = found.get("ctx", {}).get("error")
    if isinstance(cause, TableFault):
        return cause.under(*where)
    if found["type"] == "missing" and isinstance(where[-1], int):
        return TableFault(where, f"a number is missing: {where[-1]} given where three are needed")
    message = str(cause) if cause else found["msg"].replace("Tuple", "List").replace(" after validation", "")
    words = WORDS.get(found["type"]) or message
    complete = found["type"] in COMPLETE or isinstance(value, Mapping | BaseModel)
    return TableFault(where, words if complete else f"{words}, not {shown(value)}")


def _value_at(table: Any, keys: Sequence[str | int], otherwise: object) -> object:
    """The value under keys in nested tables and lists; `otherwise` if there is none."""
    for key in keys:
        try:
            table = table[key]
        except (TypeError, LookupError):
            return otherwise
    return table
