"""A solver in a process of its own: it may hang, crash or end itself, and the run goes on without it.

A solver of somebody's is code that this project knows nothing of. In the run's own process a segmentation
fault, an `os._exit` or a loop without end would take with it what is computed of all scenes; a time limit
could not be kept either, since nothing can interrupt a library that does not return. So the program asks it
in a child, which costs half a second once. The child imports the solver once and keeps it for all scenes. One
that crashes or is stopped is made anew for the next scene: what it knew is lost, and with it only that scene.

Requests and answers go through a pipe; what the solver prints goes to standard error, and where it reads
standard input there is none. The child's process group is ended with it, so that what a solver started does
not stay behind. From Python (`check`, the pytest plugin) a
solver is called where it is: a function that lives there cannot be sent elsewhere.
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
from types import TracebackType
from typing import Any, Self

import numpy as np

from validate.errors import UsageError
from validate.plain_text import shown
from validate.solvers.load import solver_at
from validate.solvers.plain import Solve, SolverFailed, no_mapping, raised_at, read_only, said

LIMIT = 600.0  # s, an answer: no motion of a suspension takes so long
PARTING = 2.0  # s, that a child is given to end by itself

# What the child says first: how it went, or that it says nothing more. Then what there is to say of it.
FOUND, NONE, ANSWER, FAILED, ENDED = "found", "no solver", "answer", "failed", "ended"
BUILTIN = (str, bytes, bool, int, float, complex, type(None))


class Apart:
    """A solver by its module and name there, in a child process.

    Attributes:
        place: such as `package.module:Solver`. limit: s, that each answer may take; its import, once, LIMIT.
    """

    def __init__(self, place: str, with_traceback: bool = False, limit: float = LIMIT) -> None:
        """Start the child; `found` waits for it."""
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
        self._runs, self._found = True, False

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, where: TracebackType | None
    ) -> None:
        self._end(idle=self._found)

    def found(self) -> None:
        """Wait until the child has imported the solver.

        Raises:
            UsageError: there is none, it cannot be imported, or that takes longer than LIMIT.
        """
        if self._found:
            return
        if not self._runs:
            self._start()
        kind, rest = self._said(max(self.limit, LIMIT))
        if kind == ENDED:
            problem = f"the solver {shown(self.place)!r} cannot be imported: {rest}"
            raise UsageError(f"{problem}; mend the module")
        if kind == NONE:
            self._end(idle=True)
            raise UsageError(rest)
        self._found = True

    def __call__(self, given: Mapping[str, Any]) -> Mapping[str, Any]:
        """Ask the solver.

        Raises:
            SolverFailed: it raised an error, answered with no mapping, crashed or took too long.
        """
        try:
            self.found()
        except UsageError as error:
            raise SolverFailed(f"made anew after it ended: {error}") from error
        # That it has ended is found when its answer is awaited.
        with suppress(OSError):
            self._pipe.send(given)
        kind, rest = self._said(self.limit)
        if kind != ANSWER:
            raise SolverFailed(*([rest] if kind == ENDED else rest))
        found: Mapping[str, Any] = rest
        return found

    def _said(self, limit: float) -> tuple[str, Any]:
        """What the child says next; or in words why it will say nothing more, and then it is ended."""
        try:
            if not wait([self._pipe, self._process.sentinel], min(limit, TIMEOUT_MAX)):
                why = f"it took longer than {limit:g} s and was stopped; --solver-timeout S allows more"
            else:
                # An answer that is cut off in the middle is an end like any other.
                with suppress(Exception):
                    answer: tuple[str, Any] = self._pipe.recv()
                    return answer
                self._process.join(PARTING)
                why = _ended(self._process.exitcode)
        except BaseException:
            # Ctrl-C while it works ends it too.
            self._end(idle=False)
            raise
        self._end(idle=False)
        return ENDED, why

    def _end(self, idle: bool) -> None:
        """End it and what it started; an idle one by the end of its requests, so that it can close files."""
        if not self._runs:
            return
        self._runs = self._found = False
        self._pipe.close()
        if idle:
            self._process.join(PARTING)
        if sys.platform != "win32" and self._process.pid is not None:
            with suppress(ProcessLookupError, PermissionError):
                os.killpg(self._process.pid, signal.SIGKILL)
        self._process.kill()
        self._process.join()


def _ended(status: int | None) -> str:
    """How a process ended without an answer, by its exit status."""
    if status is None:
        return "its process closed its output without an answer"
    if status >= 0:
        return f"its process ended with exit status {status} and without an answer"
    names = {int(one): one.name for one in signal.Signals}
    return f"its process was ended by {names.get(-status, f'signal {-status}')}"


def serve(pipe: Connection[Any, Any], place: str, with_traceback: bool) -> None:
    """What the child does: import the solver that it is told, and answer until nobody asks any more."""
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
        return  # nobody asks any more: the run has ended, however it ended
    except OSError:
        os._exit(1)  # the solver has closed what it may not


def _answer(solve: Solve, given: dict[str, Any]) -> tuple[str, object]:
    try:
        answer: object = solve(read_only(given))  # pickle forgets that arrays cannot be written to
        if not isinstance(answer, Mapping):
            return FAILED, (no_mapping(answer), "")
        return ANSWER, _plain(answer)
    # Whatever it is, the child lives on: Ctrl-C does not reach it, so that even that is the solver's own.
    except BaseException as error:
        return FAILED, (said(error), raised_at(error))


def _plain(answer: Any) -> Any:
    """An answer without classes that only its own process knows: other libraries' arrays become numpy's."""
    if isinstance(answer, Mapping):
        return {key if type(key) in BUILTIN else str(key): _plain(part) for key, part in answer.items()}
    if type(answer) in BUILTIN or isinstance(answer, np.ma.MaskedArray):
        return answer  # what is masked is to be told
    with suppress(Exception):
        array = np.asarray(answer)
        if array.dtype != object:
            return array
    if type(answer) in (list, tuple):
        return [_plain(one) for one in answer]
    return f"something of type {type(answer).__name__}"
