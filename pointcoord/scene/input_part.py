"""Inputs over time: their laws as a scene gives them, and tables read from separate files."""

from __future__ import annotations

import csv
import re
from collections.abc import Callable, Collection, Mapping, Sequence
from itertools import pairwise
from math import isfinite
from pathlib import Path
from typing import Annotated, Any

from pydantic import BeforeValidator, Field

from pointcoord.errors import SceneError
from pointcoord.mechanism.faults import TableFault
from pointcoord.scene.scene_part import AS_LIST, Number, Part, Place, own_list
from pointcoord.time_functions import Polynomial, Sine, Sum, Table, TimeFunction
from pointcoord.toml_text import read_file
from pointcoord.wording import meant, shown

SUM, SWEEP, TABLE = "sum", "sweep", "table"
LAWS = ("constant", "polynomial", "sine", TABLE, SUM)
"""The kinds of an input over time; a sweep is converted to a polynomial before checking."""
DRAWN = "drawn"
SPAN = ("start", "stop")
RADIAN = "rad"
TIME_UNITS = ("s", "sec")
# Words in brackets after a column title that are units; other words belong to the title.
KNOWN_UNITS = {
    *TIME_UNITS,
    "ms",
    "min",
    "h",
    "mm",
    "cm",
    "m",
    "in",
    "ft",
    RADIAN,
    "mrad",
    "deg",
    "°",
    "turns",
}
_UNIT = re.compile(r"[\[(]([^\[\]()]*)[\])]$")


def _no_word(value: object) -> object:
    """Refuses text: "drawn" has been replaced by a number before."""
    if isinstance(value, str):
        raise ValueError(f'is {shown(value)}{meant(value, (DRAWN,))}; allowed: a number, or "{DRAWN}"')
    return value


Value = Annotated[Number, BeforeValidator(_no_word)]
"""A number that may be written as "drawn"."""


class SinePart(Part):
    """offset + amplitude sin(angular_frequency t + phase)."""

    amplitude: Number
    angular_frequency: Number
    phase: Number = 0.0
    offset: Value = 0.0


class TablePart(Part):
    """A cubic spline through values at increasing times."""

    times: Annotated[tuple[Number, ...], AS_LIST, Field(min_length=4)]
    values: Annotated[tuple[Value, ...], AS_LIST, Field(min_length=4)]

    def agree(self) -> None:
        if len(self.times) != len(self.values):
            raise ValueError(f"{len(self.times)} times and {len(self.values)} values; allowed: as many")
        if stops := [pair for pair in pairwise(self.times) if not pair[0] < pair[1]]:
            earlier, later = stops[0]
            problem = f"times do not increase: {later:.17g} follows {earlier:.17g}"
            raise ValueError(f"{problem}; allowed: strictly increasing times")
        if not Table(self.times, self.values).finite:
            raise ValueError(
                "the spline through the table is not finite; allowed: smaller values, or times further apart"
            )


class InputPart(Part):
    """One input over time: one of constant, polynomial (coefficients from t^0 up), sine, table and sum.

    A sweep is converted to a polynomial before checking.
    """

    short_forms = (SWEEP,)

    constant: Value | None = None
    polynomial: Annotated[tuple[Value, ...], AS_LIST, Field(min_length=1)] | None = None
    sine: SinePart | None = None
    table: TablePart | None = None
    sum: Annotated[tuple[InputPart, ...], AS_LIST, Field(min_length=1)] | None = None

    def agree(self) -> None:
        given = [name for name in LAWS if getattr(self, name) is not None]
        if len(given) != 1:
            raise ValueError(
                f"{' and '.join(given) or 'nothing'} given; "
                f"allowed: exactly one of {', '.join((*LAWS, SWEEP))}"
            )

    @property
    def function(self) -> TimeFunction:
        if self.constant is not None:
            return Polynomial((self.constant,))
        if self.polynomial is not None:
            return Polynomial(self.polynomial)
        if self.sine is not None:
            return Sine(self.sine.amplitude, self.sine.angular_frequency, self.sine.phase, self.sine.offset)
        if self.table is not None:
            return Table(self.table.times, self.table.values)
        assert self.sum is not None  # the validator has checked that exactly one is given
        return Sum(tuple(term.function for term in self.sum))

    @property
    def tables(self) -> tuple[TablePart, ...]:
        of_terms = (table for term in self.sum or () for table in term.tables)
        return (*of_terms, *(() if self.table is None else (self.table,)))


def changed(law: Any, change: Callable[[Mapping[str, Any], Place], Any], place: Place = ()) -> Any:
    """A law as plain data, changed by a function; a sum is changed term by term.

    Args:
        change: (law that is not a sum, its place in the scene) -> the changed law. place: of the law.
    """
    if not isinstance(law, Mapping):
        return law
    terms = law.get(SUM)
    if len(law) == 1 and isinstance(terms, list | tuple):
        return {SUM: [changed(term, change, (*place, SUM, i)) for i, term in enumerate(terms)]}
    return change(law, place)


def kinds_of(law: Any) -> set[str]:
    """The kinds of laws that a law as plain data consists of."""
    found: set[str] = set()
    changed(law, lambda one, place: found.update(one))
    return found


def with_values(law: Any, change: Callable[[Any], Any], keys: Collection[str]) -> Any:
    """A law as plain data with each of its values changed; in a table, only the values of some keys."""

    def of_some(part: Any) -> Any:
        part = own_list(part)
        return list(map(of_some, part)) if isinstance(part, tuple) else change(part)

    def of_one(law: Mapping[str, Any], place: Place) -> dict[str, Any]:
        return {
            kind: {key: of_some(own) if key in keys else own for key, own in part.items()}
            if isinstance(part, Mapping)
            else of_some(part)
            for kind, part in law.items()
        }

    return changed(law, of_one)


def with_drawn(law: Any, value: Callable[[], float]) -> Any:
    """A law as plain data with "drawn" replaced by the input's value in the drawing, found only if needed."""
    return with_values(
        law, lambda own: value() if isinstance(own, str) and own == DRAWN else own, ("offset", "values")
    )


def swept(law: Any, time: Any, place: Place) -> Any:
    """A law as plain data with its sweeps as polynomials: linear from the first number at the start to the
    second at the stop.

    Args:
        time: the scene's time, as plain data. place: of the law in the scene.
    Raises:
        TableFault: a sweep is not a pair of numbers, or the scene has no time span for it.
    """
    return changed(law, lambda one, place: _swept(one, time, (*place, SWEEP)), place)


def _swept(law: Mapping[str, Any], time: Any, place: Place) -> Mapping[str, Any]:
    if SWEEP not in law:
        return law
    ends = law[SWEEP]
    if len(law) > 1:
        others = " and ".join(key for key in law if key != SWEEP)
        raise TableFault(place, f"is given together with {others}", "exactly one law")
    if not (_numbers(ends) and len(ends) == 2):
        # The scene's unit of length has been converted: numbers would not be those of the file.
        problem = f"has length {len(ends)}" if _numbers(ends) else f"is {shown(ends)}"
        raise TableFault(place, problem, "two numbers, such as [-50.0, 50.0]")
    span: list[Any] = [
        time.get(key) if isinstance(time, Mapping) else getattr(time, key, None) for key in SPAN
    ]
    if not _numbers(span) or span[0] == span[1]:
        raise TableFault(place, "has no time span", "time from a start to a later stop, or no time")
    (first, last), (start, stop) = (float(end) for end in ends), span
    slope = (last - first) / (stop - start)
    return {"polynomial": [first - slope * start, slope]}


def _numbers(value: object) -> bool:
    return isinstance(value, list | tuple) and all(
        isinstance(each, int | float) and not isinstance(each, bool) and isfinite(each) for each in value
    )


def read_in(part: Any, length: object, folder: Path = Path()) -> Any:
    """A scene's inputs, a law or its terms, with tables read from their paths, which start from a folder.

    Args:
        length: the scene's unit of length.
    Raises:
        SceneError: a file cannot be read, is not two columns of numbers, or states other units.
    """
    if isinstance(part, Mapping) and part.keys() == {TABLE} and isinstance(part[TABLE], str):
        return {TABLE: _table_of(str(folder / part[TABLE]), str(length))}
    if isinstance(part, Mapping):
        return {name: read_in(each, length, folder) for name, each in part.items()}
    return [read_in(each, length, folder) for each in part] if isinstance(part, list | tuple) else part


def _table_of(path: str, length: str) -> dict[str, list[float]]:
    allowed = "two columns of numbers, time in s and the input's value, with commas between them"
    try:
        written = read_file(path, "the path of a file of two columns, from the scene's folder")
        text = written.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise SceneError(path, "", "is not text in UTF-8", allowed) from None
    rows: list[list[Any]] = []
    for number, cells in enumerate(csv.reader(text.splitlines()), start=1):
        numbers = [_number(cell) for cell in cells]
        if number == 1 and all(one is None for one in numbers):
            _check_titles(cells, path, length)
            continue
        if not cells:
            continue
        if len(numbers) != 2 or None in numbers:
            raise SceneError(path, f"line {number}", f"is {shown(','.join(cells))}", allowed)
        rows.append(numbers)
    times, values = ([row[i] for row in rows] for i in range(2))
    return {"times": times, "values": values}


def _check_titles(cells: Sequence[str], path: str, length: str) -> None:
    """Refuse titles that say another unit than a table's numbers are taken in: nothing is converted."""
    columns = ("first column, time,", TIME_UNITS), ("second column, the input,", (length, RADIAN))
    for cell, (column, ours) in zip(cells, columns, strict=False):
        found = _UNIT.search(cell.strip())
        unit = "" if found is None else found.group(1).strip()
        if unit in KNOWN_UNITS and unit not in ours:
            allowed = f"{' or '.join(ours)}; nothing is converted"
            raise SceneError(path, "line 1", f"says that the {column} is in {unit}", allowed)


def _number(cell: str) -> float | None:
    try:
        return float(cell)
    except ValueError:
        return None
