"""One table, and the ways to show it: plain text, a terminal, Markdown, and a page by its `grid.html`.

In a pipe, in a file and on a dumb terminal there is plain text, always the same.
"""

from __future__ import annotations

import csv
import io
import os
import re
import shutil
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, TextIO

from validate.plain_text import shown

# What a column of numbers may hold: its cells are read from the right.
NUMBER = re.compile(r"[-+]?\d|-?$|not a number$")
# As such it acts nowhere inside of a line.
PLAIN_NUMBER = re.compile(r"-?\d+(\.\d+)?(e[-+]\d+)?")
# Green, red and yellow of a terminal, by the words of verdicts; the words say it too.
COLOURS = {"agrees|as expected": "32", "DISAGREES|NOT": "1;31", "not tested|not given": "33"}
SAFE = frozenset(" ,.:;/()=-'?")
"""Characters beside letters and digits that begin nothing inside of a line of Markdown."""


@dataclass(frozen=True)
class Cell:
    """What a table says at one place: a word or a number.

    Attributes:
        detail: small print below it on a page.
        verdict: the word of a verdict that gives the cell its colour; the text says it too.
    """

    text: str
    detail: str = ""
    verdict: str = ""


@dataclass(frozen=True)
class Table:
    """Columns of words and numbers, under their names; the first cell of a row is its name.

    Attributes:
        indent: of plain text. caption: what stands above it; Markdown has none.
        folded: whether a page shows it only to who opens it.
        kept: how many columns stand first in each band of a table that is too wide.
    """

    template: ClassVar[str] = "grid.html"
    head: tuple[str, ...]
    rows: tuple[tuple[str | Cell, ...], ...]
    indent: int = 0
    caption: str = ""
    folded: bool = False
    kept: int = 1

    @cached_property
    def cells(self) -> tuple[tuple[Cell, ...], ...]:
        """Every row, cell by cell."""
        return tuple(tuple(Cell(c) if isinstance(c, str) else c for c in row) for row in self.rows)

    @cached_property
    def texts(self) -> tuple[tuple[str, ...], ...]:
        """Every row without small print."""
        return tuple(tuple(cell.text for cell in row) for row in self.cells)

    def lines(self, room: int | None = None) -> list[str]:
        """Columns of text, words to the left and numbers to the right.

        Where they do not fit into the room, they stand in bands one below the other, each with the first
        columns again.
        """
        columns = [(name, *(row[i] for row in self.texts)) for i, name in enumerate(self.head)]
        widths = [max(map(len, column)) for column in columns]
        bands = [[*range(self.kept)]]
        for i in range(self.kept, len(columns)):
            wide = self.indent + sum(widths[j] + 2 for j in (*bands[-1], i)) - 2
            if room is not None and wide > room and len(bands[-1]) > self.kept:
                bands.append([*range(self.kept)])
            bands[-1].append(i)
        found = [self.caption] if self.caption else []
        for band in bands:
            told = [
                [cell.ljust(widths[i]) if self.to_left(i) else cell.rjust(widths[i]) for cell in columns[i]]
                for i in band
            ]
            head, *rows = zip(*told, strict=True)
            rule = ["-" * widths[i] for i in band]
            found += [""] * (band is not bands[0])
            found += [(" " * self.indent + "  ".join(row)).rstrip() for row in (head, rule, *rows)]
        return found

    @property
    def markdown(self) -> str:
        """The table in Markdown, in which no cell acts; what disagrees is bold."""
        bold = dict.fromkeys(("disagrees", "moved"), "**")
        marked = ([(bold.get(one.verdict, ""), markdown(one.text)) for one in row] for row in self.cells)
        rows = ([f"{mark}{text}{mark}" for mark, text in row] for row in marked)
        lines = [[markdown(name) for name in self.head], ["---"] * len(self.head), *rows]
        return "\n".join(f"| {' | '.join(line)} |" for line in lines)

    def to_left(self, column: int) -> bool:
        """Whether a column is of words."""
        return column == 0 or not all(NUMBER.match(row[column]) for row in self.texts)


Part = str | Table
"""Lines of text, or a table."""


def text_of(parts: Sequence[Part], room: int | None = None) -> str:
    """Parts as plain text, one below the other, in a room of so many columns."""
    return "\n".join(part if isinstance(part, str) else "\n".join(part.lines(room)) for part in parts)


def text_for(stream: TextIO | None, parts: Sequence[Part]) -> str:
    """The same for a stream; a terminal has tables as wide as it is, and verdicts in colours."""
    if not is_terminal(stream):
        return text_of(parts)
    text = text_of(parts, max(shutil.get_terminal_size().columns, 20))
    if not os.environ.get("NO_COLOR"):
        for words, colour in COLOURS.items():
            text = re.sub(rf"\b({words})\b", f"\x1b[{colour}m\\1\x1b[0m", text)
    return text


def csv_of(head: Iterable[str], lines: Iterable[Iterable[object]]) -> str:
    """Lines as CSV; numbers give their bits back, a missing one is empty."""
    stream = io.StringIO()
    writer = csv.writer(stream)
    writer.writerow(head)
    writer.writerows(["" if value != value else value for value in line] for line in lines)
    return stream.getvalue()


def markdown(text: str) -> str:
    """Text that Markdown shows as it is, in one line: what could act is written as a character reference."""
    if PLAIN_NUMBER.fullmatch(text):
        return text
    plain = shown(text)

    def acts(place: int, one: str) -> bool:
        # A colon before slashes makes a link.
        return not one.isalnum() and (one not in SAFE or not place or plain[place : place + 2] == ":/")

    return "".join(f"&#{ord(one)};" if acts(place, one) else one for place, one in enumerate(plain))


def is_terminal(stream: TextIO | None) -> bool:
    """Whether a stream is a terminal that takes colours and lines that are written again."""
    dumb = os.environ.get("TERM", "dumb") in ("", "dumb", "unknown")
    return stream is not None and stream.isatty() and not dumb
