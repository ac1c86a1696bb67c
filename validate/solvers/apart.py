"""A solver in a process of its own: it may hang, crash or end itself, and the run goes on without it.

A solver of somebody's is code that this project knows nothing of. In the run's own process a segmentation
fault, an `os._exit` or a loop without end would take with it what is computed of all scenes; a time limit
could not be kept either, since nothing can interrupt a library that does not return. So the program asks it
in a child, which costs half a second once. The child imports the solver once and keeps it for all scenes. One
that crashes or is stopped is made anew for the next scene: what it knew is lost, and with it only that scene.

Requests and answers are pickled, in pairs, through the child's standard input and output; what the solver
prints goes to standard error, and where it reads standard input there is none. The child's process group is
ended with it, so that what a solver started does not stay behind. From Python (`check`, the pytest plugin) a
solver is called where it is: a function that lives there cannot be sent elsewhere.
"""

from __future__ import annotations

import json
import os
import pickle
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Mapping
from contextlib import suppress
from queue import Empty, SimpleQueue
from types import TracebackType
from typing import IO, Any, Self

import numpy as np

from validate.plain_text import shown
from validate.solvers.load import solver_at
from validate.solvers.plain import NoSolver, Solve, SolverFailed, no_mapping, raised_at, said

LIMIT = 600.0  # s, an answer: no motion of a suspension takes so long
PARTING = 2.0  # s, that a child is given to end by itself
CODE = f"import json, sys; sys.path[:] = json.loads(sys.argv.pop()); from {__name__} import serve; serve()"

# What the child says first: how it went. Then what there is to say of it.
FOUND, NONE, ANSWER, FAILED = "found", "no solver", "answer", "failed"
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
        self._child: _Child | None = _Child(place, with_traceback)
        self._found = False

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, where: TracebackType | None
    ) -> None:
        self._end(idle=self._found)

    def found(self) -> None:
        """Wait until the child has imported the solver.

        Raises:
            NoSolver: there is none, it cannot be imported, or that takes longer than LIMIT.
        """
        if self._found:
            return
        if self._child is None:
            self._child = _Child(self.place, self._with_traceback)
        answer = self._said(max(self.limit, LIMIT))
        if isinstance(answer, str):
            what = f"the solver {shown(self.place)!r}"
            raise NoSolver(what, f"cannot be imported: {answer}", "mend the module")
        kind, rest = answer
        if kind == NONE:
            self._end(idle=True)
            raise NoSolver(*rest)
        self._found = True

    def __call__(self, given: Mapping[str, Any]) -> Mapping[str, Any]:
        """Ask the solver.

        Raises:
            SolverFailed: it raised an error, answered with no mapping, crashed or took too long.
        """
        try:
            self.found()
        except NoSolver as error:
            raise SolverFailed(f"made anew after it ended, it {error.problem}") from error
        assert self._child is not None  # it was found
        self._child.ask(given)
        answer = self._said(self.limit)
        if isinstance(answer, str):
            raise SolverFailed(answer)
        kind, rest = answer
        if kind == FAILED:
            raise SolverFailed(*rest)
        found: Mapping[str, Any] = rest
        return found

    def _said(self, limit: float) -> tuple[str, Any] | str:
        """What the child says next; or in words why it will say nothing more, and then it is ended."""
        assert self._child is not None  # whoever asks has one
        answer: tuple[str, Any] | str = ""
        try:
            answer = self._child.said(limit)
        finally:
            # Ctrl-C while it works ends it too.
            if isinstance(answer, str):
                self._end(idle=False)
        return answer

    def _end(self, idle: bool) -> None:
        if self._child is not None:
            self._child.end(idle)
        self._child, self._found = None, False


class _Child:
    """The process, and a thread that reads what it says."""

    def __init__(self, place: str, with_traceback: bool) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-c", CODE, json.dumps(sys.path)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            start_new_session=True,
        )
        assert self._process.stdin is not None  # both are pipes
        assert self._process.stdout is not None
        self._requests: IO[bytes] = self._process.stdin
        self._answers: SimpleQueue[Any] = SimpleQueue()
        reader = threading.Thread(target=self._read, args=(self._process.stdout,), daemon=True)
        reader.start()
        self.ask((place, with_traceback))

    def _read(self, stream: IO[bytes]) -> None:
        """Put what it says into a queue, and None at its end."""
        with stream:
            try:
                while True:
                    self._answers.put(pickle.load(stream))
            except Exception:
                # Cut off in the middle of an answer is an end like any other.
                self._answers.put(None)

    def ask(self, what: object) -> None:
        """Send something; that it has ended is found when its answer is awaited."""
        with suppress(OSError):
            pickle.dump(what, self._requests, protocol=pickle.HIGHEST_PROTOCOL)
            self._requests.flush()

    def said(self, limit: float) -> Any:
        """What it says next, or in words why it says nothing."""
        try:
            answer = self._answers.get(timeout=min(limit, threading.TIMEOUT_MAX))
        except Empty:
            return f"it took longer than {limit:g} s and was stopped; --solver-timeout S allows more"
        if answer is not None:
            return answer
        try:
            status = self._process.wait(PARTING)
        except subprocess.TimeoutExpired:
            return "its process closed its output without an answer"
        if status >= 0:
            return f"its process ended with exit status {status} and without an answer"
        names = {int(one): one.name for one in signal.Signals}
        return f"its process was ended by {names.get(-status, f'signal {-status}')}"

    def end(self, idle: bool) -> None:
        """End it and what it started; an idle one by the end of its requests, so that it can close files."""
        with suppress(OSError):
            self._requests.close()
        if idle:
            with suppress(Empty):
                self._answers.get(timeout=PARTING)
        if sys.platform == "win32":
            self._process.kill()
        else:
            with suppress(ProcessLookupError, PermissionError):
                os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait()


def serve() -> None:
    """What the child does: import the solver that it is told, and answer until nobody asks any more."""
    requests, answers = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.dup2(2, 1)

    def say(*what: object) -> None:
        pickle.dump(what, answers, protocol=pickle.HIGHEST_PROTOCOL)
        answers.flush()

    place, with_traceback = pickle.load(requests)
    try:
        solve = solver_at(place, with_traceback)
    except NoSolver as error:
        say(NONE, (error.what, error.problem, error.remedy))
        return
    say(FOUND, None)
    # Nobody asks any more when the run has ended, however it ended; or the solver has closed what it may not.
    with suppress(EOFError, OSError):
        while True:
            say(*_answer(solve, pickle.load(requests)))


def _answer(solve: Solve, given: dict[str, Any]) -> tuple[str, object]:
    try:
        answer: object = solve(_read_only(given))
        if not isinstance(answer, Mapping):
            return FAILED, (no_mapping(answer), "")
        return ANSWER, _plain(answer)
    # Whatever it is, the child lives on: Ctrl-C does not reach it, so that even that is the solver's own.
    except BaseException as error:
        return FAILED, (said(error), raised_at(error))


def _read_only(given: Any) -> Any:
    """What is given, as it is before it is sent: pickle forgets that arrays cannot be written to."""
    if isinstance(given, np.ndarray):
        given.flags.writeable = False
    elif isinstance(given, dict):
        for part in given.values():
            _read_only(part)
    return given


def _plain(answer: Any) -> Any:
    """An answer without classes that only its own process knows: other libraries' arrays become numpy's."""
    if isinstance(answer, Mapping):
        return {key if type(key) in BUILTIN else str(key): _plain(part) for key, part in answer.items()}
    if type(answer) in BUILTIN or isinstance(answer, np.ma.MaskedArray):
        return answer  # what is masked is to be told
    try:
        array = np.asarray(answer)
        if array.dtype != object:
            return array
    except Exception:
        # What is no array goes as it is, so that the complaint can say what is wrong with it.
        return _listed(answer)
    return _listed(answer)


def _listed(part: Any) -> Any:
    if type(part) in (list, tuple):
        return [_listed(one) for one in part]
    return part if type(part) in BUILTIN else _Foreign(type(part).__name__)


class _Foreign:
    """Something of a class that only the child knows; what arrives is empty, of a class of that name."""

    def __init__(self, name: str) -> None:
        self.name = name

    def __reduce__(self) -> tuple[Callable[[str], object], tuple[str]]:
        return _of_that_name, (self.name,)


def _of_that_name(name: str) -> object:
    return type(name, (), {})()
