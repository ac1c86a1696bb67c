"""A size of something that grows, timed with its peak of memory in a fresh process: none hurts another.

The least size runs first, so that what loading takes is held before; then the system's record of the peak is
started anew. A process that dies is a failed row with the reason.
"""

from __future__ import annotations

import os
import resource
import signal
import sys
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from validate.cost.race import Effort, Found, Runner, absent, race
from validate.cost.table import Row

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


def measure_apart(make: Make, least: int, row: Row, limits: Limits) -> list[Row]:
    """The rows of a row's size, measured in a process of its own.

    Args:
        least: the size that loads all that the work needs.
    """
    spawn = get_context("spawn")
    ours, theirs = spawn.Pipe(duplex=False)
    child = spawn.Process(target=_answer, args=(theirs, make, least, row, limits), daemon=True)
    child.start()
    theirs.close()
    # One run may take some times what was foreseen.
    patience = 5.0 * limits.seconds + GRACE
    how = f"was ended after {patience:.0f} s"
    try:
        if ours.poll(patience):
            rows: list[Row] = ours.recv()
            return rows
    except EOFError:
        child.join()
        how = _ended(child.exitcode or 0)
    finally:
        child.kill()
        child.join()
        ours.close()
    return [replace(row, **absent("failed", f"its process {how}"))]


def _ended(status: int) -> str:
    """How a process ended that gave no answer."""
    if status >= 0:
        return f"ended with status {status}"
    name = signal.Signals(-status).name
    return f"was ended by the signal {name}{', as a system out of memory does' * (name == 'SIGKILL')}"


def _answer(answer: Connection, make: Make, least: int, row: Row, limits: Limits) -> None:
    # What libraries print must not come among what this program prints.
    os.dup2(2, 1)
    held = _of_status("VmSize")
    if held is not None:  # beyond this the process gets a MemoryError
        _, hard = resource.getrlimit(resource.RLIMIT_AS)
        resource.setrlimit(resource.RLIMIT_AS, (held + limits.memory, hard))
    answer.send(_measured(make, least, row, limits))


def _measured(make: Make, least: int, row: Row, limits: Limits) -> list[Row]:
    """The rows in this process, with the peak of the first run."""
    race([make(row, least)], Effort(repeats=0))
    runner = make(row, row.size or 0)
    with suppress(OSError):
        CLEAR.write_text(RESTART_PEAK)
    held, most = _peak(), [0]

    def found(one: Any) -> Found:
        most[0] = max(_peak() - held, 0)
        return runner.found(one)

    rows = race([replace(runner, found=found)], Effort(repeats=7, least=0.01, most=limits.seconds))
    return [replace(one, peak_bytes=most[0]) if one.verdict == "measured" else one for one in rows]


def _peak() -> int:
    """The most memory that was resident since the peak was started anew, bytes."""
    largest = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return _of_status("VmHWM") or (largest if sys.platform == "darwin" else 1024 * largest)


def _of_status(name: str) -> int | None:
    """A line of what Linux says of this process, bytes; None elsewhere."""
    with suppress(OSError):
        for line in STATUS.read_text(encoding="ascii", errors="replace").splitlines():
            if line.startswith(f"{name}:"):
                return 1024 * int(line.split()[1])
    return None
