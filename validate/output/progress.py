"""How far a long run is: a line on a terminal that goes away again, plain lines in a pipe or a log."""

from __future__ import annotations

import shutil
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Protocol, TextIO

from validate.output.table import is_terminal
from validate.plain_text import shown

# Seconds that a run is given before a terminal is told how far it is; and between two lines in a pipe, and
# before the first one.
PATIENCE, PAUSE = 2.0, 10.0
Told = Callable[..., None]
"""Takes what is done now, how much has been done, and of how much where that is another total than before."""


class Says(Protocol):
    """What a run says on standard error: the console, or whoever stands in for it.

    Attributes:
        progress: what says how far the run is, while something does.
    """

    quiet: bool
    progress: Line | Lines | None

    def note(self, message: str) -> None:
        """One line."""
        ...


@contextmanager
def progress(
    console: Says, message: str, first: float = PAUSE, total: int | None = 0, lines: bool = True
) -> Iterator[Told]:
    """Says how far the block is, unless the run is quiet; inside of another such block, in its place.

    Args:
        message: what is done, until something else is told. first: seconds before the first line in a pipe.
        total: of how much, 0 until it is told; None of what cannot be counted.
        lines: whether a pipe has lines too.
    """
    if console.progress is not None:
        console.progress.told(message, 0, total)
        yield console.progress.told
        return
    told: Line | Lines | None = None
    if not console.quiet and sys.stderr is not None:
        if is_terminal(sys.stderr):
            told = Line(message, total, sys.stderr)
        elif lines:
            told = Lines(console.note, message, total, first)
    console.progress = told
    try:
        yield (lambda message, done, total=None: None) if told is None else told.told
    finally:
        console.progress = None
        if told is not None:
            told.end()


class Pace:
    """About how long the rest takes, at the pace since this run began: what was there before took no time."""

    def __init__(self) -> None:
        self._began, self._first = time.monotonic(), 0
        self._told = False

    def rest(self, done: int, of: int | None) -> str:
        """In words; empty where nothing is known of it."""
        now = time.monotonic()
        if not self._told or done < self._first or not done:
            self._told, self._began, self._first = True, now, done
        if not of or done <= self._first or of <= done:
            return ""
        seconds = (now - self._began) / (done - self._first) * (of - done)
        return f", {seconds / 60.0:.0f} min left" if seconds > 90.0 else f", {seconds:.0f} s left"


class Lines:
    """Says now and then what a run is doing, from a thread of its own: also while it only waits.

    Args:
        say: takes a line. message, total: what is done, and of how much, until something else is told.
        first, pause: seconds before the first line, and between two.
    """

    def __init__(
        self,
        say: Callable[[str], None],
        message: str,
        total: int | None = None,
        first: float = PAUSE,
        pause: float = PAUSE,
    ) -> None:
        self._say, self._pauses, self._pace = say, (first, pause), Pace()
        self._now = (message, 0, total)
        self._began, self._over = time.monotonic(), threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def told(self, message: str, done: int, total: int | None = None) -> None:
        """What is done now, how much has been, and of how much where that is another total than before."""
        total = self._now[2] if total is None else total
        self._pace.rest(done, total)
        self._now = (message, done, total)

    def pause(self) -> None:
        """Lines stand in nobody's way."""

    resume = pause

    def end(self) -> None:
        """Say nothing more."""
        self._over.set()
        self._thread.join()

    def _run(self) -> None:
        wait, pause = self._pauses
        while not self._over.wait(wait):
            message, done, total = self._now
            share = f", {done:,} of {total:,} done" if total else ""
            rest = self._pace.rest(done, total) if done else ""
            self._say(f"after {time.monotonic() - self._began:.0f} s: {message}{share}{rest}")
            wait = pause


class Line:
    """A line on a terminal that says how far a run is, once it takes over two seconds, and goes away."""

    def __init__(self, message: str, total: int | None, stream: TextIO) -> None:
        from rich.console import Console as Screen
        from rich.progress import (
            BarColumn,
            MofNCompleteColumn,
            Progress,
            SpinnerColumn,
            TextColumn,
            TimeElapsedColumn,
        )

        bar = [] if total is None else [BarColumn(bar_width=20), MofNCompleteColumn()]
        self._progress = Progress(
            SpinnerColumn("line"),
            TextColumn("{task.description}", markup=False),
            *bar,
            TimeElapsedColumn(),
            console=Screen(file=stream, width=shutil.get_terminal_size().columns),
            transient=True,
            redirect_stdout=False,
            redirect_stderr=False,
            refresh_per_second=4,
        )
        self._task = self._progress.add_task(shown(message), total=total)
        self._lock, self._pace = threading.RLock(), Pace()
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
            of = self._progress.tasks[0].total if total is None else total
            words = shown(f"{message}{self._pace.rest(done, None if of is None else int(of))}")
            self._progress.update(self._task, description=words, completed=done, total=total)

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
