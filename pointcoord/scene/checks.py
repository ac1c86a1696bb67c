"""Checks of single values of a scene: text, numbers, lists and tables of them (see `scene_part`)."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite
from typing import SupportsFloat

import numpy as np

from pointcoord.scene.scene_part import WRONG, Check, Faults, Part, Place

NO_NUMBERS = (bool, np.bool_, np.ndarray, np.complexfloating)
"""What Python would make a float of although it is none."""


def text(value: object, place: Place, faults: Faults) -> object:
    """A string."""
    return value if isinstance(value, str) else faults.note(place, "Input should be a valid string", value)


def one_of(*allowed: str) -> Check:
    """One of some strings."""
    words = " or ".join(map(repr, allowed))

    def check(value: object, place: Place, faults: Faults) -> object:
        if isinstance(value, str) and value in allowed:
            return value
        return faults.note(place, f"Input should be {words}", value)

    return check


def number(value: object, place: Place, faults: Faults) -> object:
    """A finite number, as one of Python's own."""
    return _finite(_as_float(value), value, place, faults)


def positive(value: object, place: Place, faults: Faults) -> object:
    """A finite number above zero."""
    found = _as_float(value)
    if found is not None and not found > 0.0:
        return faults.note(place, "Input should be greater than 0", value)
    return _finite(found, value, place, faults)


def _as_float(value: object) -> float | None:
    """What counts as a number; truth does not, and neither does an array of one."""
    if type(value) is float:
        return value
    if isinstance(value, NO_NUMBERS) or not isinstance(value, int | SupportsFloat):
        return None
    try:
        return float(value)
    except (OverflowError, TypeError, ValueError):
        return None  # such as a whole number of hundreds of digits


def _finite(found: float | None, value: object, place: Place, faults: Faults) -> object:
    if found is None:
        # A truth of numpy's is shown as one of Python's own.
        own = bool(value) if isinstance(value, np.bool_) else value
        return faults.note(place, "Input should be a valid number", own)
    return found if isfinite(found) else faults.note(place, "Input should be a finite number", found)


def whole_number(least: int, most: int) -> Check:
    """A whole number in a range."""

    def check(value: object, place: Place, faults: Faults) -> object:
        if isinstance(value, bool) or not isinstance(value, int | np.integer):
            return faults.note(place, "Input should be a valid integer", value)
        found = int(value)
        if found > most:
            return faults.note(place, f"Input should be less than or equal to {most}", found)
        if found < least:
            return faults.note(place, f"Input should be greater than or equal to {least}", found)
        return found

    return check


def optional(check: Check) -> Check:
    """A value that may be None."""

    def checked(value: object, place: Place, faults: Faults) -> object:
        return None if value is None else check(value, place, faults)

    return checked


def _items(value: object) -> tuple[object, ...] | None:
    """The items of what counts as a list: no text, no table."""
    if isinstance(value, list | tuple):
        return tuple(value)
    if isinstance(value, str | bytes | bytearray | Mapping) or not hasattr(value, "__iter__"):
        return None
    return tuple(value)


def list_of(check: Check, at_least: int = 0) -> Check:
    """A list of any length from a least one, as a tuple."""

    def checked(value: object, place: Place, faults: Faults) -> object:
        items = _items(value)
        if items is None:
            return faults.note(place, "Input should be a list", value)
        before = len(faults)
        kept = tuple(check(item, (*place, i), faults) for i, item in enumerate(items))
        if len(items) < at_least:
            more = f"at least {at_least} item{'s' if at_least > 1 else ''}"
            return faults.note(place, f"List should have {more}", value)
        return WRONG if len(faults) > before else kept

    return checked


def vector(value: object, place: Place, faults: Faults) -> object:
    """Three finite numbers."""
    items = _items(value)
    if items is None:
        return faults.note(place, "Input should be a list", value)
    if len(items) > 3:
        return faults.note(place, "List should have at most 3 items", value)
    before = len(faults)
    kept = tuple(number(item, (*place, i), faults) for i, item in enumerate(items))
    for i in range(len(items), 3):
        faults.note((*place, i), f"a number is missing: there are {i} where three belong")
    return WRONG if len(faults) > before else kept


def table_of(check: Check) -> Check:
    """A table with keys of one's own, as a dictionary."""

    def checked(value: object, place: Place, faults: Faults) -> object:
        if not isinstance(value, Mapping):
            return faults.note(place, "Input should be a table", value)
        before, kept = len(faults), {}
        for name, item in value.items():
            if not isinstance(name, str):
                faults.note((*place, name, "[key]"), "Input should be a valid string", name)
            kept[name] = check(item, (*place, name), faults)
        return WRONG if len(faults) > before else kept

    return checked


def plain_table(value: object, place: Place, faults: Faults) -> object:
    """A table of plain data, with tuples for its lists."""
    if not isinstance(value, Mapping):
        return faults.note(place, "Input should be a table", value)
    return {name: _plain(each) for name, each in value.items()}


def _plain(value: object) -> object:
    if isinstance(value, Mapping):
        return {name: _plain(each) for name, each in value.items()}
    return tuple(map(_plain, value)) if isinstance(value, list | tuple) else value


def part(kind: type[Part]) -> Check:
    """A part of the scene."""
    return kind.read_from
