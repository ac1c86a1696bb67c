"""The first lines of the program `pointcoord`, which need nothing but Python itself.

The solver and its libraries take most of a second to import. Ctrl-C or SIGTERM is one line in that time too,
and so is a `validate` that another distribution has put in the place of ours. The solver does not depend on
what validates it: the program behind these lines is looked up by its name, as a shell would.
"""

from __future__ import annotations

import importlib
import os
import signal
import sys

TYPE_CHECKING = False  # as in `pointcoord`
if TYPE_CHECKING:
    from types import FrameType
    from typing import NoReturn

NAME = "pointcoord"
WRONG_INPUT, NOT_FINISHED = 2, 4
# What ends a program, each by a word for it, and what Python does about it; a parent may have it ignored.
SIGNALS = {
    signal.SIGINT: ("interrupted", signal.default_int_handler),
    signal.SIGTERM: ("terminated", signal.SIG_DFL),
}


def main() -> int:
    """Run the program; returns its exit status, see `validate.exit_status`."""
    _open_closed_descriptors()
    ours = [one for one, (_, usual) in SIGNALS.items() if signal.getsignal(one) is usual]
    for one in ours:
        signal.signal(one, _interrupted)
    try:
        validate = importlib.import_module("validate")
        if getattr(validate, "DISTRIBUTION", None) != NAME:
            return _said(not_ours(), WRONG_INPUT)
        cli = importlib.import_module("validate.cli")
        terminated = importlib.import_module("validate.exit_status").terminated
    except ImportError as error:
        if (error.name or "").partition(".")[0] == "validate":
            return _said(not_ours(), WRONG_INPUT)
        if "failed to map segment" in str(error):  # what the loader of libraries says without memory
            return _said("cannot start: out of memory", NOT_FINISHED)
        return _said(f"cannot start: {error}; try: pip install --force-reinstall {NAME}", NOT_FINISHED)
    except MemoryError:
        return _said("cannot start: out of memory", NOT_FINISHED)
    for one in ours:
        signal.signal(one, signal.default_int_handler if one == signal.SIGINT else terminated)
    status = int(cli.main())
    for one in ours:
        # All is written: the end of the interpreter need not be interrupted.
        signal.signal(one, signal.SIG_IGN)
    return status


def _open_closed_descriptors() -> None:
    """Standard streams that are closed lead nowhere: the next file opened must not take their place."""
    while (descriptor := os.open(os.devnull, os.O_RDWR)) <= 2:
        pass
    os.close(descriptor)


def _interrupted(number: int, frame: FrameType | None) -> NoReturn:
    # At once: a library that is being imported may take an exception for a fault of its own.
    word, _ = SIGNALS[signal.Signals(number)]
    os._exit(_said(f"{word}; nothing is written", 128 + number))


def _said(message: str, status: int) -> int:
    line = f"{NAME}: {' '.join(message.split())}\n"
    os.write(2, line.encode("ascii", "backslashreplace"))
    return status


def not_ours() -> str:
    """What to say where Python finds another package `validate` than ours."""
    from importlib import metadata  # takes a third of numpy's time, for a rare message

    others = sorted({*metadata.packages_distributions().get("validate", ())} - {NAME})
    where = getattr(sys.modules.get("validate"), "__file__", None) or "no file"
    who = f"the distribution {' and '.join(map(repr, others))}" if others else "something else"
    first = f"pip uninstall {' '.join(others)}, then " if others else "take it off the path, or "
    return (
        f"the package 'validate' that Python finds ({where}) is not {NAME}'s: {who} has put its own there; "
        f"try: {first}pip install --force-reinstall --no-deps {NAME}, or an environment of its own"
    )


if __name__ == "__main__":
    sys.exit(main())
