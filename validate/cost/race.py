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
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from pointcoord import PointcoordError
from pointcoord.errors import visible
from validate.cost.table import Row, Verdict
from validate.cost.way import LeftOut

Clock = Callable[[], int]
"""Nanoseconds since some instant."""
Progress = Callable[[str, int, int], None]
"""Is called before anything is measured: what, how much is done, of how much."""
SEED = 20221122
MOST_LOOPS = 10_000


class NoNumbers(Exception):
    """What a way gives is not what it was asked for: a number that is none, or that is not there."""


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
    racers = [_Racer(runner, effort, clock) for runner in runners]
    steps, collects = len(racers) * (effort.repeats + 1), gc.isenabled()
    gc.disable()
    try:
        with threadpool_limits(limits=1), warnings.catch_warnings():
            # What overflows is seen in the numbers.
            warnings.simplefilter("ignore")
            for i, racer in enumerate(racers):
                progress(racer.words, i, steps)
                racer.attempt(racer.first)
            for number in range(1, effort.repeats + 1):
                gc.collect()
                order = [racer for racer in racers if racer.loops]
                random.Random(f"{SEED} {number}").shuffle(order)
                for racer in order:
                    progress(f"{racer.words}, repeat {number}", len(racers) * number, steps)
                    racer.attempt(racer.repeat)
    finally:
        if collects:
            gc.enable()
    return [row for racer in racers for row in racer.timed()]


@dataclass
class _Racer:
    """A runner in a race.

    Attributes:
        rows: with errors, or the one that says why there are none. loops: runs of a sample; none where there
            is no time for a second run. samples: seconds of the set-up and of the rest.
    """

    runner: Runner
    effort: Effort
    clock: Clock
    rows: list[Row] = field(default_factory=list)
    loops: int = 0
    samples: list[tuple[float, float]] = field(default_factory=list)

    @property
    def words(self) -> str:
        return f"{self.runner.row.scene}: {self.runner.row.way} {self.runner.row.setting}"

    def attempt(self, step: Callable[[], None]) -> None:
        """Go a step; one that breaks down leaves the reason: failed, or that it does not apply."""
        try:
            step()
        except Exception as error:
            known = isinstance(error, PointcoordError | NoNumbers | LeftOut | ImportError)
            verdict: Verdict = "left out" if isinstance(error, LeftOut | ImportError) else "failed"
            why = absent(verdict, str(error) if known else f"{type(error).__name__}: {error}")
            self.rows, self.loops = [replace(self.runner.row, **why)], 0

    def first(self) -> None:
        """The first run, whose answer is looked at, and the second."""
        *first, answer = self._run()
        found = self.runner.found(answer)
        del answer
        gc.collect()
        row = replace(self.runner.row, first=sum(first))
        self.rows = [replace(row, quantity=quantity, **columns) for quantity, columns in found.items()]
        self.samples = [(first[0], first[1])]
        if 2.0 * sum(first) <= self.effort.most:
            seconds = max(sum(self._run()[:2]), 1e-9)
            self.samples = []
            self.loops = min(max(math.ceil(self.effort.least / seconds), 1), MOST_LOOPS)

    def repeat(self) -> None:
        """A sample, if there is time for it: the mean of some runs."""
        took = self.loops * sum(map(sum, self.samples))
        if not self.samples or took * (1.0 + 1.0 / len(self.samples)) <= self.effort.most:
            set_up, rest = np.mean([self._run()[:2] for _ in range(self.loops)], axis=0).tolist()
            self.samples.append((set_up, rest))

    def _run(self) -> tuple[float, float, Any]:
        """Seconds of the set-up and of the rest, and the answer."""
        begun = self.clock()
        run = self.runner.set_up()
        ready = self.clock()
        answer = run()
        return 1e-9 * (ready - begun), 1e-9 * (self.clock() - ready), answer

    def timed(self) -> list[Row]:
        """The rows; median and quartiles of the samples are in every one that has numbers."""
        if not self.samples:
            return self.rows
        set_up, rest = np.transpose(self.samples)
        lower, median, upper = (np.quantile(rest, (0.25, 0.5, 0.75)) / max(self.runner.row.poses, 1)).tolist()
        columns: dict[str, Any] = {"time": median, "lower": lower, "upper": upper, "repeats": len(rest)}
        columns["set_up"] = float(np.median(set_up))
        return [replace(row, **columns) if row.verdict == "measured" else row for row in self.rows]


def absent(verdict: Verdict, reason: str) -> dict[str, Any]:
    """Columns of a row that has no numbers."""
    return {"poses": 0, "verdict": verdict, "reason": visible(" ".join(reason.split()))}
