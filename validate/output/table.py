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
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import zip_longest
from textwrap import wrap
from typing import ClassVar, TextIO

from validate.plain_text import shown

# What a column of numbers may hold: its cells are read from the right.
NUMBER = re.compile(r"[-+]?\d|-?$|not a number$")
# As such it acts nowhere inside of a line.
PLAIN_NUMBER = re.compile(r"-?\d+(\.\d+)?(e[-+]\d+)?")
# Green, red and yellow of a terminal, by the words of verdicts; the words say it too.
COLOURS = {"agrees|as expected": "32", "DISAGREES|NOT": "1;31", "not tested|not given": "33"}
SAFE = frozenset(" ,.;:/()=-'?")
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
        indent: of plain text. caption: what stands above it on a page.
        folded: whether a page shows it only to who opens it.
    """

    template: ClassVar[str] = "grid.html"
    scripts: ClassVar[tuple[str, ...]] = ("grid.js",)
    head: tuple[str, ...]
    rows: tuple[tuple[str | Cell, ...], ...]
    indent: int = 0
    caption: str = ""
    folded: bool = False

    @cached_property
    def cells(self) -> tuple[tuple[Cell, ...], ...]:
        """Every row, cell by cell."""
        return tuple(tuple(Cell(c) if isinstance(c, str) else c for c in row) for row in self.rows)

    @cached_property
    def texts(self) -> tuple[tuple[str, ...], ...]:
        """Every row without small print."""
        return tuple(tuple(cell.text for cell in row) for row in self.cells)

    @property
    def text(self) -> str:
        """Columns of text: words to the left, numbers to the right."""
        return "\n".join(self.lines())

    def lines(self, room: int | None = None) -> list[str]:
        """The same in lines that are no longer than there is room for, if that is given.

        Where there is too little, cells are folded between words; where a word would be cut for it, each row
        is a list instead.
        """
        columns = [[name, *(row[i] for row in self.texts)] for i, name in enumerate(self.head)]
        whole, gap, gaps = [max(map(len, column)) for column in columns], "  ", len(columns) - 1
        widths: list[int] | None = whole
        if room is not None and self.indent + sum(whole) + 2 * gaps > room:
            gap, widths = " ", _fitting(columns, room - self.indent - gaps)
        if widths is None:
            return [
                f"    {name}: {cell}" if i else f"  {cell}"
                for row in self.texts
                for i, (name, cell) in enumerate(zip(self.head, row, strict=True))
            ]
        found = []
        for row in (self.head, ["-" * width for width in widths], *self.texts):
            cells = [
                [c] if len(c) <= w else wrap(c, w, break_on_hyphens=False)
                for c, w in zip(row, widths, strict=True)
            ]
            for line in zip_longest(*cells, fillvalue=""):
                pads = (
                    cell.ljust(width) if self.to_left(i) else cell.rjust(width)
                    for i, (cell, width) in enumerate(zip(line, widths, strict=True))
                )
                found.append((" " * self.indent + gap.join(pads)).rstrip())
        return found

    def bands(self, room: int, kept: int) -> list[Table]:
        """Tables of as many columns as there is room for, each with the first columns of this one.

        Args:
            kept: how many columns stand in each; a band has one more at least.
        """
        widths = [
            max(map(len, (name, *(row[i] for row in self.texts)))) + 2 for i, name in enumerate(self.head)
        ]
        left = self.indent + sum(widths[:kept]) - 2
        found: list[list[int]] = []
        for i in range(kept, len(self.head)):
            if not found or left + sum(widths[j] for j in (*found[-1], i)) > room:
                found.append([])
            found[-1].append(i)
        if len(found) < 2:
            return [self]
        chosen = [(*range(kept), *band) for band in found]
        return [
            replace(
                self,
                head=tuple(self.head[i] for i in band),
                rows=tuple(tuple(row[i] for i in band) for row in self.rows),
            )
            for band in chosen
        ]

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


def text_of(parts: Sequence[Part]) -> str:
    """Parts as plain text, one below the other."""
    return "\n".join(part if isinstance(part, str) else part.text for part in parts)


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
    text = shown(text)
    return "".join(_character(text, i) for i in range(len(text)))


def _character(text: str, place: int) -> str:
    one = text[place]
    inside = 0 < place < len(text) - 1 and text[place - 1].isalnum() and text[place + 1].isalnum()
    # A colon before slashes makes a link; an underscore inside of a word is one.
    if one == ":" and text[place + 1 : place + 3] == "//":
        return "&#58;"
    if one.isalnum() or (one in SAFE and (place or one == "/")) or (one == "_" and inside):
        return one
    return f"&#{ord(one)};"


def is_terminal(stream: TextIO | None) -> bool:
    """Whether a stream is a terminal that takes colours and lines that are written again."""
    dumb = os.environ.get("TERM", "dumb") in ("", "dumb", "unknown")
    return stream is not None and stream.isatty() and not dumb


def laid_out(parts: Sequence[Part]) -> str:
    """Parts as a terminal shows them: tables as wide as it is, verdicts in colours."""
    room = max(shutil.get_terminal_size().columns, 20)
    lines = [line for part in parts for line in ([part] if isinstance(part, str) else part.lines(room))]
    text = "\n".join(lines) + "\n"
    if not os.environ.get("NO_COLOR"):
        for words, colour in COLOURS.items():
            text = re.sub(rf"\b({words})\b", f"\x1b[{colour}m\\1\x1b[0m", text)
    return text


def _fitting(columns: Sequence[Sequence[str]], room: int) -> list[int] | None:
    """Widths of columns that have room together; None where a word would be cut for it."""
    widths = [max(len(word) for cell in column for word in cell.split() or [""]) for column in columns]
    rest = room - sum(widths)
    if rest < 0:
        return None
    # Whole cells in as many columns as there is room for, and what is left over to the next one.
    lacking = [max(map(len, column)) - width for column, width in zip(columns, widths, strict=True)]
    for i in sorted(range(len(widths)), key=lambda i: lacking[i]):
        more = min(lacking[i], rest)
        widths[i] += more
        rest -= more
    return widths
