r"""A file of results as columns of numbers, and how finely each number is written.

Text: commas, semicolons, tabs or blanks between cells, found by looking; decimal commas; lines of comment;
names of columns, and their units in a line of their own or behind the names, such as "camber [deg]".
Parquet: columns of numbers.

A number tells no more than its last digit: 12.40 is anything from 12.395 to 12.405. Programs that write
doubles in full leave zeros off, and there 0.1 is 0.1: where any number of a file has fifteen digits, all of
them are taken as written in full.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from pointcoord import SceneError
from pointcoord.toml_text import read_file
from validate.extras import needed
from validate.plain_text import shown
from validate.tables.cells import NUMBER, is_number, joined, lines_of, text_of
from validate.tables.errors import FileError
from validate.tables.units import is_unit

Array = NDArray[np.float64]

NOTHING = {"", "nan", "na", "n/a", "#n/a", "null", "none", "-", "--", "?"}
# Digits that only a double in full has.
DOUBLE = 15
_UNIT_BEHIND = re.compile(r"(.*\S)\s*(?:\[([^\]]*)\]|\(([^)]*)\))")


@dataclass(frozen=True)
class Columns:
    """What stands in a file.

    Attributes:
        source: the file.
        names: of the columns. units: as the file says them; empty where it does not.
        values: (columns, rows), NaN where there is none.
        steps: the unit of the last digit of each number, likewise; 0 where a number is written in full.
        rows: what to call each row, such as "line 7".
        words: columns that hold no numbers, and what they hold.
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
            problem, allowed = f"{shown(name)!r} is there {count} times", "each name once; rename one of them"
            raise FileError(self.source, "names of the columns", problem, allowed)


def read_columns(path: str) -> Columns:
    """Read a file: Parquet by its first bytes or its ending, anything else as text.

    Raises:
        FileError: it cannot be read, is empty, or holds what is no table of numbers.
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
        raise FileError(source, "", "holds bytes that are no text", "text, or Parquet")
    return columns_of_text(text, source)


def _parquet(path: str, source: str) -> Columns:
    parquet = needed(".parquet", "pyarrow.parquet", "parquet")
    try:
        table = parquet.read_table(path)
        found = {name_and_unit(name): table.column(i).to_numpy() for i, name in enumerate(table.column_names)}
    # pyarrow's errors have no family of their own.
    except Exception as error:
        problem = f"is no Parquet that can be read ({' '.join(str(error).split())})"
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
            # Single precision rounds to half of the distance to the next number.
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
    count = _width(rows[0][1], head)
    if not head:
        # As numpy and gnuplot write names: in the last comment before the numbers.
        before = [row for number, row in lines.comments if number < rows[0][0]]
        head = [row for row in before[-1:] if len(joined(row)) == count]
    names, units = _names(head, count, source)
    names = tuple(name or f"column {i + 1}" for i, name in enumerate(names))
    for line, row in rows:
        if len(row) < count or any(row[count:]):
            allowed = f"{count}, one for each of {', '.join(names)}"
            raise FileError(source, f"line {line}", f"has {len(row)} cells", allowed)
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
    """Whether a line is one of numbers: as many of its cells are as are not."""
    told = [cell for cell in row if cell.lower() not in NOTHING]
    return bool(told) and sum(map(is_number, told)) * 2 >= len(told)


def _width(row: Sequence[str], head: Sequence[Sequence[str]]) -> int:
    """How many columns there are, without empty ones behind a delimiter at the end of every line."""
    told = [i for line in (row, *head) for i, cell in enumerate(line[: len(row)]) if cell]
    return max(told, default=0) + 1


def _names(head: Sequence[Sequence[str]], count: int, source: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Names and units from the lines above the numbers; a title of another width is passed over."""
    short = [row if any(row[count:]) else row[:count] for row in head]
    wide = [row if len(row) == count else joined(row) for row in short]
    wide = [row for row in wide if len(row) == count]
    if not wide:
        if head:
            problem = f"has {count} columns of numbers under {len(joined(head[-1]))} names"
            raise FileError(source, "names of the columns", problem, "a name for each column")
        return tuple(str(i + 1) for i in range(count)), ("",) * count
    names, units = (list(part) for part in zip(*map(name_and_unit, wide[0]), strict=True))
    for row in wide[1:]:
        told = [cell.strip("[]() ") for cell in row]
        wrong = [cell for cell in told if cell not in ("", "-", "1") and not is_unit(cell)]
        if wrong:
            problem = f"holds {shown(wrong[0])!r}, which is no unit"
            raise FileError(source, "line of units", problem, "mm, deg, rad, s and so on")
        units = [unit or (cell if is_unit(cell) else "") for unit, cell in zip(units, told, strict=True)]
    return tuple(names), tuple(units)


def name_and_unit(cell: str) -> tuple[str, str]:
    """A name and the unit behind it; round brackets may hold anything else."""
    found = _UNIT_BEHIND.fullmatch(cell.strip())
    if found is not None and found.group(2) is not None:
        return found.group(1), found.group(2).strip()
    if found is not None and is_unit(found.group(3)):
        return found.group(1), found.group(3).strip()
    return cell.strip(), ""


def _number(cell: str, source: str, line: int, name: str) -> tuple[float, int, int]:
    """A number, and how many decimals and significant digits it is written with."""
    if cell.lower() in NOTHING:
        return math.nan, 0, 0
    found = NUMBER.fullmatch(cell)
    value = float(re.sub("[dD]", "e", cell)) if found else math.inf
    if found is None or not math.isfinite(value):
        problem = f"{shown(cell)!r} is no finite number"
        allowed = "a number, or nothing, - or nan for none"
        raise FileError(source, f"line {line}, column {shown(name)!r}", problem, allowed)
    whole, _, part = found.group(1).partition(".")
    return value, len(part) - int(found.group(2) or 0), max(len((whole + part).lstrip("0")), 1)
