"""Memory of this process: its peak since a moment, and a limit.

The system's own record of a process' peak starts with what the process that started it held, and counts
what imports held and gave back. So the peak is started anew where the system can do that.
"""

from __future__ import annotations

import resource
import sys
from pathlib import Path

STATUS = Path("/proc/self/status")
CLEAR = Path("/proc/self/clear_refs")
RESTART_PEAK = "5"  # proc(5): the peak of resident memory becomes what is resident now


def restart_peak() -> int:
    """Start the peak anew where the system can, and return it, bytes."""
    try:
        CLEAR.write_text(RESTART_PEAK)
    except OSError:
        return peak()
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
    for line in lines:
        key, _, value = line.partition(":")
        if key == name:
            return 1024 * int(value.split()[0])
    return None
