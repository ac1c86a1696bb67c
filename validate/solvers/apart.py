"""Runs a user's solver in a child process: the solver may hang, crash or exit, and the run goes on.

A user's solver is unknown code. In the process of the run, a segmentation fault, an `os._exit` or an endless
loop would lose the results of all scenes, and a time limit could not be enforced, because nothing can
interrupt a library that does not return. So the program calls the solver in a child process, which costs half
a second once. The child imports the solver once and keeps it for all scenes. A solver that crashes or is
stopped is started again for the next scene: its state is lost, but only one scene has no answer.

Requests and answers go through a pipe. Output of the solver goes to standard error; its standard input is
empty. The process group of the child is ended with the child, so that no process of the solver remains. From
Python (`check`, the pytest plugin) a solver is called in the same process: a local function cannot be sent to
another process.
"""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Mapping
from contextlib import suppress
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from threading import TIMEOUT_MAX
from typing import Any, Self

import numpy as np

from validate.errors import UsageError
from validate.plain_text import named, shown
from validate.solvers.load import solver_at
from validate.solvers.plain import Solve, SolverFailed, answer_of, raised_at

LIMIT = 600.0  # s, for an answer: no motion of a suspension takes that long
PARTING = 2.0  # s, for a child to end by itself

# The kinds of messages from the child; a message is a pair of kind and data. ENDED: no further message.
FOUND, NONE, ANSWER, FAILED, ENDED = "found", "no solver", "answer", "failed", "ended"
BUILTIN = (str, bytes, bool, int, float, complex, type(None))


class Apart:
    """A solver in a child process.

    Attributes:
        place: module and name, such as `package.module:Solver`.
        limit: time limit of each answer, s; the import may take LIMIT, or `limit` if that is longer.
    """

    def __init__(self, place: str, with_traceback: bool = False, limit: float = LIMIT) -> None:
        """Start the child, and wait until it has imported the solver.

        Raises:
            UsageError: there is no such solver, it cannot be imported, or the import takes too long.
        """
        self.place = place
        self.limit = limit
        self._with_traceback = with_traceback
        self._start()

    def _start(self) -> None:
        context = get_context("spawn")
        self._pipe, there = context.Pipe()
        self._process = context.Process(target=serve, args=(there, self.place, self._with_traceback))
        self._process.start()
        there.close()
        self._runs = True
        kind, rest = self._said(max(self.limit, LIMIT))
        if kind == ENDED:
            problem = f"the solver {shown(self.place)!r} cannot be imported: {rest}"
            raise UsageError(f"{problem}; fix the module")
        if kind == NONE:
            self._end(idle=True)
            raise UsageError(rest)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._end(idle=True)

    def __call__(self, given: Mapping[str, Any]) -> Mapping[str, Any]:
        """Ask the solver.

        Raises:
            SolverFailed: it raised an error, did not return a mapping, crashed or took too long.
        """
        try:
            if not self._runs:
                self._start()
        except UsageError as error:
            raise SolverFailed(f"started again after it ended: {error}") from error
        # If the child has ended, waiting for its answer reports it.
        with suppress(OSError):
            self._pipe.send(given)
        kind, rest = self._said(self.limit)
        if kind != ANSWER:
            raise SolverFailed(*([rest] if kind == ENDED else rest))
        found: Mapping[str, Any] = rest
        return found

    def _said(self, limit: float) -> tuple[str, Any]:
        """The next message from the child; ENDED and the reason if there is none; the child is then ended."""
        try:
            if not wait([self._pipe, self._process.sentinel], min(limit, TIMEOUT_MAX)):
                why = f"it took longer than {limit:g} s and was stopped; --solver-timeout S allows more"
            else:
                # An incomplete answer is treated as the end of the child.
                with suppress(Exception):
                    answer: tuple[str, Any] = self._pipe.recv()
                    return answer
                self._process.join(PARTING)
                why = _ended(self._process.exitcode)
        except BaseException:
            # Ctrl-C ends a working child too.
            self._end(idle=False)
            raise
        self._end(idle=False)
        return ENDED, why

    def _end(self, idle: bool) -> None:
        """End the child and its processes. An idle child first ends by itself, so that it can close files."""
        if not self._runs:
            return
        self._runs = False
        self._pipe.close()
        if idle:
            self._process.join(PARTING)
        if sys.platform != "win32" and self._process.pid is not None:
            with suppress(ProcessLookupError, PermissionError):
                os.killpg(self._process.pid, signal.SIGKILL)
        self._process.kill()
        self._process.join()


def _ended(status: int | None) -> str:
    """How a process with this exit status ended without an answer."""
    if status is None:
        return "its process closed its output without an answer"
    if status >= 0:
        return f"its process ended with exit status {status} and without an answer"
    names = {int(one): one.name for one in signal.Signals}
    return f"its process was ended by {names.get(-status, f'signal {-status}')}"


def serve(pipe: Connection[Any, Any], place: str, with_traceback: bool) -> None:
    """The main function of the child: import the solver, and answer until the pipe is closed."""
    if sys.platform != "win32":
        os.setsid()
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    os.dup2(2, 1)
    try:
        solve = solver_at(place, with_traceback)
    except UsageError as error:
        pipe.send((NONE, str(error)))
        return
    pipe.send((FOUND, None))
    try:
        while True:
            pipe.send(_answer(solve, pipe.recv()))
    except EOFError:
        return  # the run has closed the pipe: it has ended
    except OSError:
        os._exit(1)  # the solver has closed the pipe


def _answer(solve: Solve, given: dict[str, Any]) -> tuple[str, object]:
    try:
        return ANSWER, _plain(answer_of(solve, given))
    except SolverFailed as error:
        return FAILED, (error.problem, error.where)
    # The child goes on after any error. Ctrl-C does not reach it: a KeyboardInterrupt is the solver's own.
    except BaseException as error:
        return FAILED, (named(error), raised_at(error))


def _plain(answer: Any) -> Any:
    """An answer without classes that only the child can import: arrays of other libraries become numpy's."""
    if isinstance(answer, Mapping):
        return {key if type(key) in BUILTIN else str(key): _plain(part) for key, part in answer.items()}
    if type(answer) in BUILTIN or isinstance(answer, np.ma.MaskedArray):
        return answer  # masked entries are reported later
    with suppress(Exception):
        array = np.asarray(answer)
        if array.dtype != object:
            return array
    if type(answer) in (list, tuple):
        return [_plain(one) for one in answer]
    return f"an object of type {type(answer).__name__}"
