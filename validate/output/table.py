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
from typing import TYPE_CHECKING, ClassVar, TextIO

from validate.plain_text import shown

if TYPE_CHECKING:
    from rich.console import Console as Screen

# What a column of numbers may hold: its cells are read from the right.
NUMBER = re.compile(r"[-+]?\d|-?$|not a number$")
# The colour of a verdict by the word that it begins with; the word says it too.
COLOURS = {"agrees": "green", "as": "green", "DISAGREES": "bold red", "NOT": "bold red", "not": "yellow"}
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
        lines = [self.head, *self.texts]
        widths = [max(len(line[i]) for line in lines) for i in range(len(self.head))]
        lines.insert(1, tuple("-" * width for width in widths))
        return "\n".join(
            " " * self.indent
            + "  ".join(
                cell.ljust(width) if self.to_left(i) else cell.rjust(width)
                for i, (cell, width) in enumerate(zip(line, widths, strict=True))
            ).rstrip()
            for line in lines
        )

    @property
    def markdown(self) -> str:
        """The table in Markdown, in which no cell acts; what disagrees is bold."""
        bold = {cell: f"**{markdown(cell.text)}**" for row in self.cells for cell in row if _is_bad(cell)}
        rows = ([bold.get(cell) or markdown(cell.text) for cell in row] for row in self.cells)
        lines = [[markdown(name) for name in self.head], ["---"] * len(self.head), *rows]
        return "\n".join(f"| {' | '.join(line)} |" for line in lines)

    def to_left(self, column: int) -> bool:
        """Whether a column is of words."""
        return column == 0 or not all(NUMBER.match(row[column]) for row in self.texts)


Part = str | Table
"""Lines of text, or a table."""


def _is_bad(cell: Cell) -> bool:
    return cell.verdict in ("disagrees", "moved")


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


def laid_out(parts: Sequence[Part], stream: TextIO) -> str:
    """Parts as a terminal shows them, as wide as it is."""
    # Imported where there is a terminal: it takes as long as to solve a scene.
    from rich.console import Console as Screen
    from rich.text import Text

    code = stream.encoding or "utf-8"
    page = io.TextIOWrapper(io.BytesIO(), encoding=code, errors="backslashreplace", newline="")
    width = max(shutil.get_terminal_size().columns, 20)
    screen = Screen(file=page, force_terminal=True, width=width, highlight=False, markup=False, emoji=False)
    for part in parts:
        if isinstance(part, Table):
            _show(part, screen)
        else:
            text = Text(part)
            text.highlight_regex(r"\bagrees  ", COLOURS["agrees"])
            text.highlight_regex(r"\bDISAGREES  ", COLOURS["DISAGREES"])
            screen.print(text, soft_wrap=True)
    page.flush()
    page.buffer.seek(0)
    return page.buffer.read().decode(code)


def _show(table: Table, screen: Screen) -> None:
    """A table; one that is wider than the terminal with its cells folded, or as a list for each row."""
    from rich.box import SIMPLE_HEAD
    from rich.padding import Padding
    from rich.table import Table as Grid
    from rich.text import Text

    wide = max(map(len, table.text.splitlines())) + len(table.head)
    widths = None if wide <= screen.width else _folded(table, screen.width)
    if wide > screen.width and widths is None:
        for row in table.texts:
            for i, (name, cell) in enumerate(zip(table.head, row, strict=True)):
                style = _style(name, cell, i)
                text = Text.assemble(f"    {name}: " if i else "  ", (cell, style))
                screen.print(text, soft_wrap=True)
        return
    grid = Grid(box=SIMPLE_HEAD, pad_edge=False, show_edge=False, padding=(0, 0 if widths else 1))
    for i, name in enumerate(table.head):
        grid.add_column(
            Text(name),
            justify="left" if table.to_left(i) else "right",
            no_wrap=widths is None,
            width=None if widths is None else widths[i],
        )
    for row in table.texts:
        cells = zip(table.head, row, strict=True)
        grid.add_row(*(Text(cell, _style(name, cell, i)) for i, (name, cell) in enumerate(cells)))
    screen.print(Padding(grid, (0, 0, 0, table.indent)))


def _folded(table: Table, room: int) -> list[int] | None:
    """Widths of columns whose cells are folded between words; None where no word may be cut for it."""
    columns = [[name, *(row[i] for row in table.texts)] for i, name in enumerate(table.head)]
    widths = [max(len(word) for cell in column for word in cell.split() or [""]) for column in columns]
    rest = room - table.indent - sum(widths) - (len(widths) - 1)
    if rest < 0:
        return None
    # Whole cells in as many columns as there is room for, and what is left over to the next one.
    lacking = [max(map(len, column)) - width for column, width in zip(columns, widths, strict=True)]
    for i in sorted(range(len(widths)), key=lambda i: lacking[i]):
        more = min(lacking[i], rest)
        widths[i] += more
        rest -= more
    return widths


def _style(name: str, cell: str, column: int) -> str:
    if name == "verdict":
        return COLOURS.get(cell.partition(" ")[0].rstrip(",;"), "")
    return "" if column else "bold"
