"""Errors in the tables of a file, with place, problem and allowed values; and pydantic's errors as such."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager

from pydantic import BaseModel, ValidationError

from pointcoord.errors import SceneError
from pointcoord.wording import meant, shown, shown_key

# Pydantic's messages that speak of Python types -> messages that speak of the file.
WORDS = {
    "missing": "this key is missing",
    "dataclass_type": "Input should be a table",
    "dict_type": "Input should be a table",
    "extra_forbidden": "another key gives this already",
    "model_type": "Input should be a table",
    "string_too_short": "Input should be a name",
    "tuple_type": "Input should be a list",
}
# Errors whose message contains the value already.
COMPLETE = ("missing", "too_short", "too_long", "value_error")


class TableFault(ValueError):
    """An error in a table.

    Args:
        place: keys from the top of the tables. problem: with the value. allowed: what would be right.
    """

    def __init__(self, place: Iterable[str | int], problem: str, allowed: str = "") -> None:
        self.place, self.problem, self.allowed = tuple(place), problem, allowed
        super().__init__(problem)

    def of_file(self, source: str) -> SceneError:
        """This error as an error of a file."""
        key = ".".join(shown_key(one) for one in self.place if one != "")
        return SceneError(source, key, self.problem, self.allowed)


@contextmanager
def under(*place: str | int) -> Iterator[None]:
    """Errors of what is read within this context, with the place where it stands in larger tables.

    Raises:
        TableFault: the error, from the top of the larger tables.
    """
    try:
        yield
    except ValidationError as error:
        raise fault_of(error, place) from None
    except TableFault as fault:
        raise TableFault((*place, *fault.place), fault.problem, fault.allowed) from None


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


def fault_of(error: ValidationError, place: tuple[str | int, ...] = ()) -> TableFault:
    """The first of pydantic's errors in a table at a place."""
    found = error.errors(include_url=False)[0]
    where, value, kind = (*place, *found["loc"]), found["input"], found["type"]
    cause: object = found.get("ctx", {}).get("error")
    if isinstance(cause, TableFault):
        return TableFault((*where, *cause.place), cause.problem, cause.allowed)
    if kind == "missing" and isinstance(where[-1], int):
        return TableFault(where, f"a number is missing: {where[-1]} given where three are needed")
    message = str(cause) if cause else found["msg"].replace("Tuple", "List").replace(" after validation", "")
    words = WORDS.get(kind) or message
    complete = kind in COMPLETE or isinstance(value, Mapping | BaseModel)
    return TableFault(where, words if complete else f"{words}, not {shown(value)}")
