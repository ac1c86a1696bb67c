"""Splits a text table into cells: separators , ; tab or blank; decimal points or decimal commas."""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass

COMMENTS = ("#", "%", "//", "!")
NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)(?:[eEdD]([+-]?\d+))?")
_DECIMAL_COMMA = re.compile(r"[+-]?\d*,\d+(?:[eEdD][+-]?\d+)?")
_WORDS = re.compile(r'"[^"]*"|\S+')

Row = tuple[int, list[str]]
"""The number of a line, and its cells."""


@dataclass(frozen=True)
class Lines:
    """The cells of a text.

    Attributes:
        rows: cells of the lines that are neither blank nor a comment; decimal commas are replaced by points.
        comments: cells of the comments.
        mark: the separator of cells; the empty text for blanks.
        mixed: the first line with a decimal comma if the text also has decimal points; 0 otherwise.
    """

    rows: Sequence[Row]
    comments: Sequence[Row]
    mark: str
    mixed: int


def text_of(data: bytes) -> str | None:
    """Decode text in UTF-8, UTF-16 with a byte-order mark, or Windows-1252; None if the data are not text."""
    wide = data[:2] in (b"\xff\xfe", b"\xfe\xff")
    try:
        text = data.decode("utf-16" if wide else "utf-8-sig")
    except UnicodeDecodeError:
        # Spreadsheets in Western Europe write this code; only names and units have letters beyond ASCII.
        text = data.decode("cp1252", "replace")
    return None if "\0" in text else text


def lines_of(text: str) -> Lines:
    """Split a text into lines of cells."""
    every = enumerate(text.replace("\N{MINUS SIGN}", "-").splitlines(), 1)
    body, aside = [], []
    for number, line in every:
        if line.lstrip().startswith(COMMENTS):
            aside.append((number, line.strip().lstrip("#%/! ")))
        elif line.strip():
            body.append((number, line.rstrip()))
    mark = _mark([line for _, line in body])
    cells = [(number, _cells(line, mark)) for number, line in body]
    commas = [number for number, row in cells if any(map(_DECIMAL_COMMA.fullmatch, row))]
    points = any(is_number(cell) and "." in cell for _, row in cells for cell in row)
    rows = [(number, [_with_point(cell) for cell in row]) for number, row in cells]
    comments = [(number, _cells(line, mark)) for number, line in aside]
    return Lines(rows, comments, mark, commas[0] if commas and points else 0)


def is_number(cell: str) -> bool:
    """Whether a cell is a number."""
    return NUMBER.fullmatch(cell) is not None


def joined(row: Sequence[str]) -> list[str]:
    """Join units in brackets to the names before them, if cells are separated by blanks."""
    found: list[str] = []
    for word in row:
        if found and word[:1] in ("[", "("):
            found[-1] += f" {word}"
        else:
            found.append(word)
    return found


def _mark(lines: Sequence[str]) -> str:
    for one in ";\t":
        if sum(one in line for line in lines) * 2 > len(lines):
            return one
    words = [word for line in lines for word in line.split() if len(line.split()) > 1]
    commas = sum(bool(_DECIMAL_COMMA.fullmatch(word)) for word in words)
    numbers = commas + sum(map(is_number, words))
    often = sum("," in line for line in lines) * 2 > len(lines)
    return "," if often and not commas * 2 > numbers else ""


def _cells(line: str, mark: str) -> list[str]:
    if not mark:
        return [word.strip('"') for word in _WORDS.findall(line)]
    try:
        return [cell.strip() for cell in next(csv.reader([line], delimiter=mark, skipinitialspace=True))]
    except csv.Error:
        # The csv module refuses very long cells.
        return [line]


def _with_point(cell: str) -> str:
    return cell.replace(",", ".") if _DECIMAL_COMMA.fullmatch(cell) else cell
