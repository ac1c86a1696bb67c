"""A table, shown as plain text, on a terminal, in Markdown, or on the HTML page by `grid.html`.

Pipes, files and dumb terminals get plain text, which does not depend on the width.
"""

from __future__ import annotations

import csv
import io
import os
import re
import shutil
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, TextIO

from validate.plain_text import shown

# The cells of a column of numbers, which is aligned to the right.
NUMBER = re.compile(r"[-+]?\d|-?$|not a number$")
# A number that Markdown shows as it is, anywhere in a line.
PLAIN_NUMBER = re.compile(r"-?\d+(\.\d+)?(e[-+]\d+)?")
# Colours of verdicts on a terminal: green, red, yellow. The words are enough without colours.
COLOURS = {"agrees|as expected": "32", "DISAGREES|NOT": "1;31", "not tested|not given": "33"}
SAFE = frozenset(" ,.:;/()=-'?")
"""Characters, in addition to letters and digits, that start no markup inside a line of Markdown."""


@dataclass(frozen=True)
class Cell:
    """A cell of a table: a word or a number.

    Attributes:
        detail: small print below the text on the HTML page.
        verdict: the verdict that gives the cell its colour; the text states it too.
    """

    text: str
    detail: str = ""
    verdict: str = ""


@dataclass(frozen=True)
class Table:
    """Columns of words and numbers with a header; the first cell of a row is the name of the row.

    Attributes:
        indent: blanks before each line of plain text.
        caption: a line above the table; not in Markdown.
        folded: whether the HTML page shows the table only after a click.
        kept: number of first columns that are repeated in each band of a table that is too wide.
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
        """The rows, with every cell as a `Cell`."""
        return tuple(tuple(Cell(c) if isinstance(c, str) else c for c in row) for row in self.rows)

    @property
    def texts(self) -> tuple[tuple[str, ...], ...]:
        """The texts of the rows, without small print."""
        return tuple(tuple(cell.text for cell in row) for row in self.cells)

    def lines(self, room: int | None = None) -> list[str]:
        """The table as plain text; columns of words are aligned to the left, of numbers to the right.

        Columns that do not fit into `room` characters are split into bands, one below the other. Each band
        begins with the first columns.
        """
        columns, texts = [], self.texts
        for i, name in enumerate(self.head):
            cells = [row[i] for row in texts]
            width = max(map(len, (name, *cells)))
            words = not i or not all(map(NUMBER.match, cells))
            column = (name, "-" * width, *cells)
            columns.append([cell.ljust(width) if words else cell.rjust(width) for cell in column])
        first = columns[: self.kept]
        bands = [[*first]]
        for one in columns[self.kept :]:
            wide = self.indent + sum(len(other[0]) + 2 for other in (*bands[-1], one)) - 2
            if room is not None and wide > room and len(bands[-1]) > self.kept:
                bands.append([*first])
            bands[-1].append(one)
        found = [self.caption] if self.caption else []
        for band in bands:
            found += [""] * (band is not bands[0])
            found += [(" " * self.indent + "  ".join(row)).rstrip() for row in zip(*band, strict=True)]
        return found

    @property
    def markdown(self) -> str:
        """The table in Markdown, with cells escaped; cells that disagree or have moved are bold."""
        marked = (
            [(markdown(one.text), one.verdict in ("disagrees", "moved")) for one in row] for row in self.cells
        )
        rows = ([f"**{text}**" if bold else text for text, bold in row] for row in marked)
        lines = [[markdown(name) for name in self.head], ["---"] * len(self.head), *rows]
        return "\n".join(f"| {' | '.join(line)} |" for line in lines)


Part = str | Table
"""Lines of text, or a table."""


def text_of(parts: Iterable[Part], room: int | None = None) -> str:
    """Parts as plain text, one below the other, at most `room` characters wide."""
    return "\n".join(part if isinstance(part, str) else "\n".join(part.lines(room)) for part in parts)


def text_for(stream: TextIO | None, parts: Iterable[Part]) -> str:
    """Parts as text for a stream: on a terminal fitted to its width, with verdicts in colours."""
    if not is_terminal(stream):
        return text_of(parts)
    text = text_of(parts, max(shutil.get_terminal_size().columns, 20))
    if not os.environ.get("NO_COLOR"):
        for words, colour in COLOURS.items():
            text = re.sub(rf"\b({words})\b", f"\x1b[{colour}m\\1\x1b[0m", text)
    return text


def csv_of(head: Iterable[str], lines: Iterable[Iterable[object]]) -> str:
    """Lines as CSV; numbers read back have the same bits, NaN is an empty cell."""
    stream = io.StringIO()
    writer = csv.writer(stream)
    writer.writerow(head)
    writer.writerows(["" if value != value else value for value in line] for line in lines)
    return stream.getvalue()


def markdown(text: str) -> str:
    """Text on one line, escaped for Markdown: characters that could be markup become character references."""
    if PLAIN_NUMBER.fullmatch(text):
        return text
    plain = shown(text)

    def acts(place: int, one: str) -> bool:
        # A colon before a slash could make a link.
        return not one.isalnum() and (one not in SAFE or not place or plain[place : place + 2] == ":/")

    return "".join(f"&#{ord(one)};" if acts(place, one) else one for place, one in enumerate(plain))


def is_terminal(stream: TextIO | None) -> bool:
    """Whether a stream is a terminal that supports colours."""
    dumb = os.environ.get("TERM", "dumb") in ("", "dumb", "unknown")
    return stream is not None and stream.isatty() and not dumb
