"""Entry point of the program `pointcoord`. It needs only the standard library.

The solver and its libraries take most of a second to import. During that time Ctrl-C and SIGTERM already
end in a one-line message. So does finding another distribution's package `validate` in place of this one's.
The solver does not depend on `validate`, so the command line in `validate` is imported by its name.
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
# Signals that end the program: the word for the message, and Python's default handler. Only these handlers
# are replaced: a parent process may have set a signal to be ignored.
SIGNALS = {
    signal.SIGINT: ("interrupted", signal.default_int_handler),
    signal.SIGTERM: ("terminated", signal.SIG_DFL),
}


def main() -> int:
    """Run the program and return its exit status (see `validate.exit_status`)."""
    _open_closed_descriptors()
    handled = [one for one, (_, usual) in SIGNALS.items() if signal.getsignal(one) is usual]
    for one in handled:
        signal.signal(one, _interrupted)
    try:
        validate = importlib.import_module("validate")
        if getattr(validate, "DISTRIBUTION", None) != NAME:
            return _report(not_ours(), WRONG_INPUT)
        cli = importlib.import_module("validate.cli")
        terminated = importlib.import_module("validate.exit_status").terminated
    except ImportError as error:
        if (error.name or "").partition(".")[0] == "validate":
            return _report(not_ours(), WRONG_INPUT)
        if "failed to map segment" in str(error):  # the dynamic loader's message when memory runs out
            return _report("cannot start: out of memory", NOT_FINISHED)
        return _report(f"cannot start: {error}; try: pip install --force-reinstall {NAME}", NOT_FINISHED)
    except MemoryError:
        return _report("cannot start: out of memory", NOT_FINISHED)
    for one in handled:
        signal.signal(one, signal.default_int_handler if one == signal.SIGINT else terminated)
    status = int(cli.main())
    for one in handled:
        # All output is written: a signal must not interrupt the interpreter's exit.
        signal.signal(one, signal.SIG_IGN)
    return status


def _open_closed_descriptors() -> None:
    """Open closed standard streams on the null device: no later file may take their place."""
    while (descriptor := os.open(os.devnull, os.O_RDWR)) <= 2:
        pass
    os.close(descriptor)


def _interrupted(number: int, frame: FrameType | None) -> NoReturn:
    # Exit at once: a library that is being imported might catch an exception as its own.
    word, _ = SIGNALS[signal.Signals(number)]
    os._exit(_report(f"{word}; nothing is written", 128 + number))


def _report(message: str, status: int) -> int:
    line = f"{NAME}: {' '.join(message.split())}\n"
    os.write(2, line.encode("ascii", "backslashreplace"))
    return status


def not_ours() -> str:
    """The message for a package `validate` that belongs to another distribution."""
    from importlib import metadata  # takes a third of numpy's time, for a rare message

    others = sorted({*metadata.packages_distributions().get("validate", ())} - {NAME})
    where = getattr(sys.modules.get("validate"), "__file__", None) or "no file"
    who = f"the distribution {' and '.join(map(repr, others))}" if others else "something else"
    first = f"pip uninstall {' '.join(others)}, then " if others else "take it off the path, or "
    return (
        f"the package 'validate' that Python finds ({where}) is not part of {NAME}: {who} installed it; "
        f"try: {first}pip install --force-reinstall --no-deps {NAME}, or a separate environment for {NAME}"
    )


if __name__ == "__main__":
    sys.exit(main())
