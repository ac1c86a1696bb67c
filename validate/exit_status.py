"""The exit statuses of the program: the meaning of each, and the status of a run of several scenes."""

from __future__ import annotations

from collections.abc import Iterable
from enum import IntEnum
from types import FrameType
from typing import NoReturn


class ExitStatus(IntEnum):
    """The exit status of a run."""

    AGREE = 0
    DISAGREE = 1
    WRONG_INPUT = 2
    NO_VERDICT = 3
    NOT_FINISHED = 4
    INTERRUPTED = 130
    TERMINATED = 143

    @property
    def verdict(self) -> str:
        """The status in words, as in the JSON."""
        return self.name.lower().replace("_", " ")


MEANINGS = {
    ExitStatus.AGREE: "everything agrees; for a command that compares nothing: done",
    ExitStatus.DISAGREE: "something disagrees, or has moved since its baseline; the table says what",
    ExitStatus.WRONG_INPUT: "the command line or a scene is wrong, or a package is missing",
    ExitStatus.NO_VERDICT: "no verdict: a scene is refused, differs from its baseline's, or tests nothing",
    ExitStatus.NOT_FINISHED: "could not finish or write: a full disk, no memory, a defect of the program",
    ExitStatus.INTERRUPTED: "interrupted by Ctrl-C",
    ExitStatus.TERMINATED: "ended by SIGTERM, as a cancelled job is; otherwise as after Ctrl-C",
}

# The first status in this order that any scene has is the status of the run. A disagreement comes first: it
# stands whatever the other scenes give. An unfinished scene comes second: it could have been a disagreement.
ORDER = (
    ExitStatus.DISAGREE,
    ExitStatus.NOT_FINISHED,
    ExitStatus.WRONG_INPUT,
    ExitStatus.NO_VERDICT,
    ExitStatus.AGREE,
)

HELP = "\n".join(
    (
        "exit status:",
        *(f"  {status.value:>3}  {meaning}" for status, meaning in MEANINGS.items()),
        "A run of several scenes ends with the first of "
        f"{', '.join(str(status.value) for status in ORDER)} that occurs; with 4 if its results\n"
        "cannot be written, and with 130 or 143 if it is interrupted.",
    )
)


class Terminated(KeyboardInterrupt):
    """Raised for SIGTERM, so that the run ends as it does after Ctrl-C."""


def terminated(number: int, frame: FrameType | None) -> NoReturn:
    """The signal handler of SIGTERM."""
    raise Terminated


def of_interruption(error: KeyboardInterrupt) -> ExitStatus:
    """The status of a run that was ended by a signal."""
    return ExitStatus.TERMINATED if isinstance(error, Terminated) else ExitStatus.INTERRUPTED


def combined(statuses: Iterable[ExitStatus]) -> ExitStatus:
    """The status of a run from the statuses of its scenes, see `ORDER`."""
    found = set(statuses)
    return next((status for status in ORDER if status in found), ExitStatus.AGREE)
