r"""A file of results as columns of numbers, and how finely each number is written.

Text: commas, semicolons, tabs or blanks between cells, found by looking; decimal commas; lines of comment;
names of columns, and their units in a line of their own or behind the names, such as "camber [deg]".
Parquet: columns of numbers.

A number tells no more than its last digit: 12.40 is anything from 12.395 to 12.405. Programs that write
doubles in full leave zeros off, and there 0.1 is 0.1: where any number of a file has fifteen digits, all of
them are taken as written in full.
"""

from __future__ import annotations

import csv
import math
import os
import re
import stat
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import field
from importlib import import_module

import numpy as np
from numpy.typing import NDArray

from pointcoord.data_classes import dataclass
from validate.extras import MissingPackage
from validate.measured.errors import ResultsError
from validate.measured.units import is_unit
from validate.plain_text import shown

Array = NDArray[np.float64]

LARGEST = 256_000_000  # bytes
COMMENTS = ("#", "%", "//", "!")
NOTHING = {"", "nan", "na", "n/a", "#n/a", "null", "none", "-", "--", "?"}
NOTHING_AT_ALL = "nothing"
# Digits that only a double in full has.
DOUBLE = 15
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)(?:[eEdD]([+-]?\d+))?")
_DECIMAL_COMMA = re.compile(r"[+-]?\d*,\d+(?:[eEdD][+-]?\d+)?")
_UNIT_BEHIND = re.compile(r"(.*\S)\s*(?:\[([^\]]*)\]|\(([^)]*)\))")
_WORDS = re.compile(r'"[^"]*"|\S+')


@dataclass(frozen=True)
class Columns:
    """What stands in a file.

    Attributes:
        source: the file.
        names: of the columns. units: as the file says them; empty where it does not.
        values: (columns, rows), NaN where there is none.
        steps: the unit of the last digit of each number, likewise; 0 where a number is written in full.
        rows: what to call each row, such as "line 7".
        fixed: names of columns that look printed, with their decimals, in a file that is taken as written in
            full because of others.
        no_numbers: columns that hold none, and what they hold; they are in nothing else here.
    """

    source: str
    names: tuple[str, ...]
    units: tuple[str, ...]
    values: Array
    steps: Array
    rows: tuple[str, ...]
    fixed: Mapping[str, int] = field(default_factory=dict)
    no_numbers: Mapping[str, str] = field(default_factory=dict)


def read_columns(path: str) -> Columns:
    """Read a file: Parquet by its first bytes or its ending, anything else as text.

    Raises:
        ResultsError: it cannot be read, is empty, or holds what is no table of numbers.
        MissingPackage: Parquet needs pyarrow.
    """
    source, data = shown(path), _bytes(path)
    if data[:4] == b"PAR1" or path.endswith(".parquet"):
        return _parquet(path, source)
    return columns_of_text(_text(data, source), source)


def _bytes(path: str) -> bytes:
    source = shown(path)
    try:
        if not os.path.isdir(path) and not stat.S_ISREG(os.stat(path).st_mode):
            raise ResultsError(source, "", "is a device, a pipe or a socket", "a regular file")
        with open(path, "rb") as stream:
            data = stream.read(LARGEST + 1)
    except (OSError, ValueError) as error:
        if isinstance(error, ResultsError):
            raise
        reason = getattr(error, "strerror", None) or str(error)
        raise ResultsError(source, "", f"cannot be read ({reason})", "the path of a table") from None
    if len(data) > LARGEST:
        raise ResultsError(source, "", "is larger than 256 MB", "at most 256 MB")
    return data


def _text(data: bytes, source: str) -> str:
    try:
        if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
            return data.decode("utf-16")
        if b"\0" in data:
            raise ResultsError(source, "", "holds bytes that are no text", "text, or Parquet")
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        # What spreadsheets of Western Europe write; only names and units have such letters.
        return data.decode("cp1252", "replace")


def _parquet(path: str, source: str) -> Columns:
    try:
        parquet = import_module("pyarrow.parquet")
    except ImportError as error:
        raise MissingPackage(".parquet", error, "parquet") from None
    try:
        table = parquet.read_table(path)
        found = {name: table.column(i).to_numpy() for i, name in enumerate(table.column_names)}
    # pyarrow's errors have no family of their own.
    except Exception as error:
        said = " ".join(str(error).split())
        raise ResultsError(
            source, "", f"is no Parquet that can be read ({said})", "Parquet, or text"
        ) from None
    if not found or not len(next(iter(found.values()))):
        raise ResultsError(source, "", "has no rows", "a column for each quantity, and at least one row")
    values, steps = [], []
    others = {name: str(column.dtype) for name, column in found.items() if column.dtype.kind not in "iuf"}
    found = {name: column for name, column in found.items() if name not in others}
    if not found:
        names = ", ".join(f"{shown(name)} ({kind})" for name, kind in others.items())
        raise ResultsError(source, "", f"has no column of numbers: {names}", "columns of numbers")
    for column in found.values():
        full = column.astype(float)
        values.append(full)
        # Single precision rounds to half of the distance to the next number.
        coarse = np.spacing(np.abs(column)) if column.dtype.itemsize < 8 and column.dtype.kind == "f" else 0.0
        steps.append(np.broadcast_to(np.asarray(coarse, dtype=float), full.shape))
    _require_finite(np.stack(values), source, tuple(found))
    named = [_name_and_unit(name) for name in found]
    heads, units = tuple(name for name, _ in named), tuple(unit for _, unit in named)
    rows = tuple(f"row {i + 1}" for i in range(len(values[0])))
    unnamed = {_name_and_unit(name)[0]: kind for name, kind in others.items()}
    return _checked(
        Columns(source, heads, units, np.stack(values), np.stack(steps), rows, no_numbers=unnamed)
    )


def _require_finite(values: Array, source: str, names: Sequence[str]) -> None:
    wrong = np.argwhere(np.isinf(values))
    if len(wrong):
        column, row = (int(i) for i in wrong[0])
        place = f"row {row + 1}, column {shown(names[column])!r}"
        raise ResultsError(source, place, f"is {values[column, row]}", "finite numbers, or NaN for none")


def columns_of_text(text: str, source: str) -> Columns:
    """The columns of a text.

    Raises:
        ResultsError: see `read_columns`.
    """
    lines = [
        (number, line.rstrip())
        for number, line in enumerate(text.replace("\N{MINUS SIGN}", "-").splitlines(), 1)
        if line.strip()
    ]
    body = [(number, line) for number, line in lines if not line.lstrip().startswith(COMMENTS)]
    if not body:
        raise ResultsError(source, "", "is empty", "a line of names, and a line of numbers for each pose")
    delimiter = _delimiter([line for _, line in body])
    cells = [(number, _cells(line, delimiter)) for number, line in body]
    first = next((i for i, (_, row) in enumerate(cells) if _numeric(row, delimiter)), None)
    if first is None:
        raise ResultsError(source, "", "has no line of numbers", "a line of numbers for each pose")
    head, rows = [row for _, row in cells[:first]], cells[first:]
    count = _width(rows, head)
    if not head:
        # As numpy and gnuplot write names: in the last comment before the numbers.
        before = [line for number, line in lines if number < rows[0][0]]
        named = [_cells(line.lstrip().lstrip("#%/! "), delimiter) for line in before]
        head = [row for row in named[-1:] if len(_joined(row)) == count]
    names, units = _names(head, count, source)
    words = _words(names, rows, delimiter)
    names = tuple(name or _number_of(i) for i, name in enumerate(names))
    kept = [i for i, name in enumerate(names) if name not in words]
    if words and kept:
        rows = [(n, [row[i] for i in kept] if len(row) == count else row) for n, row in rows]
        names, units = tuple(names[i] for i in kept), tuple(units[i] for i in kept)
        count = len(kept)
    numbers = _Numbers(source, names, delimiter)
    values, steps, fixed = numbers.of([(number, row) for number, row in rows], count)
    lines_of = tuple(f"line {number}" for number, _ in rows)
    return _checked(Columns(source, names, units, values, steps, lines_of, fixed, words))


def _words(names: Sequence[str], rows: Sequence[tuple[int, Sequence[str]]], delimiter: str) -> dict[str, str]:
    """Columns of a text in which no line has a number, and what they hold."""
    found = {}
    whole = [row for _, row in rows if len(row) == len(names)]
    for i, name in enumerate(names) if whole else ():
        cells = [row[i] for row in whole if row[i].lower() not in NOTHING]
        if cells and not any(_NUMBER.fullmatch(_plain(cell, delimiter)) for cell in cells):
            found[name or _number_of(i)] = f"{shown(cells[0])!r} and the like"
        elif not name and not cells:
            found[_number_of(i)] = NOTHING_AT_ALL
    return found


def _number_of(i: int) -> str:
    """What to call a column without a name, as spreadsheets' indices are."""
    return f"column {i + 1}"


def _delimiter(lines: Sequence[str]) -> str:
    """What stands between the cells; blanks are the empty text."""
    for one in ";\t":
        if sum(one in line for line in lines) * 2 > len(lines):
            return one
    words = [word for line in lines for word in line.split() if len(line.split()) > 1]
    commas = sum(bool(_DECIMAL_COMMA.fullmatch(word)) for word in words)
    numbers = commas + sum(bool(_NUMBER.fullmatch(word)) for word in words)
    if any("," in line for line in lines) and not commas * 2 > numbers:
        return "," if sum("," in line for line in lines) * 2 > len(lines) else ""
    return ""


def _cells(line: str, delimiter: str) -> list[str]:
    if not delimiter:
        return [word.strip('"') for word in _WORDS.findall(line)]
    return [cell.strip() for cell in next(csv.reader([line], delimiter=delimiter, skipinitialspace=True))]


def _joined(row: Sequence[str]) -> list[str]:
    """Names between blanks with the units that stand behind them."""
    found: list[str] = []
    for word in row:
        if found and word[:1] in "[(":
            found[-1] += f" {word}"
        else:
            found.append(word)
    return found


def _plain(cell: str, delimiter: str) -> str:
    if delimiter != "," and _DECIMAL_COMMA.fullmatch(cell):
        return cell.replace(",", ".")
    return cell


def _numeric(row: Sequence[str], delimiter: str) -> bool:
    """Whether a line is one of numbers: as many of its cells are as are not."""
    told = [cell for cell in row if cell.lower() not in NOTHING]
    return bool(told) and sum(bool(_NUMBER.fullmatch(_plain(cell, delimiter))) for cell in told) * 2 >= len(
        told
    )


def _width(rows: Sequence[tuple[int, Sequence[str]]], head: Sequence[Sequence[str]]) -> int:
    """How many columns there are, without the empty one behind a delimiter at the end of every line."""
    widths = Counter(len(row) for _, row in rows)
    named = {len(row) for row in head} | {len(_joined(row)) for row in head}
    count = max(widths, key=lambda width: (widths[width], width in named, width))
    while count > 1 and all(not any(row[count - 1 :]) for row in (*head, *(row for _, row in rows))):
        count -= 1
    return count


def _names(head: Sequence[Sequence[str]], count: int, source: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Names and units from the lines above the numbers; a title of another width is passed over."""
    wide = [
        row if len(row) == count else _joined(row)
        for row in (_without_empty_end(row, count) for row in head)
        if count in (len(row), len(_joined(row)))
    ]
    if not wide:
        if head:
            cells = len(_joined(head[-1]))
            problem = f"has {count} columns of numbers under {cells} names"
            raise ResultsError(source, "names of the columns", problem, "a name for each column")
        return tuple(str(i + 1) for i in range(count)), ("",) * count
    names, units = (list(part) for part in zip(*(_name_and_unit(cell) for cell in wide[0]), strict=True))
    for row in wide[1:]:
        told = [cell.strip("[]() ") for cell in row]
        if all(cell in ("", "-", "1") or is_unit(cell) for cell in told):
            units = [unit or (cell if is_unit(cell) else "") for unit, cell in zip(units, told, strict=True)]
        else:
            cell = next(c for c in told if c not in ("", "-", "1") and not is_unit(c))
            raise ResultsError(
                source,
                "line of units",
                f"holds {shown(cell)!r}, which is no unit",
                "mm, deg, rad, s and so on",
            )
    return tuple(names), tuple(units)


def _without_empty_end(row: Sequence[str], count: int) -> Sequence[str]:
    return row[:count] if len(row) > count and not any(row[count:]) else row


def _name_and_unit(cell: str) -> tuple[str, str]:
    """A name and the unit behind it; round brackets may hold anything else."""
    found = _UNIT_BEHIND.fullmatch(cell.strip())
    if found is not None and found.group(2) is not None:
        return found.group(1), found.group(2).strip()
    if found is not None and is_unit(found.group(3)):
        return found.group(1), found.group(3).strip()
    return cell.strip(), ""


@dataclass(frozen=True)
class _Numbers:
    """The cells of a table as numbers."""

    source: str
    names: tuple[str, ...]
    delimiter: str

    def of(
        self, rows: Sequence[tuple[int, Sequence[str]]], count: int
    ) -> tuple[Array, Array, Mapping[str, int]]:
        values = np.full((count, len(rows)), np.nan)
        decimals, digits = np.zeros(values.shape), np.zeros(values.shape)
        for i, (line, row) in enumerate(rows):
            if len(_without_empty_end(row, count)) != count:
                problem = f"has {len(row)} cells"
                raise ResultsError(
                    self.source, f"line {line}", problem, f"{count}, one for each of {', '.join(self.names)}"
                )
            for j, cell in enumerate(row[:count]):
                if cell.lower() not in NOTHING:
                    values[j, i], decimals[j, i], digits[j, i] = self._number(cell, line, j)
        return values, _steps(values, decimals, digits), self._fixed(rows, values, decimals, digits)

    def _fixed(
        self,
        rows: Sequence[tuple[int, Sequence[str]]],
        values: Array,
        decimals: Array,
        digits: Array,
    ) -> dict[str, int]:
        """Columns that look printed beside others in full: of the same decimals, with zeros at the end."""
        found = {}
        for j, name in enumerate(self.names) if digits.max() >= DOUBLE else ():
            told = decimals[j][np.isfinite(values[j])]
            zeros = any(_plain(row[j], self.delimiter).endswith("0") for _, row in rows)
            if digits[j].max() < DOUBLE and len({*told.tolist()}) == 1 and told[0] > 1 and zeros:
                found[name] = int(told[0])
        return found

    def _number(self, cell: str, line: int, column: int) -> tuple[float, int, int]:
        """A number, and how many decimals and significant digits it is written with."""
        plain = _plain(cell, self.delimiter)
        found = _NUMBER.fullmatch(plain)
        value = float(plain.replace("d", "e").replace("D", "e")) if found else math.inf
        if found is None or not math.isfinite(value):
            place = f"line {line}, column {shown(self.names[column])!r}"
            problem = f"{shown(cell)!r} is no finite number"
            raise ResultsError(self.source, place, problem, "a number, or nothing, - or nan for none")
        mantissa, power = found.group(1), int(found.group(2) or 0)
        whole, _, part = mantissa.partition(".")
        return value, len(part) - power, max(len((whole + part).lstrip("0")), 1)


def _steps(values: Array, decimals: Array, digits: Array) -> Array:
    """The unit of the last digit of every number, (columns, rows)."""
    if digits.max() >= DOUBLE:
        return np.zeros_like(values)
    with np.errstate(over="ignore"):
        return np.where(np.isfinite(values), 10.0**-decimals, 0.0)


def _checked(columns: Columns) -> Columns:
    counts = Counter(columns.names)
    name, count = counts.most_common(1)[0]
    if count > 1:
        raise ResultsError(
            columns.source,
            "names of the columns",
            f"{shown(name)!r} is there {count} times",
            "each name once; rename one of them, or take it out",
        )
    if "" in counts:
        number = columns.names.index("") + 1
        raise ResultsError(columns.source, f"column {number}", "has no name", "a name for each column")
    return columns
