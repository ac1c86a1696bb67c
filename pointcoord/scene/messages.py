"""What is wrong with a part of a scene file, in the words of the file and with the value that is there."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches

import numpy as np
from pydantic import BaseModel
from pydantic_core import ErrorDetails

# The library speaks of Python's own types.
SHAPES = {
    "missing": "this key is missing",
    "tuple_type": "Input should be a list",
    "model_type": "Input should be a table, such as { constant = 0.0 } for an input",
    "dict_type": "Input should be a table",
}
LONGEST = 60


def problem_of(fault: ErrorDetails) -> str:
    """One fault as a problem; a fault of our own validators shows its value itself."""
    kind, given = fault["type"], fault["input"]
    if kind == "missing" and fault["loc"] and isinstance(fault["loc"][-1], int):
        return f"a number is missing: there are {fault['loc'][-1]} where three belong"
    said = fault["msg"].removeprefix("Value error, ").replace("Tuple", "List")
    problem = SHAPES.get(kind, said.partition(" after validation")[0])
    if kind in ("missing", "value_error") or isinstance(given, dict | BaseModel):
        return problem
    return f"{problem}, not {shown(given)}"


def shown(value: object) -> str:
    """A value in at most 60 characters."""
    try:
        text = repr(value)
    except (ValueError, RecursionError):
        # Whole numbers of thousands of digits, and lists in lists hundreds deep, have no text in Python.
        return f"something too long to show ({type(value).__name__})"
    return text if len(text) <= LONGEST else text[: LONGEST - 3] + "..."


def meant(name: str, known: Iterable[str]) -> str:
    """A name that was perhaps misspelt, in words that follow it; empty if none is near."""
    near = get_close_matches(name.lower(), tuple(known), n=1)
    return f" (did you mean {near[0]!r}?)" if near else ""


def shown_key(key: int | str) -> str:
    """A key or a place in a list, in at most 60 characters."""
    text = str(key)
    return text if len(text) <= LONGEST else text[: LONGEST - 3] + "..."


def plain_number(value: object) -> object:
    """A scalar of numpy as one of Python's own; anything else as it is."""
    if isinstance(value, np.bool_):
        return bool(value)  # which is no number, whereas numpy's passes for one
    if isinstance(value, np.integer):
        return int(value)
    return float(value) if isinstance(value, np.floating) else value
