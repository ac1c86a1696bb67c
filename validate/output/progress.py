"""Progress of a long run: a line on standard error from time to time."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

# Seconds until the first line on a terminal, and from line to line.
PATIENCE, PAUSE = 2.0, 10.0
Told = Callable[..., None]
"""Called with what is being done, the amount done, and the total amount if it has changed."""


class Progress:
    """Prints progress lines from a separate thread, so that they also come while the run waits.

    Args:
        say: prints a line.
        message, total: what is being done, and the total amount, until `told` is called.
        first: seconds before the first line.
    """

    def __init__(
        self, say: Callable[[str], None], message: str, total: int | None = None, first: float = PAUSE
    ) -> None:
        self._say, self._first = say, first
        self._message, self._done, self._total = message, 0, total
        self._began, self._over = time.monotonic(), threading.Event()
        # The amount done before this run and the start time, so that the pace counts this run's work only.
        self._before, self._since = 0, self._began
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def told(self, message: str, done: int, total: int | None = None) -> None:
        """Set what is being done, the amount done, and the total amount if it has changed."""
        if not self._done or done < self._done:
            self._before, self._since = done, time.monotonic()
        self._message, self._done, self._total = message, done, total or self._total

    def end(self) -> None:
        """Stop printing."""
        self._over.set()
        self._thread.join()

    def line(self) -> str:
        """The line to print, with the estimated time left at the pace of this run."""
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
