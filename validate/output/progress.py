"""How far a long run is, and about how long the rest takes."""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from validate.output.console import Console
from validate.output.lines import PAUSE as LINES
from validate.output.terminal import rich_for

PAUSE = 0.2  # seconds between two words on a terminal
Told = Callable[[str, int, int], None]
"""Takes what is done now, how much has been done, and of how much."""


@contextmanager
def progress(console: Console, message: str, first: float = LINES) -> Iterator[Told]:
    """Says on standard error how far the block is, unless the run is quiet.

    On a terminal as everything else does where `rich` is installed, and else in a line that is written again;
    in a pipe in a plain line now and then.

    Args:
        message: what is done, until something else is told. first: seconds before the first line in a pipe.
    """
    terminal = sys.stderr is not None and sys.stderr.isatty()
    with console.working(message, 0, lines=True, first=first) as told:
        try:
            if terminal and rich_for(sys.stderr) is None:
                console.progress(message)
                yield Progress(lambda what, done, of: console.progress(what), PAUSE)
            else:
                yield Progress(lambda what, done, of: told(what, done, of), PAUSE, counted=False)
        finally:
            console.end_progress()


class Progress:
    """Tells what is done now, how much is done, and about how long the rest takes.

    Args:
        say: takes it in words, with how much is done and of how much.
        pause: seconds between two of them.
        counted: whether the words hold how much is done.
    """

    def __init__(self, say: Callable[[str, int, int], None], pause: float, counted: bool = True) -> None:
        self._say = say
        self._pause = pause
        self._counted = counted
        self._began = time.monotonic()
        self._told = -math.inf
        self._first: int | None = None  # how much was done when it was told first

    def __call__(self, what: str, done: int, of: int) -> None:
        """What is done now, as often as it likes."""
        now = time.monotonic()
        begins = self._first is None or done < self._first or not done
        if begins:
            self._began, self._first = now, done
        if now - self._told < self._pause and not begins:
            return
        self._told = now
        rest = self._rest(now, done, of)
        share = f"{done:,} of {of:,}" if of else f"{done:,}"
        self._say(f"{share}{rest}: {what}" if self._counted else f"{what}{rest}", done, of)

    def _rest(self, now: float, done: int, of: int) -> str:
        """About how long the rest takes, at the pace so far."""
        if self._first is None or done <= self._first or of <= done:
            return ""
        seconds = (now - self._began) / (done - self._first) * (of - done)
        return f", {seconds / 60.0:.0f} min left" if seconds > 90.0 else f", {seconds:.0f} s left"
