r"""Reads a file of results as columns of numbers, with the unit of the last digit of each number.

Text files may have commas, semicolons, tabs or blanks between cells, which are detected; decimal commas;
comment lines; names of columns, and units in a separate line or after the names, such as "camber [deg]".
Parquet files have columns of numbers.

A printed number is rounded to its last digit: 12.40 is anything from 12.395 to 12.405. But programs that
write all digits of a double omit trailing zeros, so that 0.1 is exactly 0.1. If any number of a file has
fifteen digits, all numbers are taken as written in full.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from pointcoord import SceneError
from pointcoord.toml_text import read_file
from validate.arrays import Array
from validate.extras import needed
from validate.plain_text import counted_as, shown
from validate.tables.cells import NUMBER, is_number, joined, lines_of, text_of
from validate.tables.errors import FileError
from validate.tables.units import is_unit

NOTHING = {"", "nan", "na", "n/a", "#n/a", "null", "none", "-", "--", "?"}
NO_UNIT = ("", "-", "1")
# A number with so many digits is a double written in full.
DOUBLE = 15
_UNIT_BEHIND = re.compile(r"(.*\S)\s*(?:\[([^\]]*)\]|\(([^)]*)\))")


@dataclass(frozen=True)
class Columns:
    """The columns of a file.

    Attributes:
        source: the file.
        names: names of the columns. units: units as in the file; empty if not given.
        values: (columns, rows), NaN for no number.
        steps: unit of the last digit of each number, likewise; 0 for a number written in full.
        rows: name of each row, such as "line 7".
        words: by name, the columns that are not numbers, with their content in words.
    """

    source: str
    names: tuple[str, ...]
    units: tuple[str, ...]
    values: Array
    steps: Array
    rows: tuple[str, ...]
    words: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        (name, count), *_ = Counter(self.names).most_common(1)
        if count > 1:
            problem, allowed = f"{shown(name)!r} occurs {count} times", "each name once; rename one of them"
            raise FileError(self.source, "names of the columns", problem, allowed)


def read_columns(path: str) -> Columns:
    """Read a file: as Parquet if its first bytes or its ending say so, otherwise as text.

    Raises:
        FileError: the file cannot be read, is empty, or is not a table of numbers.
        MissingLibrary: Parquet needs pyarrow.
    """
    source = shown(path)
    try:
        data = b"PAR1" if path.endswith(".parquet") else read_file(path, "the path of a table")
    except SceneError as error:
        allowed = error.allowed or "a table; larger ones as Parquet"
        raise FileError(source, "", error.problem, allowed) from None
    if data[:4] == b"PAR1":
        return _parquet(path, source)
    text = text_of(data)
    if text is None:
        allowed = "text, or Parquet; for a workbook, save one sheet as CSV"
        raise FileError(source, "", "contains bytes that are not text", allowed)
    return columns_of_text(text, source)


def _parquet(path: str, source: str) -> Columns:
    parquet = needed(".parquet", "pyarrow.parquet")
    try:
        table = parquet.read_table(path)
        arrays = [column.to_numpy() for column in table.columns]
    # pyarrow's errors have no common base class.
    except Exception as error:
        problem = f"is not a Parquet file that can be read ({' '.join(str(error).split())})"
        raise FileError(source, "", problem, "Parquet, or text") from None
    if not table.num_columns * table.num_rows:
        raise FileError(source, "", "is empty", "a column for each quantity, and a row for each pose")
    names, units = zip(*map(name_and_unit, table.column_names), strict=True)
    values, words = np.full((len(names), table.num_rows), np.nan), dict[str, str]()
    steps = np.zeros_like(values)
    for i, (name, array) in enumerate(zip(names, arrays, strict=True)):
        if array.dtype.kind not in "iuf":
            words[name] = str(array.dtype)
            continue
        values[i] = array
        if array.dtype.kind == "f" and array.dtype.itemsize < 8:
            # The last digit in single precision is the distance to the next number.
            steps[i] = np.spacing(np.abs(array))
    rows = tuple(f"row {i + 1}" for i in range(table.num_rows))
    return Columns(source, names, units, values, steps, rows, words)


def columns_of_text(text: str, source: str) -> Columns:
    """The columns of a text.

    Raises:
        FileError: see `read_columns`.
    """
    lines = lines_of(text)
    first = next((i for i, (_, row) in enumerate(lines.rows) if _is_of_numbers(row)), None)
    if first is None:
        problem = "has no line of numbers" if lines.rows else "is empty"
        raise FileError(source, "", problem, "a line of names, and a line of numbers for each pose")
    if lines.mixed:
        problem = "has a decimal comma, and other numbers have decimal points"
        raise FileError(source, f"line {lines.mixed}", problem, "one sign before the decimals")
    head, rows = [row for _, row in lines.rows[:first]], lines.rows[first:]
    # Without empty columns after a delimiter at the end of every line.
    width = len(rows[0][1])
    count = 1 + max(i for line in (rows[0][1], *head) for i, cell in enumerate(line[:width]) if cell)
    if not head:
        # numpy and gnuplot write names in the last comment before the numbers.
        before = [joined(row) for number, row in lines.comments if number < rows[0][0]]
        head = [row for row in before[-1:] if len(row) == count]
    names, units = _names(head, count, source)
    for line, row in rows:
        if len(row) < count or any(row[count:]):
            allowed = f"{count}, one for each of {', '.join(names)}"
            raise FileError(source, f"line {line}", f"has {counted_as(len(row), 'cell')}", allowed)
    words: dict[str, str] = {}
    read = np.full((count, len(rows), 3), [math.nan, 0.0, 0.0])
    for j, name in enumerate(names):
        some = [row[j] for _, row in rows if row[j].lower() not in NOTHING]
        if some and not any(map(is_number, some)):
            words[name] = f"{shown(some[0])!r} and the like"
        else:
            read[j] = [_number(row[j], source, line, name) for line, row in rows]
    values, decimals, digits = np.moveaxis(read, -1, 0)
    with np.errstate(over="ignore"):
        steps = np.where(np.isfinite(values) & (digits.max() < DOUBLE), 10.0**-decimals, 0.0)
    return Columns(source, names, units, values, steps, tuple(f"line {line}" for line, _ in rows), words)


def _is_of_numbers(row: Sequence[str]) -> bool:
    """Whether at least half of the cells of a line are numbers."""
    filled = [cell for cell in row if cell.lower() not in NOTHING]
    return bool(filled) and sum(map(is_number, filled)) * 2 >= len(filled)


def _names(head: Sequence[Sequence[str]], count: int, source: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Names and units from the lines above the numbers; lines with another number of cells are skipped."""
    cut = [row if any(row[count:]) else row[:count] for row in head]
    wide = [row for row in (row if len(row) == count else joined(row) for row in cut) if len(row) == count]
    if head and not wide:
        problem = f"has {count} columns of numbers under {len(joined(head[-1]))} names"
        raise FileError(source, "names of the columns", problem, "a name for each column")
    if not wide:
        return tuple(str(i + 1) for i in range(count)), ("",) * count
    bare = [[cell.strip("[]() ") for cell in row] for row in wide]
    of_units = [all(cell in NO_UNIT or is_unit(cell) for cell in row) for row in bare]
    # A spreadsheet pads lines above the names with empty cells: the names are the first of the fullest lines.
    filled = [0 if units else sum(map(bool, row)) for row, units in zip(wide, of_units, strict=True)]
    first = filled.index(max(filled))
    names, units = (list(part) for part in zip(*map(name_and_unit, wide[first]), strict=True))
    for row in bare[first + 1 :]:
        wrong = [cell for cell in row if cell not in NO_UNIT and not is_unit(cell)]
        if wrong:
            problem = f"contains {shown(wrong[0])!r}, which is not a unit"
            raise FileError(source, "line of units", problem, "mm, deg, rad, s and so on")
        units = [unit or (cell if is_unit(cell) else "") for unit, cell in zip(units, row, strict=True)]
    return tuple(name or f"column {i}" for i, name in enumerate(names, 1)), tuple(units)


def name_and_unit(cell: str) -> tuple[str, str]:
    """A name and the unit after it; text in round brackets that is not a unit stays in the name."""
    found = _UNIT_BEHIND.fullmatch(cell.strip())
    if found is None:
        return cell.strip(), ""
    name, square, round_ = found.groups()
    if square is None and not is_unit(round_):
        return cell.strip(), ""
    return name, (square or round_ or "").strip()


def _number(cell: str, source: str, line: int, name: str) -> tuple[float, int, int]:
    """A number, with the numbers of decimals and of significant digits as written."""
    if cell.lower() in NOTHING:
        return math.nan, 0, 0
    found = NUMBER.fullmatch(cell)
    value = float(re.sub("[dD]", "e", cell)) if found else math.inf
    if found is None or not math.isfinite(value):
        problem = f"{shown(cell)!r} is not a finite number"
        allowed = "a number; an empty cell, - or nan for no number"
        raise FileError(source, f"line {line}, column {shown(name)!r}", problem, allowed)
    whole, _, part = found.group(1).partition(".")
    return value, len(part) - int(found.group(2) or 0), max(len((whole + part).lstrip("0")), 1)
