"""A size of something that grows, timed with its peak of memory in a fresh process: none hurts another.

The system's own record of a process' peak starts with what the process that started it held, and counts
what imports held and gave back; so the least size runs first, and then the peak is started anew where the
system can do that. A process that dies is a failed row with the reason.
"""

from __future__ import annotations

import os
import pickle
import resource
import signal
import subprocess
import sys
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import validate
from validate.cost.race import Effort, Found, Runner, absent, race
from validate.cost.table import Row

PROGRAM = "from validate.cost.apart import answer; answer()"
THREADS = ("OPENBLAS", "OMP", "MKL", "NUMEXPR")
GRACE = 60.0  # s, beyond what the runs may take: Python, imports, the check of the numbers
STATUS, CLEAR = Path("/proc/self/status"), Path("/proc/self/clear_refs")
RESTART_PEAK = "5"  # proc(5): the peak of resident memory becomes what is resident now


Make = Callable[[Row, int], Runner]
"""What is timed of a row's work at a size; it travels to another process, so it is a function of a module, or
a partial of one. What is given to the run is made here, and is no part of it."""


@dataclass(frozen=True)
class Limits:
    """What one size may take.

    Attributes:
        seconds: for one run, and for all its repeats together as far as there is more than one.
        memory: bytes above what the process holds before.
    """

    seconds: float = 20.0
    memory: int = 8 * 2**30


class NotRun(Exception):
    """A process did not do what it was started for; says how it ended, and its last line."""


def measure_apart(make: Make, least: int, row: Row, limits: Limits) -> list[Row]:
    """The rows of a row's size, measured in a process of its own, by one thread.

    Args:
        least: the size that loads all that the work needs.
    """
    given = pickle.dumps((make, least, row, limits))
    try:
        # One run may take some times what was foreseen.
        found = run_python("-c", PROGRAM, given=given, patience=5.0 * limits.seconds + GRACE)
        rows: list[Row] = pickle.loads(found)
        return rows
    except NotRun as error:
        reason = str(error)
    except (EOFError, pickle.UnpicklingError):
        reason = "ended without an answer"
    return [replace(row, **absent("failed", f"its process {reason}"))]


def run_python(*words: str, given: bytes = b"", patience: float = 300.0) -> bytes:
    """What Python writes, run to its end by one thread, with this package first on its path.

    Args:
        given: its standard input. patience: s.
    Raises:
        NotRun: it failed.
    """
    source = str(Path(validate.__file__).parents[1])
    path = os.pathsep.join(filter(None, (source, os.environ.get("PYTHONPATH"))))
    threads = {f"{name}_NUM_THREADS": "1" for name in THREADS}
    try:
        done = subprocess.run(
            [sys.executable, *words],
            input=given,
            capture_output=True,
            timeout=patience,
            env={**os.environ, **threads, "PYTHONPATH": path},
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise NotRun(f"was ended after {patience:.0f} s") from None
    if done.returncode < 0:
        name = signal.Signals(-done.returncode).name
        hint = ", as a system out of memory does" if name == "SIGKILL" else ""
        raise NotRun(f"was ended by the signal {name}{hint}")
    if done.returncode:
        said = done.stderr.decode(errors="replace").strip().splitlines()
        raise NotRun(f"ended with status {done.returncode}{': ' + said[-1] if said else ''}")
    return done.stdout


def answer() -> None:
    """In the process: measure what standard input brings, and write its rows."""
    # What libraries print must not mix with the answer.
    out = os.dup(1)
    os.dup2(2, 1)
    make, least, row, limits = pickle.load(sys.stdin.buffer)
    limit_memory(limits.memory)
    rows = measured(make, least, row, limits)
    with open(out, "wb") as stream:
        pickle.dump(rows, stream)


def measured(make: Make, least: int, row: Row, limits: Limits) -> list[Row]:
    """The rows in this process, with the peak of the first run."""
    race([make(row, least)], Effort(repeats=0))
    runner = make(row, row.size or 0)
    held = restart_peak()
    most = [0]

    def found(one: Any) -> Found:
        most[0] = max(peak() - held, 0)
        return runner.found(one)

    rows = race([replace(runner, found=found)], Effort(repeats=7, least=0.01, most=limits.seconds))
    return [replace(one, peak_bytes=most[0]) if one.verdict == "measured" else one for one in rows]


def restart_peak() -> int:
    """Start the peak anew where the system can, and return it, bytes."""
    with suppress(OSError):
        CLEAR.write_text(RESTART_PEAK)
    return peak()


def peak() -> int:
    """The most memory that was resident since `restart_peak`, or else since the process began, bytes."""
    found = _of_status("VmHWM")
    if found is not None:
        return found
    largest = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return largest if sys.platform == "darwin" else 1024 * largest


def limit_memory(more: int) -> None:
    """Let this process have so many bytes more than it has; beyond, it gets a MemoryError.

    Does nothing where the system does not say what a process has.
    """
    held = _of_status("VmSize")
    if held is not None:
        _, hard = resource.getrlimit(resource.RLIMIT_AS)
        resource.setrlimit(resource.RLIMIT_AS, (held + more, hard))


def _of_status(name: str) -> int | None:
    """A line of what Linux says of this process, bytes; None elsewhere."""
    try:
        lines = STATUS.read_text(encoding="ascii", errors="replace").splitlines()
    except OSError:
        return None
    return next((1024 * int(line.split()[1]) for line in lines if line.startswith(f"{name}:")), None)
