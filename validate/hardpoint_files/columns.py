"""A table of points: a name and three numbers on each line, separated by commas, semicolons or tabs.

A first line of titles is not needed. Where there is one, it may say which columns are x, y and z, of which
wheel (left or right), and their unit, as in `Point, X (m), Y (m), Z (m)`.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Mapping, Sequence

from validate.hardpoint_files.axes import UNITS
from validate.hardpoint_files.contents import (
    Contents,
    FilePoint,
    HardpointFileError,
    Place,
    decimal_of,
    plain,
    short,
)

SEPARATORS = ("\t", ";", ",")
SPELLINGS = {"inch": "in", "inches": "in", "metre": "m", "meter": "m", "millimetre": "mm", "millimeter": "mm"}
SIDES = {"left": "left", "l": "left", "right": "right", "r": "right"}
ROW = "a name and three numbers, separated by commas, semicolons or tabs"

Columns = Mapping[str, Mapping[str, int]]
"""The columns of x, y and z, for each side that the titles name; "" where they name none."""


def read(text: str, source: str) -> Contents:
    """The points of a table.

    Raises:
        HardpointFileError: a line is not as it must be, or there is no point.
    """
    # The most frequent one; of as many semicolons as commas, the commas are those of numbers.
    separator = max(SEPARATORS, key=text.count)
    try:
        reader = csv.reader(io.StringIO(text, newline=""), delimiter=separator, skipinitialspace=True)
        rows = [(reader.line_num, [cell.strip() for cell in row]) for row in reader]
    except csv.Error as error:
        raise HardpointFileError(source, 0, f"is no table: {error}", ROW) from None
    rows = [(line, row) for line, row in rows if any(row) and not row[0].startswith("#")]
    if not rows:
        raise HardpointFileError(source, 0, "has no points", ROW)
    unit, name_at, columns = "", 0, {"": {"x": 1, "y": 2, "z": 3}}
    titled = _titles(rows[0][1], source, rows[0][0])
    if titled is not None:
        unit, name_at, columns = titled
        rows = rows[1:]
    comma = separator != ","
    points = [point for line, row in rows for point in _points_of(row, name_at, columns, comma, source, line)]
    if not points:
        raise HardpointFileError(source, 0, "has no points", ROW)
    return Contents(tuple(points), unit=unit)


def _titles(row: Sequence[str], source: str, line: int) -> tuple[str, int, dict[str, dict[str, int]]] | None:
    """Unit, column of the names and columns of the coordinates; None if this is no line of titles."""
    columns: dict[str, dict[str, int]] = {}
    units: list[str] = []
    others: list[int] = []
    for at, cell in enumerate(row):
        found = re.search(r"[(\[]\s*([A-Za-z]+)\s*[)\]]", cell)
        words = plain(cell[: found.start()] if found else cell).split()
        axis = [word for word in words if word in ("x", "y", "z")]
        if len(axis) != 1:
            others.append(at)
            continue
        side = next((SIDES[word] for word in words if word in SIDES), "")
        if axis[0] in columns.setdefault(side, {}):
            raise HardpointFileError(
                source,
                line,
                f"has two columns of {axis[0]} (the second is {short(cell)})",
                "one for each wheel",
            )
        columns[side][axis[0]] = at
        if found:
            units.append(found[1].lower())
    if not columns:
        return None
    for side, three in columns.items():
        missing = [axis for axis in "xyz" if axis not in three]
        if missing:
            of = f" of the {side} wheel" if side else ""
            raise HardpointFileError(source, line, f"has no column of {missing[0]}{of}", "columns x, y and z")
    spelt = {SPELLINGS.get(unit, unit) for unit in units}
    if len(spelt) > 1 or spelt - UNITS.keys():
        allowed = f"one of {', '.join(UNITS)} in all columns"
        raise HardpointFileError(source, line, f"has lengths in {', '.join(sorted(spelt))}", allowed)
    if not others:
        raise HardpointFileError(
            source, line, "has no column of names", "a column of names before x, y and z"
        )
    return spelt.pop() if spelt else "", others[0], columns


def _points_of(
    row: Sequence[str], name_at: int, columns: Columns, comma: bool, source: str, line: int
) -> list[FilePoint]:
    name = row[name_at] if name_at < len(row) else ""
    cells = {
        side: [row[three[axis]] if three[axis] < len(row) else "" for axis in "xyz"]
        for side, three in columns.items()
    }
    given = {side: three for side, three in cells.items() if any(three)}
    if not given:
        # A line of words alone is a heading; one with numbers elsewhere is a mistake.
        if any(re.match(r"[-+.]?\d", cell) for at, cell in enumerate(row) if at != name_at):
            raise HardpointFileError(source, line, f"has no coordinates for {short(name)}", ROW)
        return []
    if not name:
        raise HardpointFileError(source, line, "has coordinates without a name", ROW)
    return [
        FilePoint(name, _place(name, three, comma, source, line), line, side) for side, three in given.items()
    ]


def _place(name: str, cells: Sequence[str], comma: bool, source: str, line: int) -> Place:
    numbers = []
    for axis, cell in zip("xyz", cells, strict=True):
        # Where a comma separates nothing, it may stand for the point of a number.
        text = cell.replace(",", ".") if comma and re.fullmatch(r"[-+]?\d*,\d+", cell) else cell
        numbers.append(decimal_of(text, source, line, f"{axis} of {short(name)}"))
    return numbers[0], numbers[1], numbers[2]
