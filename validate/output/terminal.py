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
    """A table, or a list of its cells for each row where it is wider than the terminal."""
    wide = max(len(line) for line in table.text.splitlines()) + len(table.head)
    if wide > console.width:
        indent = " " * table.indent
        for row in table.rows:
            for i, (name, cell) in enumerate(zip(table.head, row, strict=True)):
                if cell:
                    words = rich.text.Text(f"{indent}{'' if i == 0 else f'  {name}: '}")
                    console.print(words.append(cell, style=_style(table.head[i], cell, i)), soft_wrap=True)
        return
    grid = rich.table.Table(box=rich.box.SIMPLE_HEAD, pad_edge=False, show_edge=False)
    for i, name in enumerate(table.head):
        grid.add_column(rich.text.Text(name), justify="left" if table.to_left(i) else "right", no_wrap=True)
    for row in table.rows:
        cells = zip(table.head, row, strict=True)
        grid.add_row(*(rich.text.Text(c, style=_style(n, c, 1)) for n, c in cells))
    console.print(rich.padding.Padding(grid, (0, 0, 0, table.indent)) if table.indent else grid)


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
