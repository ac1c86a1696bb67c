"""A race: several runs timed in rounds, so that their times compare.

All are run once in a round, and all again in the next, each round in another order that a fixed seed gives: a
machine that is busy for a while hurts all alike, and no run always comes after the same one. So ratios are
those of one process, and a race that was stopped is run again as a whole. Python's garbage collector runs
before each round and never while something is timed; numerical libraries take one thread. What is quicker
than a sample should last is repeated within the sample, and the mean is the sample.

The first run of each is timed apart; it gives the numbers, whose errors are the row's. The second warms up
and says how many runs make a sample. What refuses, breaks down, or gives a number that is none has a row with
its reason and no time; a wrong number is an error like any other, and stands with its size in the row.
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
"""Nanoseconds since some instant."""
Progress = Callable[[str, int, int], None]
"""Is called before anything is measured: what, how much is done, of how much."""
SEED = 20221122
MOST_LOOPS = 10_000


@dataclass(frozen=True)
class Effort:
    """How much is measured.

    Attributes:
        repeats: samples of each run. least: seconds that a sample lasts at least.
        most: seconds for all samples of a run together; it gets fewer where they take longer, and only its
            first run where two take longer.
    """

    repeats: int = 9
    least: float = 0.02
    most: float = 20.0


FULL, QUICK = Effort(), Effort(repeats=5, least=0.002, most=4.0)


Found = dict[str, Mapping[str, Any]]
"""Columns of a row for each quantity."""


@dataclass(frozen=True)
class Runner:
    """Something to be timed.

    Attributes:
        row: what its rows have in common.
        set_up: makes ready, and gives what is to be run; that gives an answer.
        found: looks at the first answer; not timed.
    """

    row: Row
    set_up: Callable[[], Callable[[], Any]]
    found: Callable[[Any], Found]


def silent(what: str, done: int, of: int) -> None:
    """Tell nobody."""


def race(
    runners: Sequence[Runner],
    effort: Effort,
    progress: Progress = silent,
    clock: Clock = time.perf_counter_ns,
) -> list[Row]:
    """Run all of them against each other, and give their rows in their order."""
    courses = [_course(runner, effort, clock) for runner in runners]
    rows: list[list[Row]] = [[] for _ in runners]
    steps, collects = len(runners) * (effort.repeats + 1), gc.isenabled()
    gc.disable()
    try:
        with threadpool_limits(limits=1), warnings.catch_warnings():
            # What overflows is seen in the numbers.
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
    """The rows of a runner after its first two runs, and again after each sample that there is time for."""

    def run() -> tuple[tuple[float, float], Any]:
        """Seconds of the set-up and of the rest, and the answer."""
        begun = clock()
        solve = runner.set_up()
        ready = clock()
        answer = solve()
        return (1e-9 * (ready - begun), 1e-9 * (clock() - ready)), answer

    took, answer = run()
    found = runner.found(answer)
    del answer
    gc.collect()
    row, samples, loops = replace(runner.row, first=sum(took)), [took], 0
    if 2.0 * sum(took) <= effort.most:
        seconds = max(sum(run()[0]), 1e-9)
        samples, loops = [], min(max(math.ceil(effort.least / seconds), 1), MOST_LOOPS)
    yield _rows(row, found, samples)
    while loops and sum(map(sum, samples)) * loops * (1.0 + 1.0 / max(len(samples), 1)) <= effort.most:
        set_up, rest = np.mean([run()[0] for _ in range(loops)], axis=0).tolist()
        samples.append((set_up, rest))
        yield _rows(row, found, samples)


def _rows(row: Row, found: Found, samples: Sequence[tuple[float, float]]) -> list[Row]:
    """A row for each quantity, with median and quartiles of the samples where it has numbers."""
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
    """Columns of a row of what breaks down: failed, or that its package is not there."""
    known = isinstance(error, PointcoordError | NoAnswer | ImportError)
    verdict: Verdict = "left out" if isinstance(error, ImportError) else "failed"
    return absent(verdict, str(error) if known else f"{type(error).__name__}: {error}")


def absent(verdict: Verdict, reason: str) -> dict[str, Any]:
    """Columns of a row that has no numbers."""
    return {"poses": 0, "verdict": verdict, "reason": visible(" ".join(reason.split()))}
