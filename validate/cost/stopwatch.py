"""How time is measured: jobs in laps, repeated round by round.

A job does its work once and tells a `Laps` where each of its phases ends. All jobs are run once in a round,
and then all again in the next, each round in another order that a fixed seed gives: a machine that is busy
for a while hurts all jobs alike, and no job always runs after the same one. Python's garbage collector runs
before each round and never while a job does. A job that is quicker than a sample should last is repeated
within the sample, with its phases still apart, and the mean of each phase is the sample. Medians and
quartiles are taken over the samples of the rounds.

The clock is read twice at the end of each lap, so that keeping books is in no phase. Reading it takes some
50 ns, and a phase that does nothing shows that.

pyperf, which is the tool for such things, runs each benchmark in processes of its own, one benchmark after
another: it cannot interleave ways, and what a busy machine does to one of them is taken for the way's own
time. Of what pyperf does we keep the warm-up, loops until a sample lasts, a monotonic clock of nanoseconds,
the median, and that no collector runs; instead of several processes there are rounds.
"""

from __future__ import annotations

import gc
import math
import random
import time
from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TypeVar

import numpy as np

from validate.cost.row import Time

Clock = Callable[[], int]
"""Nanoseconds since some instant."""

Name = TypeVar("Name", bound=Hashable)

REPEATS = 9
LEAST_REPEATS = 7
SEED = 20221122
MOST_LOOPS = 10_000


class Laps:
    """Seconds of the phases of a job, summed over its runs."""

    def __init__(self, clock: Clock = time.perf_counter_ns) -> None:
        self._clock = clock
        self._sums: dict[str, int] = {}
        self._mark = clock()

    def start(self) -> None:
        """The next phase begins now; what was done since the last one belongs to none."""
        self._mark = self._clock()

    def lap(self, phase: str) -> None:
        """A phase ends now, and the next begins."""
        now = self._clock()
        self._sums[phase] = self._sums.get(phase, 0) + now - self._mark
        self._mark = self._clock()

    @property
    def seconds(self) -> dict[str, float]:
        """By phase, s."""
        return {phase: 1e-9 * nanoseconds for phase, nanoseconds in self._sums.items()}


Job = Callable[[Laps], object]
"""Work that ends each of its phases with `Laps.lap`."""


def sample(job: Job, loops: int = 1, clock: Clock = time.perf_counter_ns) -> dict[str, float]:
    """Run a job some times and give the mean seconds of each of its phases."""
    with no_garbage_collector():
        laps = Laps(clock)
        for _ in range(loops):
            laps.start()
            job(laps)
        return {phase: seconds / loops for phase, seconds in laps.seconds.items()}


def loops_for(seconds: float, least: float) -> int:
    """How many runs of a job that takes some seconds make a sample of at least that many."""
    if seconds <= 0.0:
        return MOST_LOOPS
    return min(max(math.ceil(least / seconds), 1), MOST_LOOPS)


def round_order(names: Sequence[Name], number: int, seed: int = SEED) -> list[Name]:
    """The order of a round: a shuffle that the seed, the number and how many there are decide."""
    order = list(names)
    random.Random(f"{seed} {number}").shuffle(order)
    return order


def interleaved(
    jobs: Mapping[Name, Job],
    loops: Mapping[Name, int],
    repeats: int = REPEATS,
    clock: Clock = time.perf_counter_ns,
) -> Iterator[tuple[int, Name, dict[str, float]]]:
    """Samples of jobs, a round of all of them after the other.

    Args:
        loops: how many runs of each make a sample.
    Returns:
        The number of the round, the job, and the seconds of its phases in one run.
    """
    for number in range(repeats):
        gc.collect()
        for name in round_order(list(jobs), number):
            yield number, name, sample(jobs[name], loops[name], clock)


def time_of(seconds: Sequence[float]) -> Time:
    """Median and quartiles of samples, the quartiles between two of them in proportion."""
    lower, median, upper = (float(q) for q in np.quantile(seconds, (0.25, 0.5, 0.75)))
    return Time(median, lower, upper, len(seconds))


def times_of(samples: Sequence[Mapping[str, float]]) -> dict[str, Time]:
    """The same of each phase of some samples."""
    phases = dict.fromkeys(phase for one in samples for phase in one)
    return {phase: time_of([one[phase] for one in samples if phase in one]) for phase in phases}


@contextmanager
def no_garbage_collector() -> Iterator[None]:
    """Nothing is collected while this lasts."""
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            gc.enable()
