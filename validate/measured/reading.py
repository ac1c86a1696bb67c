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
        words: columns without numbers, with their content in words.
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
        raise FileError(
            source, "", error.problem, error.allowed or "a table; larger ones as Parquet"
        ) from None
    if data[:4] == b"PAR1":
        return _parquet(path, source)
    text = text_of(data)
    if text is None:
        raise FileError(
            source,
            "",
            "contains bytes that are not text",
            "text, or Parquet; for a workbook, save one sheet as CSV",
        )
    return columns_of_text(text, source)


def _parquet(path: str, source: str) -> Columns:
    parquet = needed(".parquet", "pyarrow.parquet")
    try:
        table = parquet.read_table(path)
        found = {name_and_unit(name): table.column(i).to_numpy() for i, name in enumerate(table.column_names)}
    # pyarrow's errors have no common base class.
    except Exception as error:
        problem = f"is not a Parquet file that can be read ({' '.join(str(error).split())})"
        raise FileError(source, "", problem, "Parquet, or text") from None
    words = {name: str(column.dtype) for (name, _), column in found.items() if column.dtype.kind not in "iuf"}
    if len(words) == len(found) or not table.num_rows:
        problem = (
            f"has {table.num_rows} rows, and no numbers in {', '.join(map(shown, words)) or 'no column'}"
        )
        raise FileError(source, "", problem, "a column of numbers for each quantity, and at least one row")
    values, steps = np.full((len(found), table.num_rows), np.nan), np.zeros((len(found), table.num_rows))
    for i, ((name, _), column) in enumerate(found.items()):
        if name in words:
            continue
        values[i] = column
        if column.dtype.kind == "f" and column.dtype.itemsize < 8:
            # The last digit of single precision is the distance to the next number.
            steps[i] = np.spacing(np.abs(column))
    names, units = zip(*found, strict=True)
    rows = tuple(f"row {i + 1}" for i in range(table.num_rows))
    return Columns(source, names, units, values, steps, rows, words)


def columns_of_text(text: str, source: str) -> Columns:
    """The columns of a text.

    Raises:
        FileError: see `read_columns`.
    """
    lines = lines_of(text)
    cells = lines.rows
    if not cells:
        raise FileError(source, "", "is empty", "a line of names, and a line of numbers for each pose")
    if lines.mixed:
        problem = "has a decimal comma, and other numbers have decimal points"
        raise FileError(source, f"line {lines.mixed}", problem, "one sign before the decimals")
    first = next((i for i, (_, row) in enumerate(cells) if _numeric(row)), None)
    if first is None:
        raise FileError(source, "", "has no line of numbers", "a line of numbers for each pose")
    head, rows = [row for _, row in cells[:first]], cells[first:]
    # Without empty columns after a delimiter at the end of every line.
    width = len(rows[0][1])
    count = 1 + max(i for line in (rows[0][1], *head) for i, cell in enumerate(line[:width]) if cell)
    if not head:
        # numpy and gnuplot write names in the last comment before the numbers.
        before = [row for number, row in lines.comments if number < rows[0][0]]
        head = [row for row in before[-1:] if len(joined(row)) == count]
    names, units = _names(head, count, source)
    names = tuple(name or f"column {i + 1}" for i, name in enumerate(names))
    for line, row in rows:
        if len(row) < count or any(row[count:]):
            allowed = f"{count}, one for each of {', '.join(names)}"
            raise FileError(source, f"line {line}", f"has {counted_as(len(row), 'cell')}", allowed)
    words: dict[str, str] = {}
    read = np.zeros((count, len(rows), 3))
    for j, name in enumerate(names):
        some = [row[j] for _, row in rows if row[j].lower() not in NOTHING]
        if some and not any(map(is_number, some)):
            words[name], read[j, :, 0] = f"{shown(some[0])!r} and the like", np.nan
        else:
            read[j] = [_number(row[j], source, line, name) for line, row in rows]
    values, decimals, digits = np.moveaxis(read, -1, 0)
    with np.errstate(over="ignore"):
        steps = np.where(np.isfinite(values) & (digits.max() < DOUBLE), 10.0**-decimals, 0.0)
    return Columns(source, names, units, values, steps, tuple(f"line {line}" for line, _ in rows), words)


def _numeric(row: Sequence[str]) -> bool:
    """Whether a line is a line of numbers: at least half of its cells are numbers."""
    filled = [cell for cell in row if cell.lower() not in NOTHING]
    return bool(filled) and sum(map(is_number, filled)) * 2 >= len(filled)


def _names(head: Sequence[Sequence[str]], count: int, source: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Names and units from the lines above the numbers; lines with another number of cells are skipped."""
    short = [row if any(row[count:]) else row[:count] for row in head]
    wide = [row if len(row) == count else joined(row) for row in short]
    wide = [row for row in wide if len(row) == count]
    if not wide:
        if head:
            problem = f"has {count} columns of numbers under {len(joined(head[-1]))} names"
            raise FileError(source, "names of the columns", problem, "a name for each column")
        return tuple(str(i + 1) for i in range(count)), ("",) * count
    # A spreadsheet pads lines above the names with empty cells: the names are the first of the fullest lines.
    filled = [0 if _units(row) else sum(map(bool, row)) for row in wide]
    first = filled.index(max(filled))
    names, units = (list(part) for part in zip(*map(name_and_unit, wide[first]), strict=True))
    for row in wide[first + 1 :]:
        bare = [_bare(cell) for cell in row]
        wrong = [cell for cell in bare if cell not in NO_UNIT and not is_unit(cell)]
        if wrong:
            problem = f"contains {shown(wrong[0])!r}, which is not a unit"
            raise FileError(source, "line of units", problem, "mm, deg, rad, s and so on")
        units = [unit or (cell if is_unit(cell) else "") for unit, cell in zip(units, bare, strict=True)]
    return tuple(names), tuple(units)


def _units(row: Sequence[str]) -> bool:
    """Whether every cell of a line can be a unit."""
    return all(cell in NO_UNIT or is_unit(cell) for cell in map(_bare, row))


def _bare(cell: str) -> str:
    return cell.strip("[]() ")


def name_and_unit(cell: str) -> tuple[str, str]:
    """A name and the unit after it; text in round brackets that is not a unit stays in the name."""
    found = _UNIT_BEHIND.fullmatch(cell.strip())
    if found is not None and found.group(2) is not None:
        return found.group(1), found.group(2).strip()
    if found is not None and is_unit(found.group(3)):
        return found.group(1), found.group(3).strip()
    return cell.strip(), ""


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
