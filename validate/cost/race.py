"""A race: several runs timed in rounds, so that their times can be compared.

Each round runs all of them once, in a random order from a fixed seed. So a busy machine slows all alike, and
no run always follows the same other one. Ratios hold for one process: a race that was stopped is repeated as
a whole. Python's garbage collector runs before each round and never while something is timed; numerical
libraries use one thread. A run shorter than the least length of a sample is repeated within the sample, which
is the mean.

The first run is timed separately; its numbers give the errors of the row. The second run warms up, and its
time sets the number of runs in a sample. A run that is refused, fails, or gives a number that is not finite
has a row with the reason and no time. A wrong number is not a failure: its error is in the row.
"""

from __future__ import annotations

import gc
import math
import random
import time
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from pointcoord import PointcoordError
from pointcoord.errors import visible
from validate.cost.table import Row, Verdict
from validate.errors import NoAnswer

Clock = Callable[[], int]
"""Returns nanoseconds since some instant."""
Progress = Callable[[str, int, int], None]
"""Called before each run, with the name of the run, the number of runs done, and the total number."""
SEED = 20221122
MOST_LOOPS = 10_000


@dataclass(frozen=True)
class Effort:
    """How much is measured.

    Attributes:
        repeats: number of samples of each run.
        least: least length of a sample, s.
        most: time limit for all samples of a run together, s. A slow run gets fewer samples; if two runs
            exceed the limit, it gets only its first run.
    """

    repeats: int = 9
    least: float = 0.02
    most: float = 20.0


FULL, QUICK = Effort(), Effort(repeats=5, least=0.002, most=4.0)


Found = dict[str, Mapping[str, Any]]
"""Columns of the rows, by quantity."""


@dataclass(frozen=True)
class Runner:
    """A run to be timed.

    Attributes:
        row: the columns that its rows have in common.
        set_up: prepares the run and returns the function that gives the answer.
        found: evaluates the first answer; not timed.
    """

    row: Row
    set_up: Callable[[], Callable[[], Any]]
    found: Callable[[Any], Found]


def silent(what: str, done: int, of: int) -> None:
    """Report no progress."""


def race(
    runners: Sequence[Runner],
    effort: Effort,
    progress: Progress = silent,
    clock: Clock = time.perf_counter_ns,
) -> list[Row]:
    """Time all runners against each other; returns their rows in the order of the runners."""
    courses = [_course(runner, effort, clock) for runner in runners]
    rows: list[list[Row]] = [[] for _ in runners]
    steps, collects = len(runners) * (effort.repeats + 1), gc.isenabled()
    gc.disable()
    try:
        with threadpool_limits(limits=1), warnings.catch_warnings():
            # An overflow shows in the numbers.
            warnings.simplefilter("ignore")
            for number in range(effort.repeats + 1):
                gc.collect()
                order = list(range(len(runners)))
                if number:
                    random.Random(f"{SEED} {number}").shuffle(order)
                for done, i in enumerate(order, number * len(runners)):
                    row = runners[i].row
                    progress(f"{row.scene}: {row.way} {row.setting}, run {number + 1}", done, steps)
                    try:
                        rows[i] = next(courses[i], rows[i])
                    except Exception as error:
                        rows[i] = [replace(row, **_broken(error))]
    finally:
        if collects:
            gc.enable()
    return [row for of in rows for row in of]


def _course(runner: Runner, effort: Effort, clock: Clock) -> Iterator[list[Row]]:
    """Yield the rows of a runner after its first two runs, and again after each sample in the time limit."""

    def run() -> tuple[tuple[float, float], Any]:
        """Times of the set-up and of the run, s, and the answer."""
        begun = clock()
        solve = runner.set_up()
        ready = clock()
        answer = solve()
        return (1e-9 * (ready - begun), 1e-9 * (clock() - ready)), answer

    took, answer = run()
    found = runner.found(answer)
    del answer
    gc.collect()
    row, samples, loops = runner.row, [took], 0
    if 2.0 * sum(took) <= effort.most:
        seconds = max(sum(run()[0]), 1e-9)
        samples, loops = [], min(max(math.ceil(effort.least / seconds), 1), MOST_LOOPS)
    yield _rows(row, found, samples)
    while loops and sum(map(sum, samples)) * loops * (1.0 + 1.0 / max(len(samples), 1)) <= effort.most:
        set_up, rest = np.mean([run()[0] for _ in range(loops)], axis=0).tolist()
        samples.append((set_up, rest))
        yield _rows(row, found, samples)


def _rows(row: Row, found: Found, samples: Sequence[tuple[float, float]]) -> list[Row]:
    """A row for each quantity, with the median and the quartiles of the samples if it was measured."""
    times: dict[str, Any] = {}
    if samples:
        set_up, rest = np.transpose(samples)
        lower, median, upper = (np.quantile(rest, (0.25, 0.5, 0.75)) / max(row.poses, 1)).tolist()
        times = {"time": median, "lower": lower, "upper": upper, "repeats": len(rest)}
        times["set_up"] = float(np.median(set_up))
    return [
        replace(row, quantity=quantity, **({} if "verdict" in columns else times), **columns)
        for quantity, columns in found.items()
    ]


def _broken(error: Exception) -> dict[str, Any]:
    """Columns of a row for an exception: failed, or left out if a package is missing."""
    known = isinstance(error, PointcoordError | NoAnswer | ImportError)
    verdict: Verdict = "left out" if isinstance(error, ImportError) else "failed"
    return absent(verdict, str(error) if known else f"{type(error).__name__}: {error}")


def absent(verdict: Verdict, reason: str) -> dict[str, Any]:
    """Columns of a row without numbers."""
    return {"poses": 0, "verdict": verdict, "reason": visible(" ".join(reason.split()))}
