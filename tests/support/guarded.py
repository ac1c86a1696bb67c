"""The program run in this process, with a limit of processor time that nothing in it can catch."""

from __future__ import annotations

import contextlib
import io
import signal
from collections.abc import Iterator
from types import FrameType
from typing import NamedTuple

from program import complaints

from validate.cli import main


class TooLong(BaseException):
    """Nothing but the test itself may catch this."""


class Run(NamedTuple):
    """What a user of the program sees."""

    status: int
    out: str
    err: str


@contextlib.contextmanager
def stopwatch(seconds: float) -> Iterator[None]:
    """End what takes more processor time, so that a busy machine changes nothing."""

    def late(number: int, frame: FrameType | None) -> None:
        raise TooLong(f"more than {seconds} s of processor time")

    before = signal.signal(signal.SIGPROF, late)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


def run_within(seconds: float, *arguments: str) -> Run:
    """Run the program; warnings are errors here, so one ends it as a traceback would."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err), stopwatch(seconds):
        status = main(arguments)
    return Run(status, out.getvalue(), err.getvalue())


def wrong_words(seen: Run, compares: bool = False) -> str:
    """What is wrong with how a run ended: nothing if it has an answer, or says in one line why not.

    Args:
        compares: whether it may end with 1, or with 3 and the reason in its table.
    """
    if seen.status not in ((0, 1, 2, 3) if compares else (0, 2, 3)):
        return f"status {seen.status}: {seen.out}{seen.err}"
    told, least = len(complaints(seen.err)), int(seen.status in ((2,) if compares else (2, 3)))
    if not least <= told <= int(seen.status != 0):
        return f"status {seen.status} with {seen.err!r}"
    # Whatever a file calls things, its names do not steer the terminal.
    lines = seen.err.removesuffix("\n").split("\n")
    return "" if all(map(str.isprintable, lines)) else f"steers a terminal: {seen.err!r}"
