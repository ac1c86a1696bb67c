"""A task in a fresh process, so that points do not hurt each other: its numbers come back as JSON.

A process that dies is a failed point with the reason.
"""

from __future__ import annotations

import json
import os
import pickle
import signal
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import validate
from pointcoord import PointcoordError
from validate.cost.errors import NoNumbers
from validate.cost.growth.memory import limit_memory
from validate.cost.growth.task import Measured, Task, WrongNumber, measure
from validate.cost.row import QuantityError, Time
from validate.cost.store import THREADS
from validate.cost.way import LeftOut

PROGRAM = "from validate.cost.growth.child import answer; answer()"
# Beyond what the point itself may take: Python, imports, the check of the numbers.
GRACE = 60.0


@dataclass(frozen=True)
class Limits:
    """What one point may take.

    Attributes:
        seconds: for one run, and for all its repeats together as far as there is more than one.
        memory: bytes above what the process holds before.
    """

    seconds: float = 20.0
    memory: int = 8 * 2**30

    @property
    def patience(self) -> float:
        """After how many seconds a process is ended: one run may take some times what was foreseen."""
        return 5.0 * self.seconds + GRACE


def measure_apart(task: Task, limits: Limits) -> Measured:
    """Measure a task in a process of its own, with one thread."""
    source = str(Path(validate.__file__).parents[1])
    path = os.pathsep.join(filter(None, (source, os.environ.get("PYTHONPATH"))))
    try:
        done = subprocess.run(
            [sys.executable, "-c", PROGRAM],
            input=pickle.dumps((task, limits)),
            capture_output=True,
            timeout=limits.patience,
            env={**os.environ, **dict.fromkeys(THREADS, "1"), "PYTHONPATH": path},
            check=False,
        )
    except subprocess.TimeoutExpired:
        return Measured("failed", f"was ended after {limits.patience:.0f} s")
    if done.returncode < 0:
        number = -done.returncode
        name = signal.Signals(number).name if number in set(signal.Signals) else str(number)
        hint = ", as a system out of memory does" if number == signal.SIGKILL else ""
        return Measured("failed", f"its process was ended by the signal {name}{hint}")
    try:
        return _measured(json.loads(done.stdout))
    except (ValueError, KeyError, TypeError):
        lines = done.stderr.decode(errors="replace").strip().splitlines()
        last = f": {lines[-1]}" if lines else ""
        return Measured("failed", f"its process ended with status {done.returncode} and no answer{last}")


def answer() -> None:
    """In the process: measure the task that standard input brings, and write what comes of it."""
    # What libraries print must not mix with the answer.
    out = os.dup(1)
    os.dup2(2, 1)
    task, limits = pickle.load(sys.stdin.buffer)
    limit_memory(limits.memory)
    text = json.dumps(asdict(_outcome(task, limits)), allow_nan=False)
    with open(out, "w", encoding="utf-8") as stream:
        stream.write(text)


def _outcome(task: Task, limits: Limits) -> Measured:
    try:
        return measure(task, limits.seconds)
    except (LeftOut, ImportError) as reason:
        return Measured("left out", str(reason))
    except MemoryError:
        return Measured("failed", f"needs more memory than the {limits.memory / 2**30:g} GiB allowed")
    except (PointcoordError, NoNumbers, WrongNumber) as error:
        return Measured("failed", str(error))
    except Exception as error:  # whatever a way fails with is its row's reason
        return Measured("failed", f"{type(error).__name__}: {error}")


def _measured(content: Mapping[str, Any]) -> Measured:
    times = {name: Time(**time) for name, time in content["times"].items()}
    errors = {name: QuantityError(**error) for name, error in content["errors"].items()}
    return Measured(**{**content, "times": times, "errors": errors})
