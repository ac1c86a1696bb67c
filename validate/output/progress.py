"""How far a long run is: a line on a terminal that goes away again, plain lines in a pipe or a log."""

from __future__ import annotations

import shutil
import sys
import threading
import time
from collections.abc import Callable
from contextlib import suppress

from validate.plain_text import shown

# Seconds that a run is given before a terminal is told how far it is, and how often; the same of a pipe.
PATIENCE, OFTEN, PAUSE = 2.0, 0.5, 10.0
WIPE = "\r\x1b[2K"  # back to the beginning of a line of a terminal, and nothing on it
Told = Callable[..., None]
"""Takes what is done now, how much has been done, and of how much where that is another total than before."""


def rewrite(line: str) -> None:
    """Put a line of a terminal in the place of the one before; the terminal may be gone."""
    with suppress(OSError, ValueError):
        print(end=WIPE + shown(line)[: shutil.get_terminal_size().columns - 1], file=sys.stderr, flush=True)


class Progress:
    """Says now and then what a run is doing, from a thread of its own: also while it only waits.

    Args:
        say: takes a line. wipe: takes it away, where it is in the way of something else.
        message, total: what is done, and of how much, until something else is told.
        first, pause: seconds before the first line, and between two.
    """

    def __init__(
        self,
        say: Callable[[str], None],
        message: str,
        total: int | None = None,
        first: float = PAUSE,
        pause: float = PAUSE,
        wipe: Callable[[], None] | None = None,
    ) -> None:
        self._say, self._wipe, self._waits = say, wipe, (first, pause)
        self._message, self._done, self._total = message, 0, total
        self._began, self._over = time.monotonic(), threading.Event()
        # What was there when this run began took it no time.
        self._before, self._since = 0, self._began
        self._lock, self._seen = threading.RLock(), False
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def told(self, message: str, done: int, total: int | None = None) -> None:
        """What is done now, how much has been, and of how much where that is another total than before."""
        if not self._done or done < self._done:
            self._before, self._since = done, time.monotonic()
        self._message, self._done, self._total = message, done, total or self._total

    def stand_aside(self) -> None:
        """Take a line of a terminal away before something else is said; it comes back by itself."""
        with self._lock:
            if self._wipe is not None and self._seen:
                self._wipe()
                self._seen = False

    def end(self) -> None:
        """Say nothing more."""
        self._over.set()
        self._thread.join()
        self.stand_aside()

    def line(self) -> str:
        """What is said: also about how long the rest takes, at the pace since this run began."""
        now, share, rest = time.monotonic(), "", ""
        new, left = self._done - self._before, (self._total or 0) - self._done
        if self._total:
            share = f", {self._done:,} of {self._total:,} done"
            if new > 0 < left:
                rest = f", {(now - self._since) / new * left:,.0f} s left"
        return f"after {now - self._began:.0f} s: {self._message}{share}{rest}"

    def _run(self) -> None:
        wait, pause = self._waits
        while not self._over.wait(wait):
            # Not while something else is half written: a note to a pipe takes the same way.
            if self._wipe is None:
                self._say(self.line())
            else:
                with self._lock:
                    self._say(self.line())
                    self._seen = True
            wait = pause
