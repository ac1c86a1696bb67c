"""What a point of growth does, how it is measured in a process of its own, and what comes back from there."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

from validate.cost.growth.memory import peak, restart_peak
from validate.cost.row import QuantityError, Status, Time
from validate.cost.stopwatch import LEAST_REPEATS, Clock, Laps, loops_for, sample, times_of

SAMPLE = 0.01  # s, that a sample should last at least: a thousand times what the system's scheduler steals


class WrongNumber(Exception):
    """What came out is not what it must be; says where and by how much."""


class Run(Protocol):
    """A task made ready, which is the set-up. Its phases follow each other."""

    def solve(self) -> Any:
        """Find the positions."""
        ...

    def rates(self, solved: Any) -> Any:
        """Add the rates, if any."""
        ...

    def output(self, solved: Any) -> Any:
        """What was computed, as arrays."""
        ...

    def counts(self, solved: Any) -> Mapping[str, int]:
        """What was done."""
        ...


class Task(Protocol):
    """Work of some size. It travels to another process, so it is plain data."""

    @property
    def smallest(self) -> Task:
        """The same work of the least size, which loads all that it needs."""
        ...

    def give(self) -> None:
        """Make what the work is given, which is no part of it, and keep it at hand."""
        ...

    def prepare(self) -> Run:
        """The set-up."""
        ...

    def check(self, output: Any) -> Mapping[str, QuantityError]:
        """Errors against what is known exactly, if anything is.

        Raises:
            WrongNumber: the output is not what it must be.
        """
        ...


@dataclass(frozen=True)
class Measured:
    """What came of a task.

    Attributes:
        status: as of a row. reason: why there are no numbers.
        times, counts, errors, peak_bytes: as of a row.
    """

    status: Status = "measured"
    reason: str = ""
    times: Mapping[str, Time] = field(default_factory=dict)
    counts: Mapping[str, int] = field(default_factory=dict)
    errors: Mapping[str, QuantityError] = field(default_factory=dict)
    peak_bytes: int | None = None


def measure(task: Task, seconds: float, clock: Clock = time.perf_counter_ns) -> Measured:
    """Run a task, once for its memory and its numbers, then again for its times.

    Args:
        seconds: for all repeats together. There are `LEAST_REPEATS` if they fit, or as many as do; the first
            run counts as the only one if no other fits. `Time.repeats` says.
    Raises:
        WrongNumber: a number is not what it must be.
    """
    sample(_Job(task.smallest), clock=clock)
    task.give()
    held = restart_peak()
    job = _Job(task)
    first = sample(job, clock=clock)
    most = peak() - held
    errors = task.check(job.output)
    counts = dict(job.counts)
    job.forget()
    took = sum(first.values())
    samples = [first]
    if 2.0 * took <= seconds:
        loops = loops_for(took, SAMPLE)
        repeats = min(LEAST_REPEATS, int(seconds / max(took * loops, SAMPLE)))
        samples = []
        for _ in range(max(repeats, 1)):
            samples.append(sample(job, loops, clock))
            job.forget()
    return Measured(times=times_of(samples), counts=counts, errors=errors, peak_bytes=max(most, 0))


class _Job:
    """A task in laps; keeps what the last run gave."""

    def __init__(self, task: Task) -> None:
        self.task = task
        self.output: Any = None
        self.counts: Mapping[str, int] = {}

    def __call__(self, laps: Laps) -> None:
        self.forget()
        laps.start()
        run = self.task.prepare()
        laps.lap("set-up")
        solved = run.solve()
        laps.lap("solve")
        solved = run.rates(solved)
        laps.lap("rates")
        self.output = run.output(solved)
        laps.lap("output")
        self.counts = run.counts(solved)

    def forget(self) -> None:
        """Give the memory back, so that two runs are never held at once."""
        self.output = None
