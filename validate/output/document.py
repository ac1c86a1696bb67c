"""The JSON that the program writes: what was run, where and when, around what came of it.

Its JSON Schema is `schema.json` beside this file, and `pointcoord --schema` prints it.
"""

from __future__ import annotations

import json
import math
import os
import shlex
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import cache
from pathlib import Path
from typing import Any

from validate.exit_status import ExitStatus, of_interruption
from validate.output.console import Console

# Raised by one whenever a key changes its meaning or goes; a new key changes nothing for its readers.
SCHEMA_VERSION = 3
PACKAGES = ("numpy", "scipy", "pin", "mpmath", "python-flint", "mujoco", "exudyn")
# Environment variables that say how many threads the linear algebra takes.
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
# Kinds of runs that hold nothing to anything: times and numbers are neither right nor wrong.
COMPARES_NOTHING = ("cost", "fit", "fit-suspects", "hard-list")
PAUSE = 9.0  # between two writings of a journal, in times that the first took


def program_version() -> str:
    """Version of the installed distribution."""
    return _version("pointcoord") or "not installed"


def _version(distribution: str) -> str | None:
    # Imported here: it takes a third of numpy's time, and most runs write no document.
    from importlib import metadata

    try:
        return metadata.version(distribution)
    except metadata.PackageNotFoundError:
        return None


def code_digest(places: Sequence[str]) -> str:
    """A digest of code and mechanisms: files and folders of this distribution, such as `validate/cost`."""
    import hashlib

    root, digest = Path(__file__).parents[2], hashlib.sha256()
    for place in places:
        top = root / place
        files = [top] if top.is_file() else (f for f in top.rglob("*") if f.suffix in (".py", ".toml"))
        for file in sorted(files):
            digest.update(file.relative_to(root).as_posix().encode() + b"\0" + file.read_bytes() + b"\0")
    return digest.hexdigest()[:12]


def schema_text() -> str:
    """The JSON Schema of every document that the program writes."""
    return Path(__file__).with_name("schema.json").read_text(encoding="utf-8")


@cache
def machine() -> dict[str, Any]:
    """Where the numbers come from: system, processors, versions, and how many threads are allowed."""
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
    """The time as RFC 3339 has it, UTC, to the second."""
    return datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")


@dataclass(frozen=True)
class Head:
    """What is known of a run before it begins.

    Attributes:
        kind: which command's results follow: validate, hard, hard-list, random, bounds, claims, cost, fit or
            fit-suspects.
        command: the command line, word by word.
        started: UTC; None in a run whose results say nothing of times, so that the same run gives the same
            bytes.
    """

    kind: str
    command: tuple[str, ...]
    started: str | None = None

    @classmethod
    def of(cls, kind: str, command: Sequence[str], timed: bool = False) -> Head:
        """The head of a run that begins now."""
        return cls(kind, tuple(command), now() if timed else None)

    def verdict(self, status: ExitStatus) -> str:
        """A status in words."""
        compared = self.kind not in COMPARES_NOTHING or status is not ExitStatus.AGREE
        return status.verdict if compared else "nothing compared"

    def document(
        self, results: Mapping[str, Any], status: ExitStatus | None, complete: bool
    ) -> dict[str, Any]:
        """Everything as plain data; a run that goes on has no status yet."""
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
    """JSON of plain data. It has no infinity and no NaN: a number that does not exist is null."""
    return json.dumps(_plain(data), indent=1, allow_nan=False) + "\n"


def _plain(data: Any) -> Any:
    if isinstance(data, str):
        # A file's name may hold bytes that are no text.
        return data.encode("utf-8", "backslashreplace").decode("utf-8")
    if isinstance(data, float) and not math.isfinite(data):
        return None
    if isinstance(data, Mapping):
        return {_plain(key): _plain(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [_plain(value) for value in data]
    return data


@dataclass
class Ending:
    """How a block ends.

    Attributes:
        status: what the run ends with, as the block sets it if it comes to its end.
        complete: whether it does.
    """

    status: ExitStatus = ExitStatus.AGREE
    complete: bool = False


@contextmanager
def at_the_end(write: Callable[[Ending], None]) -> Iterator[Ending]:
    """Write what there is when the block ends, however it ends.

    Raises:
        BaseException: what `write` raises; else whatever ends the block.
    """
    ending = Ending()
    try:
        yield ending
        ending.complete = True
    except KeyboardInterrupt as error:
        ending.status = of_interruption(error)
        raise
    except BaseException:
        ending.status = ExitStatus.NOT_FINISHED
        raise
    finally:
        write(ending)


@dataclass
class Journal:
    """The JSON of a run, written again as its parts are finished, so that a kill loses next to nothing.

    Standard output takes one document only: it is written at the end.

    Attributes:
        target: the file, - for standard output, None where no JSON is asked for.
        results: all that there is so far, as plain data.
        what: it is, in words; empty as long as there is nothing worth writing.
    """

    target: str | None
    head: Head
    console: Console
    results: Callable[[], Mapping[str, Any]]
    what: Callable[[], str]
    _next: float = 0.0

    def keep(self) -> None:
        """Write what is finished.

        Raises:
            NotFinished: it cannot be written.
        """
        if self.target not in (None, "-") and (began := time.monotonic()) >= self._next:
            self._write(None, False)
            # Writing costs more the more there is: with such pauses it takes at most a tenth of the time.
            self._next = time.monotonic() + PAUSE * (time.monotonic() - began)

    def closing(self) -> AbstractContextManager[Ending]:
        """Write it when a block ends, however it ends, with the status that the block sets.

        Raises:
            NotFinished: it cannot be written; and whatever ends the block.
        """

        def write(ending: Ending) -> None:
            if ending.complete or self.what():
                self._write(ending.status, ending.complete)

        return at_the_end(write)

    def _write(self, status: ExitStatus | None, complete: bool) -> None:
        if self.target is not None:
            document = self.head.document(self.results(), status, complete)
            self.console.put(self.target, json_text(document), self.what())
