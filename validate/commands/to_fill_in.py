"""A file that an option names and that is not there yet: written, ready to be filled in."""

from __future__ import annotations

from validate.exit_status import ExitStatus
from validate.output.console import Console
from validate.output.files import require_known_ending, write_content
from validate.plain_text import shown

ENDINGS = (".toml",)


def to_be_filled_in(target: str, text: str, console: Console) -> ExitStatus:
    """Write it, and say what to do.

    Raises:
        UsageError: it is not called .toml.
        OutputError: it cannot be written.
    """
    require_known_ending(target, ENDINGS)
    write_content(target, text)
    console.complain(f"{shown(target)} was not there: it is written; fill it in, and run this again")
    return ExitStatus.WRONG_INPUT
