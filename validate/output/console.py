"""What a run says: results on standard output, everything else in single lines on standard error."""

from __future__ import annotations

import os
import shutil
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress

from validate.output.files import OutputError, unwritable
from validate.output.lines import PAUSE, Lines
from validate.output.terminal import Part, Working, laid_out, rich_for, text_of
from validate.plain_text import one_line

STANDARD_OUTPUT = "standard output"


class Console:
    """Standard output and standard error of one run.

    Attributes:
        quiet: whether only results that were asked for and errors are said.
        mute: whether standard output belongs to a result, so that nothing else is said there.
        written: the files that the run has written, in words, for the one who interrupts it.
    """

    def __init__(self, program: str = "pointcoord") -> None:
        self.program = program
        self.quiet = False
        self.mute = False
        self.written: list[str] = []
        self._reader_gone = False
        self._in_progress = False
        self._working: Working | None = None
        self._lines: Lines | None = None

    def require(self, what_else: str) -> None:
        """Refuse a closed standard output, before anything is solved.

        Raises:
            OutputError: it is closed; the message says what else can be done.
        """
        if sys.stdout is None:
            raise OutputError(STANDARD_OUTPUT, f"is closed; {what_else}")

    def say(self, text: str) -> None:
        """Lines for people; nothing if the run is quiet or mute.

        Raises:
            OutputError: standard output does not take them.
        """
        if not self.quiet and not self.mute:
            self.write(text + "\n")
            self.flush()

    def show(self, parts: Sequence[Part]) -> None:
        """Lines and tables for people, laid out for a terminal that is one; nothing if quiet or mute.

        Raises:
            OutputError: standard output does not take them.
        """
        laid = None if self.quiet or self.mute else laid_out(parts, sys.stdout)
        if laid is None:
            self.say(text_of(parts))
        else:
            self.write(laid)
            self.flush()

    def write(self, text: str) -> int:
        """Text on standard output, as it is; characters that it has no code for are shown as escapes.

        Once the reader of a pipe has gone, such as `head`, the text is dropped: the work and its verdict
        are wanted all the same.

        Raises:
            OutputError: standard output does not take it.
        """
        if self._working is not None:
            self._working.pause()
        if not self._reader_gone:
            try:
                code = getattr(sys.stdout, "encoding", None) or "utf-8"
                sys.stdout.write(text.encode(code, "backslashreplace").decode(code))
            except BrokenPipeError:
                self._leave_standard_output()
            except (OSError, ValueError, AttributeError) as error:
                raise self._lost(error) from None
        return len(text)

    def flush(self) -> None:
        """Bring what was written to its reader.

        Raises:
            OutputError: standard output does not take it.
        """
        if self._reader_gone or sys.stdout is None:
            return
        try:
            sys.stdout.flush()
            if self._working is not None:
                self._working.resume()
        except BrokenPipeError:
            self._leave_standard_output()
        except (OSError, ValueError) as error:
            raise self._lost(error) from None

    def _lost(self, error: Exception) -> OutputError:
        self._leave_standard_output()
        if isinstance(error, OSError):
            return unwritable(STANDARD_OUTPUT, error)
        return OutputError(STANDARD_OUTPUT, "is closed")

    def _leave_standard_output(self) -> None:
        """Point it to nowhere, so that what is left in its buffer cannot fail again at the end."""
        self._reader_gone = True
        with suppress(OSError, ValueError, AttributeError):
            nowhere = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, sys.stdout.fileno())
            os.close(nowhere)

    def complain(self, message: str) -> None:
        """One line on standard error."""
        self.end_progress()
        if self._working is not None:
            self._working.pause()
        # Without a standard error `print` would take standard output.
        if sys.stderr is not None:
            with suppress(OSError, ValueError):
                print(f"{self.program}: {one_line(message)}", file=sys.stderr, flush=True)
        if self._working is not None:
            self._working.resume()

    @contextmanager
    def working(
        self, message: str, total: int | None = None, lines: bool = False, first: float = PAUSE
    ) -> Iterator[Callable[..., None]]:
        """A terminal's standard error says how far the block is, once it takes over two seconds.

        It does so where `rich` is installed; a quiet run says nothing anywhere.

        Args:
            lines: whether a plain line says it now and then where standard error is no terminal, the first
                one after so many seconds.
        Yields:
            What tells it what is being done and how much of the total is; and of another total, if it is one.
        """
        told: Working | Lines | None = None
        if self._lines is not None:
            # Who says already what is being done says this as well.
            self._lines.told(message, 0, total or 0)
            yield self._lines.told
            return
        if not self.quiet and sys.stderr is not None:
            if (rich := rich_for(sys.stderr)) is not None:
                told = self._working = Working(message, total, sys.stderr, rich)
            elif lines and not sys.stderr.isatty():
                told = self._lines = Lines(self.note, message, total, first)
        try:
            yield (lambda message, done, total=None: None) if told is None else told.told
        finally:
            self._working = self._lines = None
            if told is not None:
                told.end()

    def progress(self, message: str) -> None:
        """A line on a terminal's standard error, in the place of the one before; nothing elsewhere."""
        if not self.quiet and sys.stderr is not None and sys.stderr.isatty():
            width = max(shutil.get_terminal_size().columns - 1, 20)
            with suppress(OSError, ValueError):
                print(f"\r{one_line(message)[:width].ljust(width)}", end="", file=sys.stderr, flush=True)
                self._in_progress = True

    def end_progress(self) -> None:
        """Take the line of progress away."""
        if self._in_progress:
            self._in_progress = False
            width = max(shutil.get_terminal_size().columns - 1, 20)
            with suppress(OSError, ValueError):
                print("\r" + " " * width, end="\r", file=sys.stderr, flush=True)

    def note(self, message: str) -> None:
        """One line on standard error of what was taken for granted; nothing if the run is quiet."""
        if not self.quiet:
            self.complain(f"note: {message}")

    def warn(self, message: str) -> None:
        """One line on standard error that does not change the status; nothing if the run is quiet."""
        if not self.quiet:
            self.complain(f"warning: {message}")
