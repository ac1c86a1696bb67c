"""How far a long run is, in plain lines: for a pipe or a log, where nothing can be written again."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

PAUSE = 10.0  # seconds between two lines, and before the first one


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
        self._say = say
        self._now = (message, 0, total)
        self._began = time.monotonic()
        self._pauses = (first, pause)
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def told(self, message: str, done: int, total: int | None = None) -> None:
        """What is done now, how much has been, and of how much where that is another total than before."""
        self._now = (message, done, self._now[2] if total is None else total)

    def end(self) -> None:
        """Say nothing more."""
        self._over.set()
        self._thread.join()

    def _run(self) -> None:
        wait, pause = self._pauses
        while not self._over.wait(wait):
            message, done, total = self._now
            share = f", {done:,} of {total:,} done" if total else ""
            self._say(f"after {time.monotonic() - self._began:.0f} s: {message}{share}")
            wait = pause
