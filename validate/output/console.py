"""Prints results on standard output, and messages and progress as single lines on standard error."""

from __future__ import annotations

import os
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress

from validate.errors import NotFinished
from validate.output.files import unwritable, write_content
from validate.output.table import Part, is_terminal, text_for
from validate.plain_text import one_line

STANDARD_OUTPUT = "standard output"
PATIENCE, PAUSE = 2.0, 10.0  # seconds until the first line of progress, and from line to line
Told = Callable[..., None]
"""Called with what is being done, the amount done, and the total amount if it has changed."""


class Console:
    """Standard output and standard error of one run.

    Every method that writes on standard output raises NotFinished if the text cannot be written.

    Attributes:
        quiet: whether only requested results and errors are printed.
        mute: whether standard output is used for a result, so that nothing else is printed there.
        written: the files written so far and what they contain, for the message after an interruption.
    """

    def __init__(self) -> None:
        self.quiet = False
        self.mute = False
        self.written: dict[str, str] = {}
        self._progress: Progress | None = None
        self._reader_gone = False

    @property
    def left(self) -> str:
        """The files written so far and what they contain, in words."""
        return "; ".join(f"{target} holds {what}" for target, what in self.written.items())

    def say(self, text: str) -> None:
        """Print lines; nothing if the run is quiet or mute."""
        if not self.quiet and not self.mute:
            self.write(text + "\n")

    def show(self, parts: Iterable[Part]) -> None:
        """Print lines and tables, fitted to a terminal; nothing if the run is quiet or mute."""
        if found := [*parts]:
            self.say(text_for(sys.stdout, found))

    def put(self, target: str | None, content: str | bytes, what: str) -> None:
        """Write a whole result to its file, or to standard output for `-` or None.

        Args:
            what: the result in words, such as `the picture`.
        """
        if target is None or target == "-":
            target = STANDARD_OUTPUT
            self.write(content if isinstance(content, str) else content.decode())
        else:
            write_content(target, content)
        self.written[target] = what

    def write(self, text: str) -> None:
        """Write text on standard output; characters that its encoding lacks become escapes.

        After the reader of a pipe has closed it, as `head` does, the text is dropped, but the run continues:
        its verdict and its files are still wanted.
        """
        if self._reader_gone:
            return
        try:
            code = getattr(sys.stdout, "encoding", None) or "utf-8"
            sys.stdout.write(text.encode(code, "backslashreplace").decode(code))
            sys.stdout.flush()
        except (OSError, ValueError, AttributeError) as error:
            self._reader_gone = True
            # To the null device, so that flushing the buffer at exit cannot fail again.
            with suppress(OSError, ValueError, AttributeError):
                os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            if isinstance(error, OSError) and not isinstance(error, BrokenPipeError):
                raise unwritable(STANDARD_OUTPUT, error) from None
            if not isinstance(error, OSError):
                problem = "is closed; use --quiet, and name files for results"
                raise NotFinished(STANDARD_OUTPUT, problem) from None

    def complain(self, message: str) -> None:
        """One line on standard error."""
        # If standard error is None, `print` would write on standard output.
        if sys.stderr is not None:
            with suppress(OSError, ValueError):
                print(f"pointcoord: {one_line(message)}", file=sys.stderr, flush=True)

    def note(self, *messages: str, of: str = "", kind: str = "note") -> None:
        """Lines of information on standard error; nothing if the run is quiet.

        Args:
            of: the scene or file that the messages are about, if they do not name it.
        """
        for message in () if self.quiet else messages:
            self.complain(f"{kind}: {of}{': ' if of else ''}{message}")

    def warn(self, *messages: str, of: str = "") -> None:
        """Lines of warning, see `note`; they do not change the exit status."""
        self.note(*messages, of=of, kind="warning")

    @contextmanager
    def progress(self, message: str, total: int | None = None, everywhere: bool = False) -> Iterator[Told]:
        """Print the progress of the block. A nested block uses the progress of the outer one.

        A thread prints, so that lines also come while the run waits.

        Args:
            message, total: what is being done, and the total amount, until the next call of the yielded
                function.
            everywhere: whether lines are printed if standard error is no terminal.
        """
        if self._progress is not None:
            self._progress.told(message, 0, total)
            yield self._progress.told
            return
        self._progress, over = Progress(message, total), threading.Event()
        shown = self._progress

        def run() -> None:
            wait = PATIENCE
            while not over.wait(wait):
                self.note(shown.line())
                wait = PAUSE

        printer = threading.Thread(target=run, daemon=True)
        if everywhere or is_terminal(sys.stderr):
            printer.start()
        try:
            yield shown.told
        finally:
            self._progress = None
            over.set()
            if printer.is_alive():
                printer.join()


class Progress:
    """How far a run is, and how long the rest takes at its pace.

    Args:
        message, total: what is being done, and the total amount, until `told` is called.
    """

    def __init__(self, message: str, total: int | None = None) -> None:
        self._message, self._done, self._total = message, 0, total
        self._began = time.monotonic()
        # The amount done before this run and the start time, so that the pace counts this run's work only.
        self._before, self._since = 0, self._began

    def told(self, message: str, done: int, total: int | None = None) -> None:
        """Set what is being done, the amount done, and the total amount if it has changed."""
        if not self._done or done < self._done:
            self._before, self._since = done, time.monotonic()
        self._message, self._done, self._total = message, done, total or self._total

    def line(self) -> str:
        """The line to print, with the estimated time left at the pace of this run."""
        now, share = time.monotonic(), ""
        if self._total:
            new, left = self._done - self._before, self._total - self._done
            rest = f", {(now - self._since) / new * left:,.0f} s left" if new > 0 < left else ""
            share = f", {self._done:,} of {self._total:,} done{rest}"
        return f"after {now - self._began:.0f} s: {self._message}{share}"
