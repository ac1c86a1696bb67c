"""Prints results on standard output, and messages as single lines on standard error."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress

from validate.errors import NotFinished
from validate.output.files import unwritable, write_content
from validate.output.progress import PATIENCE, PAUSE, Progress, Told
from validate.output.table import Part, is_terminal, text_for
from validate.plain_text import one_line

STANDARD_OUTPUT = "standard output"


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
            self.flush()

    def show(self, parts: Sequence[Part]) -> None:
        """Print lines and tables, fitted to a terminal; nothing if the run is quiet or mute."""
        self.say(text_for(sys.stdout, parts))

    def put(self, target: str | None, content: str | bytes, what: str) -> None:
        """Write a whole result to its file, or to standard output for `-` or None.

        Args:
            what: the result in words, such as `the picture`.
        """
        if target is None or target == "-":
            target = STANDARD_OUTPUT
            self.write(content if isinstance(content, str) else content.decode())
            self.flush()
        else:
            write_content(target, content)
        self.written[target] = what

    def write(self, text: str) -> None:
        """Write text on standard output; characters that its encoding lacks become escapes.

        After the reader of a pipe has closed it, as `head` does, the text is dropped, but the run continues:
        its verdict and its files are still wanted.
        """
        if not self._reader_gone:
            try:
                code = getattr(sys.stdout, "encoding", None) or "utf-8"
                sys.stdout.write(text.encode(code, "backslashreplace").decode(code))
            except (OSError, ValueError, AttributeError) as error:
                self._lose(error)

    def flush(self) -> None:
        """Flush standard output."""
        if self._reader_gone or sys.stdout is None:
            return
        try:
            sys.stdout.flush()
        except (OSError, ValueError) as error:
            self._lose(error)

    def _lose(self, error: Exception) -> None:
        """Redirect standard output to the null device, so that flushing its buffer at exit cannot fail again.

        Raises:
            NotFinished: the error is not just a broken pipe.
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
        raise NotFinished(STANDARD_OUTPUT, "is closed; use --quiet, and name files for results") from None

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
    def progress(
        self, message: str, first: float = PAUSE, total: int | None = None, lines: bool = True
    ) -> Iterator[Told]:
        """Print the progress of the block, unless the run is quiet. A nested block uses the outer progress.

        Args:
            message: what is being done, until the next call of the yielded function.
            first: seconds before the first line if standard error is no terminal.
            total: the total amount, if known.
            lines: whether lines are printed if standard error is no terminal.
        """
        outer, terminal = self._progress, is_terminal(sys.stderr)
        if outer is not None:
            outer.told(message, 0, total)
            yield outer.told
        elif self.quiet or sys.stderr is None or not (terminal or lines):
            yield lambda message, done, total=None: None
        else:
            self._progress = shown = Progress(self.note, message, total, PATIENCE if terminal else first)
            try:
                yield shown.told
            finally:
                self._progress = None
                shown.end()
