"""What a terminal is shown: tables that fit its width, and how far a long run is, where `rich` is installed.

In a pipe, in a file, on a dumb terminal and without rich there is plain text only, always the same.
"""

from __future__ import annotations

import io
import os
import shutil
import threading
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import Any, TextIO

from validate.plain_text import shown

# Seconds that a run is given before it is told how far it is.
PATIENCE = 2.0
# Columns of words, which read better from the left.
LEFT = (
    "formulation",
    "outcome",
    "worst at",
    "where",
    "wrong quantity",
    "erratum",
    "slip of print",
    "verdict",
    "resting on",
)
# The colour of a verdict by the word that it begins with; the word says it too.
COLOURS = {"agrees": "green", "as": "green", "DISAGREES,": "bold red", "NOT": "bold red", "not": "yellow"}


@dataclass(frozen=True)
class Table:
    """Columns of words and numbers, under their names."""

    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    indent: int = 0

    @property
    def text(self) -> str:
        """Columns of text: words to the left, numbers to the right."""
        lines = [self.head, *self.rows]
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

    def to_left(self, column: int) -> bool:
        """Whether a column is of words."""
        return column == 0 or self.head[column] in LEFT


Part = str | Table
"""Lines of text, or a table."""


def text_of(parts: Sequence[Part]) -> str:
    """Parts as plain text, one below the other."""
    return "\n".join(part if isinstance(part, str) else part.text for part in parts)


def rich_for(stream: TextIO | None) -> Any:
    """The package `rich` for a terminal that takes it; None elsewhere."""
    if stream is None or not stream.isatty() or os.environ.get("TERM", "dumb") in ("", "dumb", "unknown"):
        return None
    try:
        for name in ("console", "table", "text", "box", "padding", "progress"):
            import_module(f"rich.{name}")
        return import_module("rich")
    except ImportError:
        return None


def laid_out(parts: Sequence[Part], stream: TextIO | None) -> str | None:
    """Parts as a terminal shows them, as wide as it is; None where plain text is to be shown."""
    rich = rich_for(stream)
    if rich is None or stream is None:
        return None
    code = stream.encoding or "utf-8"
    page = io.TextIOWrapper(io.BytesIO(), encoding=code, errors="backslashreplace", newline="")
    width = max(shutil.get_terminal_size().columns, 20)
    console = rich.console.Console(
        file=page, force_terminal=True, width=width, highlight=False, markup=False, emoji=False
    )
    for part in parts:
        if isinstance(part, str):
            console.print(rich.text.Text(part), soft_wrap=True)
        else:
            _show(part, console, rich)
    page.flush()
    buffer = page.buffer
    buffer.seek(0)
    return buffer.read().decode(code)


def _show(table: Table, console: Any, rich: Any) -> None:
    """A table; one that is wider than the terminal with its cells folded, or as a list for each row."""
    wide = max(len(line) for line in table.text.splitlines()) + len(table.head)
    widths = None if wide <= console.width else _folded(table, console.width)
    if wide > console.width and widths is None:
        for row in table.rows:
            _list(table, row, console, rich)
        return
    padding = (0, 1) if widths is None else (0, 0)
    grid = rich.table.Table(box=rich.box.SIMPLE_HEAD, pad_edge=False, show_edge=False, padding=padding)
    for i, name in enumerate(table.head):
        justify = "left" if table.to_left(i) else "right"
        width = None if widths is None else widths[i]
        grid.add_column(rich.text.Text(name), justify=justify, no_wrap=widths is None, width=width)
    for row in table.rows:
        cells = zip(table.head, row, strict=True)
        grid.add_row(*(rich.text.Text(c, style=_style(n, c, 1)) for n, c in cells))
    console.print(rich.padding.Padding(grid, (0, 0, 0, table.indent)) if table.indent else grid)


def _folded(table: Table, room: int) -> list[int] | None:
    """Widths of columns whose cells are folded between words; None where no word may be cut for it."""
    columns = [[name, *(row[i] for row in table.rows)] for i, name in enumerate(table.head)]
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


def _list(table: Table, row: Sequence[str], console: Any, rich: Any) -> None:
    """A row as its first cell, and below it the others by name, as many in a line as there is room for."""
    indent = " " * table.indent
    console.print(rich.text.Text(indent + row[0], style=_style(table.head[0], row[0], 0)), soft_wrap=True)
    line = rich.text.Text()
    for i, (name, cell) in enumerate(zip(table.head, row, strict=True)):
        if not i or not cell:
            continue
        if len(line) and len(line) + 2 + len(name) + 2 + len(cell) > console.width:
            console.print(line, soft_wrap=True)
            line = rich.text.Text()
        line.append(f"  {name}: " if len(line) else f"{indent}  {name}: ")
        line.append(cell, style=_style(name, cell, i))
    if len(line):
        console.print(line, soft_wrap=True)


def _style(name: str, cell: str, column: int) -> str:
    if name == "verdict":
        return COLOURS.get(cell.partition(" ")[0].rstrip(";"), "")
    return "" if column else "bold"


class Working:
    """A line on a terminal's standard error that says how far a run is, once it takes over two seconds."""

    def __init__(self, message: str, total: int | None, stream: TextIO, rich: Any) -> None:
        console = rich.console.Console(file=stream, width=shutil.get_terminal_size().columns)
        parts = rich.progress
        columns = [parts.SpinnerColumn("line"), parts.TextColumn("{task.description}", markup=False)]
        if total is not None:
            columns += [parts.BarColumn(bar_width=20), parts.MofNCompleteColumn()]
        columns.append(parts.TimeElapsedColumn())
        self._progress = parts.Progress(
            *columns,
            console=console,
            transient=True,
            redirect_stdout=False,
            redirect_stderr=False,
            refresh_per_second=4,
        )
        self._task = self._progress.add_task(shown(message), total=total)
        self._lock = threading.RLock()
        self._ready = self._over = False
        self._timer = threading.Timer(PATIENCE, self._begin)
        self._timer.daemon = True
        self._timer.start()

    def _begin(self) -> None:
        with self._lock:
            self._ready = True
            self.resume()

    def told(self, message: str, done: int, total: int | None = None) -> None:
        """What is done now, how much has been, and of how much where that is another total than before."""
        with self._lock:
            self._progress.update(self._task, description=shown(message), completed=done, total=total)

    def pause(self) -> None:
        """Take the line away, so that something else can be said."""
        with self._lock:
            self._progress.stop()

    def resume(self) -> None:
        """Bring it back."""
        with self._lock:
            if self._ready and not self._over:
                self._progress.start()

    def end(self) -> None:
        """Take the line away for good."""
        with self._lock:
            self._over = True
            self._timer.cancel()
            self._progress.stop()
