"""The JSON documents of the program: the results, with the command, machine and time of the run.

`pointcoord --schema` prints the JSON Schema.
"""

from __future__ import annotations

import json
import math
import os
import shlex
import time
from argparse import Namespace
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import cache
from pathlib import Path
from typing import Any

from validate.exit_status import ExitStatus, of_interruption
from validate.output.console import Console

# Increased by one when a key changes its meaning or is removed. A new key does not disturb readers.
SCHEMA_VERSION = 3
PACKAGES = ("numpy", "scipy", "pin", "mpmath", "python-flint", "mujoco", "exudyn")
# Environment variables that set the number of threads of the linear algebra.
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
# Kinds of runs that compare nothing: their times and numbers are neither right nor wrong.
COMPARES_NOTHING = ("cost", "fit", "fit-suspects", "hard-list")
# Kinds of runs whose document has the times of its start and its end; others have them with --timings only.
TIMED = ("cost", "hard", "hard-list", "random", "bounds", "claims")
NOT_FINISHED = ExitStatus.NOT_FINISHED
PAUSE = 9.0  # pause after a journal is written, in multiples of the time that writing took


def program_version() -> str:
    """Version of the installed distribution."""
    return _version("pointcoord") or "not installed"


def _version(distribution: str) -> str | None:
    # Imported here: it takes a third of the time of importing numpy, and most runs write no document.
    from importlib import metadata

    try:
        return metadata.version(distribution)
    except metadata.PackageNotFoundError:
        return None


def code_digest(places: Sequence[str]) -> str:
    """A digest of the .py and .toml files at some places of this distribution, such as `validate/cost`."""
    import hashlib

    root, digest = Path(__file__).parents[2], hashlib.sha256()
    for place in places:
        for file in sorted(f for f in (root / place).rglob("*") if f.suffix in (".py", ".toml")):
            digest.update(file.relative_to(root).as_posix().encode() + b"\0" + file.read_bytes() + b"\0")
    return digest.hexdigest()[:12]


@cache
def machine() -> dict[str, Any]:
    """The machine of the run: system, processors, versions, and thread limits."""
    import platform

    return {
        "platform": platform.platform(),
        "processor": platform.machine(),
        "processors": os.cpu_count(),
        "python": platform.python_version(),
        "packages": {name: _version(name) for name in PACKAGES},
        "threads": {name: os.environ.get(name) for name in THREADS},
    }


def now() -> str:
    """The current time in the format of RFC 3339, UTC, to the second."""
    return datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")


@dataclass(frozen=True)
class Head:
    """The facts of a run that are known before it begins.

    Attributes:
        kind: kind of the results: validate, hard, hard-list, random, bounds, claims, cost, fit or
            fit-suspects.
        command: the command line, word by word.
        started: UTC; None if the document has no times, so that equal runs give equal bytes.
    """

    kind: str
    command: tuple[str, ...]
    started: str | None = None

    @classmethod
    def of(cls, kind: str, command: Sequence[str], timed: bool = False) -> Head:
        """The head of a run that begins now."""
        return cls(kind, tuple(command), now() if timed else None)

    def verdict(self, status: ExitStatus) -> str:
        """The exit status in words."""
        compared = self.kind not in COMPARES_NOTHING or status is not ExitStatus.AGREE
        return status.verdict if compared else "nothing compared"

    def document(
        self, results: Mapping[str, Any], status: ExitStatus | None, complete: bool
    ) -> dict[str, Any]:
        """The document as plain data; status None for a run in progress."""
        return {
            "schema_version": SCHEMA_VERSION,
            "kind": self.kind,
            "program": {"name": "pointcoord", "version": program_version()},
            "command": list(self.command),
            "command_line": shlex.join(self.command),
            "started": self.started,
            "written": None if self.started is None else now(),
            "machine": machine(),
            "complete": complete,
            "exit_status": None if status is None else status.value,
            "verdict": None if status is None else self.verdict(status),
            **results,
        }


def json_text(data: Any) -> str:
    """JSON of plain data. JSON has no infinity and no NaN: such a number becomes null."""
    return json.dumps(_plain(data), indent=1, allow_nan=False) + "\n"


def _plain(data: Any) -> Any:
    if isinstance(data, str):
        # A file name may contain bytes that are not valid text.
        return data.encode("utf-8", "backslashreplace").decode("utf-8")
    if isinstance(data, float) and not math.isfinite(data):
        return None
    if isinstance(data, Mapping):
        return {_plain(key): _plain(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [_plain(value) for value in data]
    return data


@dataclass
class Journal:
    """The JSON of a run. It is written again after each part, so that a killed run loses very little.

    As a context, it writes the document when the block ends, also after an exception; to standard output the
    document is written only then.

    Attributes:
        target: the file, - for standard output, None if no JSON is asked for.
        results: returns all results so far, as plain data.
        what: returns the results in words, such as `3 of 20 scenes`; empty while there are none.
        leave: called before the document is written at the end; writes the other files of the run.
        status: exit status of the run; the block sets it.
        complete: whether the block ended without an exception.
    """

    target: str | None
    head: Head
    console: Console
    results: Callable[[], Mapping[str, Any]]
    what: Callable[[], str]
    leave: Callable[[Journal], None] = lambda journal: None
    status: ExitStatus = ExitStatus.AGREE
    complete: bool = False
    _next: float = 0.0

    @classmethod
    def of(
        cls,
        options: Namespace,
        console: Console,
        kind: str,
        results: Callable[[], Mapping[str, Any]],
        what: Callable[[], str],
        leave: Callable[[Journal], None] = lambda journal: None,
    ) -> Journal:
        """The JSON that the option --json of a command asks for, of a run that begins now."""
        head = Head.of(kind, options.command, getattr(options, "timings", kind in TIMED))
        return cls(options.json, head, console, results, what, leave)

    def keep(self) -> None:
        """Write the results so far, unless the last writing was too recent.

        Raises:
            NotFinished: the file cannot be written.
        """
        if self.target not in (None, "-") and (began := time.monotonic()) >= self._next:
            self.write(None, False)
            # Writing takes longer the more results there are; the pause keeps it below a tenth of the run.
            self._next = time.monotonic() + PAUSE * (time.monotonic() - began)

    def __enter__(self) -> Journal:
        return self

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        self.complete = error is None
        if error is not None:
            self.status = of_interruption(error) if isinstance(error, KeyboardInterrupt) else NOT_FINISHED
        try:
            self.leave(self)
        except BaseException:
            self.complete, self.status = False, NOT_FINISHED
            raise
        finally:
            if self.complete or self.what():
                self.write(self.status, self.complete)

    def write(self, status: ExitStatus | None, complete: bool = True) -> None:
        """Write the document; status None for a run in progress.

        Raises:
            NotFinished: the file cannot be written.
        """
        if self.target is not None:
            document = self.head.document(self.results(), status, complete)
            self.console.put(self.target, json_text(document), self.what())
