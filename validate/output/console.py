"""What a run says: results on standard output, everything else in single lines on standard error."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress

from validate.errors import NotFinished
from validate.output.files import unwritable, write_content
from validate.output.progress import PATIENCE, PAUSE, Progress, Told
from validate.output.table import Part, is_terminal, text_for
from validate.plain_text import one_line

STANDARD_OUTPUT = "standard output"


class Console:
    """Standard output and standard error of one run.

    Whatever writes on standard output raises NotFinished where that does not take it.

    Attributes:
        quiet: whether only results that were asked for and errors are said.
        mute: whether standard output belongs to a result, so that nothing else is said there.
        written: the files that the run has written, and what they hold, for the one who interrupts it.
    """

    def __init__(self) -> None:
        self.quiet = False
        self.mute = False
        self.written: dict[str, str] = {}
        self._progress: Progress | None = None
        self._reader_gone = False

    @property
    def left(self) -> str:
        """The files that the run has written, in words."""
        return "; ".join(f"{target} holds {what}" for target, what in self.written.items())

    def say(self, text: str) -> None:
        """Lines for people; nothing if the run is quiet or mute."""
        if not self.quiet and not self.mute:
            self.write(text + "\n")
            self.flush()

    def show(self, parts: Sequence[Part]) -> None:
        """Lines and tables for people, laid out for a terminal that is one; nothing if quiet or mute."""
        self.say(text_for(sys.stdout, parts))

    def put(self, target: str | None, content: str | bytes, what: str) -> None:
        """Write a result whole to its file, or to standard output for `-` or None.

        Args:
            what: it is, in words.
        """
        if target is None or target == "-":
            target = STANDARD_OUTPUT
            self.write(content if isinstance(content, str) else content.decode())
            self.flush()
        else:
            write_content(target, content)
        self.written[target] = what

    def write(self, text: str) -> None:
        """Text on standard output, as it is; characters that it has no code for are shown as escapes.

        Once the reader of a pipe has gone, such as `head`, the text is dropped: the work and its verdict
        are wanted all the same.
        """
        if not self._reader_gone:
            try:
                code = getattr(sys.stdout, "encoding", None) or "utf-8"
                sys.stdout.write(text.encode(code, "backslashreplace").decode(code))
            except (OSError, ValueError, AttributeError) as error:
                self._lose(error)

    def write_lines(self, texts: Iterable[str]) -> None:
        """Many texts, as they come."""
        for text in texts:
            self.write(text)
        self.flush()

    def flush(self) -> None:
        """Bring what was written to its reader."""
        if self._reader_gone or sys.stdout is None:
            return
        try:
            sys.stdout.flush()
        except (OSError, ValueError) as error:
            self._lose(error)

    def _lose(self, error: Exception) -> None:
        """Point standard output to nowhere, so that what is left in its buffer cannot fail again at the end.

        Raises:
            NotFinished: it is not only that its reader has gone.
        """
        self._reader_gone = True
        with suppress(OSError, ValueError, AttributeError):
            nowhere = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, sys.stdout.fileno())
            os.close(nowhere)
        if isinstance(error, BrokenPipeError):
            return
        if isinstance(error, OSError):
            raise unwritable(STANDARD_OUTPUT, error) from None
        raise NotFinished(STANDARD_OUTPUT, "is closed") from None

    def complain(self, message: str) -> None:
        """One line on standard error."""
        # Without a standard error `print` would take standard output.
        if sys.stderr is not None:
            with suppress(OSError, ValueError):
                print(f"pointcoord: {one_line(message)}", file=sys.stderr, flush=True)

    def note(self, message: str) -> None:
        """One line on standard error of what was taken for granted; nothing if the run is quiet."""
        if not self.quiet:
            self.complain(f"note: {message}")

    def warn(self, message: str) -> None:
        """One line on standard error that does not change the status; nothing if the run is quiet."""
        if not self.quiet:
            self.complain(f"warning: {message}")

    @contextmanager
    def progress(
        self, message: str, first: float = PAUSE, total: int | None = None, lines: bool = True
    ) -> Iterator[Told]:
        """Says how far the block is, unless the run is quiet; inside of another such block, in its place.

        Args:
            message: what is done, until something else is told. first: seconds before the first line in a
                pipe. total: of how much, if it is known. lines: whether a pipe has lines too.
        """
        outer, terminal = self._progress, is_terminal(sys.stderr)
        if outer is not None:
            outer.told(message, 0, total)
            yield outer.told
        elif self.quiet or sys.stderr is None or not (terminal or lines):
            yield lambda message, done, total=None: None
        else:
            self._progress = said = Progress(self.note, message, total, PATIENCE if terminal else first)
            try:
                yield said.told
            finally:
                self._progress = None
                said.end()
