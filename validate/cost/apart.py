"""A size of something that grows, timed with its peak of memory in a fresh process: none hurts another.

The least size runs first, so that what loading takes is held before; then the system's record of the peak
is started anew. A process that dies is a failed row with the reason. Memory is measured and limited on
Linux only.
"""

from __future__ import annotations

import os
import resource
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
    patience = 5.0 * limits.seconds + GRACE  # one run may take some times what was foreseen
    how = f"was ended after {patience:.0f} s"
    try:
        if ours.poll(patience):
            rows: list[Row] = ours.recv()
            return rows
    except EOFError:
        child.join()
        how = f"ended with status {child.exitcode}; -9 is that of a system out of memory"
    finally:
        child.kill()
        child.join()
        ours.close()
    return [replace(row, **absent("failed", f"its process {how}"))]


def _answer(answer: Connection, make: Make, least: int, row: Row, limits: Limits) -> None:
    # What libraries print must not come among what this program prints.
    os.dup2(2, 1)
    if (held := _of_status("VmSize")) is not None:  # beyond this the process gets a MemoryError
        _, hard = resource.getrlimit(resource.RLIMIT_AS)
        resource.setrlimit(resource.RLIMIT_AS, (held + limits.memory, hard))
    race([make(row, least)], Effort(repeats=0))
    runner, peaks = make(row, row.size or 0), list[int]()
    with suppress(OSError):
        CLEAR.write_text(RESTART_PEAK)
    held = _of_status("VmHWM")

    def found(one: Any) -> Found:
        if held is not None:
            peaks.append(max((_of_status("VmHWM") or 0) - held, 0))
        return runner.found(one)

    rows = race([replace(runner, found=found)], Effort(repeats=7, least=0.01, most=limits.seconds))
    peak = peaks[0] if peaks else None
    answer.send([replace(one, peak_bytes=peak) if one.verdict == "measured" else one for one in rows])


def _of_status(name: str) -> int | None:
    """A line of what Linux says of this process, bytes; None elsewhere."""
    with suppress(OSError):
        for line in STATUS.read_text(encoding="ascii", errors="replace").splitlines():
            if line.startswith(f"{name}:"):
                return 1024 * int(line.split()[1])
    return None
