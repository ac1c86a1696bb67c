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
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from pointcoord import PointcoordError
from pointcoord.errors import visible
from validate.cost.row import Row, Verdict

Clock = Callable[[], int]
"""Nanoseconds since some instant."""
Progress = Callable[[str, int, int], None]
"""Is called before anything is measured: what, how much is done, of how much."""
SEED = 20221122
MOST_LOOPS = 10_000


class LeftOut(Exception):
    """A way does not apply to a scene, as the paper's formulas not to a double wishbone; says why."""


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


@dataclass(frozen=True)
class Found:
    """Columns of a row by quantity, what is not given and why, and what the run did."""

    quantities: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    not_given: Mapping[str, str] = field(default_factory=dict)
    work: str = ""


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
    rows: dict[int, list[Row]] = {}
    loops: dict[int, int] = {}
    samples: dict[int, list[tuple[float, float]]] = {}
    steps = len(runners) * (effort.repeats + 1)
    with threadpool_limits(limits=1), warnings.catch_warnings():
        # What overflows is seen in the numbers.
        warnings.simplefilter("ignore")
        for i, runner in enumerate(runners):
            progress(_words(runner.row), i, steps)
            try:
                with no_garbage_collector():
                    *first, answer = _run(runner, clock)
                found = runner.found(answer)
                del answer
                rows[i] = [replace(row, first=sum(first)) for row in _rows(runner.row, found)]
                samples[i] = [(first[0], first[1])]
                if 2.0 * sum(first) <= effort.most:
                    samples[i] = []
                    seconds = max(sum(_sample(runner, 1, clock)), 1e-9)
                    loops[i] = min(max(math.ceil(effort.least / seconds), 1), MOST_LOOPS)
            except Exception as error:
                rows[i] = [_without_numbers(runner.row, error)]
        for number in range(effort.repeats):
            gc.collect()
            for i in order_of_round(list(loops), number):
                progress(f"{_words(runners[i].row)}, repeat {number + 1}", len(runners) * (number + 1), steps)
                took = loops[i] * sum(map(sum, samples[i]))
                if samples[i] and took * (1.0 + 1.0 / len(samples[i])) > effort.most:
                    continue
                try:
                    samples[i].append(_sample(runners[i], loops[i], clock))
                except Exception as error:
                    rows[i] = [_without_numbers(runners[i].row, error)]
                    del loops[i]
    return [row for i in rows for row in (_timed(rows[i], samples[i]) if samples.get(i) else rows[i])]


def order_of_round(names: Sequence[int], number: int) -> list[int]:
    """A shuffle that the seed, the number of the round and how many there are decide."""
    order = list(names)
    random.Random(f"{SEED} {number}").shuffle(order)
    return order


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


def _run(runner: Runner, clock: Clock) -> tuple[float, float, Any]:
    """Seconds of the set-up and of the rest, and the answer."""
    begun = clock()
    run = runner.set_up()
    ready = clock()
    answer = run()
    return 1e-9 * (ready - begun), 1e-9 * (clock() - ready), answer


def _sample(runner: Runner, loops: int, clock: Clock) -> tuple[float, float]:
    """The same, means of some runs."""
    with no_garbage_collector():
        times = [_run(runner, clock)[:2] for _ in range(loops)]
    set_up, rest = (sum(each) / loops for each in zip(*times, strict=True))
    return set_up, rest


def _rows(row: Row, found: Found) -> list[Row]:
    return [
        *(replace(row, quantity=q, work=found.work, **columns) for q, columns in found.quantities.items()),
        *(
            replace(row, quantity=quantity, poses=0, verdict="left out", reason=reason)
            for quantity, reason in found.not_given.items()
        ),
    ]


def _timed(rows: Sequence[Row], samples: Sequence[tuple[float, float]]) -> list[Row]:
    """Median and quartiles of the samples, in every row that has numbers."""
    poses = max(rows[0].poses, 1)
    lower, median, upper = (float(q) / poses for q in np.quantile([s[1] for s in samples], (0.25, 0.5, 0.75)))
    set_up, count = float(np.median([s[0] for s in samples])), len(samples)
    return [
        replace(row, time=median, lower=lower, upper=upper, repeats=count, set_up=set_up)
        if row.verdict == "measured"
        else row
        for row in rows
    ]


def _without_numbers(row: Row, error: Exception) -> Row:
    """The row of a run that gave no numbers: left out where it does not apply, and else failed."""
    said = str(error)
    if not isinstance(error, PointcoordError | NoNumbers | LeftOut | ImportError):
        said = f"{type(error).__name__}: {said}"
    verdict: Verdict = "left out" if isinstance(error, LeftOut | ImportError) else "failed"
    return replace(row, poses=0, verdict=verdict, reason=visible(" ".join(said.split())))


def _words(row: Row) -> str:
    return " ".join(word for word in (f"{row.scene}:" if row.scene else "", row.way, row.setting) if word)
