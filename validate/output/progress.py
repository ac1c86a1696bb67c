"""How far a long run is: a line on standard error now and then."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

# Seconds until the first line on a terminal, and from line to line.
PATIENCE, PAUSE = 2.0, 10.0
Told = Callable[..., None]
"""Takes what is done now, how much has been done, and of how much where that is another total than before."""


class Progress:
    """Says now and then what a run is doing, from a thread of its own: also while it only waits.

    Args:
        say: takes a line.
        message, total: what is done, and of how much, until something else is told.
        first: seconds before the first line.
    """

    def __init__(
        self, say: Callable[[str], None], message: str, total: int | None = None, first: float = PAUSE
    ) -> None:
        self._say, self._first = say, first
        self._message, self._done, self._total = message, 0, total
        self._began, self._over = time.monotonic(), threading.Event()
        # What was there when this run began took it no time.
        self._before, self._since = 0, self._began
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def told(self, message: str, done: int, total: int | None = None) -> None:
        """What is done now, how much has been, and of how much where that is another total than before."""
        if not self._done or done < self._done:
            self._before, self._since = done, time.monotonic()
        self._message, self._done, self._total = message, done, total or self._total

    def end(self) -> None:
        """Say nothing more."""
        self._over.set()
        self._thread.join()

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
        wait = self._first
        while not self._over.wait(wait):
            self._say(self.line())
            wait = PAUSE
