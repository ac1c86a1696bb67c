"""Inputs over time: their laws as a scene gives them, and tables read from separate files."""

from __future__ import annotations

import csv
import re
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Annotated, Any, Self

from pydantic import Field, ValidatorFunctionWrapHandler, WrapValidator, field_validator

from pointcoord.errors import SceneError
from pointcoord.mechanism.faults import TableFault
from pointcoord.scene.reading import Reading, in_mm, now, reading
from pointcoord.scene.scene_part import AS_LIST, Length, Number, Part
from pointcoord.time_functions import Polynomial, Sine, Sum, Table, TimeFunction
from pointcoord.toml_text import read_file
from pointcoord.wording import meant, shown

SUM, SWEEP = "sum", "sweep"
LAWS = ("constant", "polynomial", "sine", "table", SUM, SWEEP)
"""The kinds of an input over time."""
DRAWN = "drawn"
SECONDS = ("s", "sec")
# Words in brackets at the end of a column's title that are units; others belong to the title.
KNOWN_UNITS = {*SECONDS, "ms", "min", "h", "mm", "cm", "m", "in", "ft", "rad", "mrad", "deg", "°", "turns"}
_IN_BRACKETS = re.compile(r"[\[(]\s*([^\[\]()]*?)\s*[\])]\s*$")


def _value(value: object, number: ValidatorFunctionWrapHandler) -> float:
    """A number in mm or rad; "drawn" is the value of the input in the drawing."""
    if value == DRAWN and isinstance(value, str):
        return now().drawn()
    if isinstance(value, str):
        raise ValueError(f'is {shown(value)}{meant(value, (DRAWN,))}; allowed: a number, or "{DRAWN}"')
    return in_mm(number(value))


Value = Annotated[Number, WrapValidator(_value)]


class SinePart(Part):
    """offset + amplitude sin(angular_frequency t + phase)."""

    amplitude: Length
    angular_frequency: Number
    phase: Number = 0.0
    offset: Value = 0.0


class TablePart(Part):
    """A cubic spline through values at increasing times."""

    times: Annotated[tuple[Number, ...], AS_LIST, Field(min_length=4)]
    values: Annotated[tuple[Value, ...], AS_LIST, Field(min_length=4)]

    def agreed(self) -> Self:
        if len(self.times) != len(self.values):
            raise ValueError(f"{len(self.times)} times and {len(self.values)} values; allowed: as many")
        for earlier, later in pairwise(self.times):
            if not earlier < later:
                problem = f"times do not increase: {later:.17g} follows {earlier:.17g}"
                raise ValueError(f"{problem}; allowed: strictly increasing times")
        if not Table(self.times, self.values).finite:
            raise ValueError(
                "the spline through the table is not finite; allowed: smaller values, or times further apart"
            )
        return self


class InputPart(Part):
    """One input over time: one of constant, polynomial (coefficients from t^0 up), sine, table and sum.

    A table may be the path of a file of two columns. A sweep, which is linear from its first value at the
    scene's start to its second at the stop, becomes a polynomial.
    """

    constant: Value | None = None
    polynomial: Annotated[tuple[Value, ...], AS_LIST, Field(min_length=1)] | None = None
    sine: SinePart | None = None
    table: TablePart | None = None
    sum: Annotated[tuple[InputPart, ...], AS_LIST, Field(min_length=1)] | None = None
    sweep: Annotated[tuple[Value, Value], AS_LIST] | None = None

    @field_validator("table", mode="before")
    @classmethod
    def _from_file(cls, table: object) -> object:
        return table_of(str(now().folder / table)) if isinstance(table, str) else table

    def agreed(self) -> Self:
        given = [name for name in LAWS if getattr(self, name) is not None]
        if len(given) != 1:
            raise ValueError(
                f"{' and '.join(given) or 'nothing'} given; allowed: exactly one of {', '.join(LAWS)}"
            )
        if self.sweep is None:
            return self
        (first, last), span = self.sweep, now().span
        if span is None or span[0] == span[1]:
            allowed = "time from a start to a later stop, or no time"
            raise TableFault((SWEEP,), "has no time span", allowed)
        slope = (last - first) / (span[1] - span[0])
        with reading(unit=Reading.unit):
            return type(self)(polynomial=(first - slope * span[0], slope))

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
        assert self.sum is not None  # exactly one is given
        return Sum(tuple(term.function for term in self.sum))

    @property
    def tables(self) -> tuple[TablePart, ...]:
        """The tables of the law and of its terms."""
        of_terms = (table for term in self.sum or () for table in term.tables)
        return (*of_terms, *(() if self.table is None else (self.table,)))


def kinds_of(law: Any) -> set[str]:
    """The kinds of laws that a law as plain data consists of."""
    terms = law.get(SUM) if isinstance(law, Mapping) else None
    if isinstance(terms, list | tuple):
        return set().union(*map(kinds_of, terms))
    return {*law} if isinstance(law, Mapping) else set()


def table_of(path: str) -> dict[str, list[float]]:
    """The two columns of a file, times and values.

    Raises:
        SceneError: the file cannot be read, is not two columns of numbers, or states other units.
    """
    allowed = "two columns of numbers, time in s and the input's value, with commas between them"
    written = read_file(path, "the path of a file of two columns, from the scene's folder")
    try:
        lines = [*csv.reader(written.decode("utf-8-sig").splitlines())]
    except UnicodeDecodeError:
        raise SceneError(path, "", "is not text in UTF-8", allowed) from None
    rows: list[list[Any]] = []
    for number, cells in enumerate(lines, start=1):
        numbers = [_number(cell) for cell in cells]
        if number == 1 and not any(one is not None for one in numbers):
            _check_titles(cells, path)
        elif cells and (len(numbers) != 2 or None in numbers):
            raise SceneError(path, f"line {number}", f"is {shown(','.join(cells))}", allowed)
        elif cells:
            rows.append(numbers)
    times, values = ([row[i] for row in rows] for i in range(2))
    return {"times": times, "values": values}


def _check_titles(cells: Sequence[str], path: str) -> None:
    """Refuse titles that state other units than those in which the numbers are read."""
    columns = ("first column, time,", SECONDS), ("second column, the input,", (now().unit,))
    for cell, (column, ours) in zip(cells, columns, strict=False):
        found = _IN_BRACKETS.search(cell)
        if found and found[1] in KNOWN_UNITS and found[1] not in ours:
            allowed = f"{' or '.join(ours)}; nothing is converted"
            raise SceneError(path, "line 1", f"says that the {column} is in {found[1]}", allowed)


def _number(cell: str) -> float | None:
    try:
        return float(cell)
    except ValueError:
        return None
