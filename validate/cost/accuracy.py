"""Error and time of every way with every setting on every scene, as rows.

A scene is measured by all ways together. The first run of each in this process is timed apart; it gives the
numbers whose errors are the row's, and what was done. A second run, whose time is not kept, warms up and
says how many runs make a sample, and whether the way is so slow that it gets fewer instants. Then come the
rounds (see `stopwatch`). Every sample is kept when it is taken, so that a killed run goes on with the next.

A way that refuses a scene, breaks down, or gives a number that is none has a row with its reason and no
times. A wrong number is an error like any other, and stands with its size in the row.
"""

from __future__ import annotations

import gc
import importlib.util
import math
import time
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from pointcoord import PointcoordError, Scene
from pointcoord.errors import visible
from validate.cost.errors import NoNumbers, Truth, errors_of, truth_of
from validate.cost.instants import study_instants
from validate.cost.row import Row, Status, Time
from validate.cost.scenes import StudyScene
from validate.cost.stopwatch import (
    Clock,
    Laps,
    loops_for,
    no_garbage_collector,
    round_order,
    sample,
    times_of,
)
from validate.cost.store import Begun, Key, Store
from validate.cost.way import LeftOut, Ready, Setting, Way
from validate.formulations.protocol import Numbers
from validate.reference import NoReferenceError

Array = NDArray[np.float64]

Progress = Callable[[str, int, int], None]
"""Told before anything is measured: what, how many measurements are done, of how many."""


@dataclass(frozen=True)
class Effort:
    """How much is measured.

    Attributes:
        repeats: samples of each row.
        least: seconds that a sample lasts at least.
        most: seconds that a run should last at most; a way that solves each instant by itself gets fewer of
            them if it takes longer.
        settings: how many of a way's settings are measured at most, the first and the last among them.
    """

    repeats: int
    least: float
    most: float
    settings: int | None


FULL = Effort(repeats=9, least=0.02, most=2.0, settings=None)
QUICK = Effort(repeats=7, least=0.002, most=0.5, settings=3)
FEWEST = 8  # instants that even the slowest way gets


def silent(what: str, done: int, of: int) -> None:
    """Tell nobody."""


def accuracy_rows(
    scenes: Sequence[StudyScene],
    store: Store,
    ways: Sequence[Way],
    *,
    quick: bool = False,
    configurations: int | None = None,
    progress: Progress = silent,
    clock: Clock = time.perf_counter_ns,
) -> tuple[Row, ...]:
    """Measure what the store does not hold yet, by one thread, and give all rows of these scenes and ways.

    Args:
        configurations: at how many instants; as many as the scene has samples, within limits, if None.
    Raises:
        StoreError: the store cannot be written.
    """
    effort = QUICK if quick else FULL
    races = [_Race.of(scene, ways, effort, quick, configurations) for scene in scenes]
    told = _Told(progress, sum(race.steps * len(race.runners) for race in races))
    for race in races:
        # Here as in the processes of the other parts.
        with threadpool_limits(limits=1), warnings.catch_warnings():
            # What overflows in a way is seen in its numbers.
            warnings.simplefilter("ignore")
            race.run(store, told, clock)
    keys = [key for race in races for key in race.runners]
    return tuple(row for key in keys if (row := store.row(key)) is not None)


def chosen_settings(settings: Sequence[Setting], most: int | None) -> tuple[Setting, ...]:
    """Some settings, evenly from the first to the last."""
    if most is None or len(settings) <= most:
        return tuple(settings)
    places = np.linspace(0, len(settings) - 1, most).round().astype(int)
    return tuple(settings[place] for place in places)


def missing(way: Way) -> str:
    """Why a way cannot be had in this installation; empty if it can."""
    if way.package is None or importlib.util.find_spec(way.package) is not None:
        return ""
    return f"needs the package {way.package!r}, which is not installed"


@dataclass
class _Told:
    """Counts what is done, and tells it."""

    progress: Progress
    of: int
    done: int = 0

    def now(self, what: str) -> None:
        """Something is measured now."""
        self.progress(what, self.done, self.of)


@dataclass(frozen=True)
class _Runner:
    """A way with a setting on a scene."""

    way: Way
    setting: Setting
    scene: Scene

    @property
    def words(self) -> str:
        """What is told of it."""
        return f"{self.way.name} {self.setting.words}".rstrip()

    def run(self, instants: Array, laps: Laps) -> tuple[Ready, Any, Numbers]:
        """All phases once."""
        ready = self.way.prepare(self.scene, self.setting)
        laps.lap("set-up")
        solved = ready.solve(instants)
        laps.lap("solve")
        solved = ready.rates(solved)
        laps.lap("rates")
        numbers = ready.output(solved)
        laps.lap("output")
        return ready, solved, numbers

    def seconds(self, instants: Array, clock: Clock) -> float:
        """What all phases take once."""
        return sum(sample(lambda laps: self.run(instants, laps), 1, clock).values())


@dataclass(frozen=True)
class _Race:
    """A scene and all that is measured of it."""

    study: StudyScene
    effort: Effort
    instants: Array
    runners: Mapping[Key, _Runner]

    @classmethod
    def of(
        cls, study: StudyScene, ways: Sequence[Way], effort: Effort, quick: bool, configurations: int | None
    ) -> _Race:
        """What is to be measured of a scene."""
        instants = study_instants(study.scene, configurations, quick=quick)
        instants.setflags(write=False)
        runners = {
            Key(
                part="accuracy",
                scene=study.name,
                digest=study.digest,
                way=way.name,
                setting=setting.words,
                quick=quick,
                configurations=configurations,
            ): _Runner(way, setting, study.scene)
            for way in ways
            for setting in chosen_settings(way.settings, effort.settings)
        }
        return cls(study, effort, instants, runners)

    @property
    def steps(self) -> int:
        """How many measurements a way with a setting is."""
        return self.effort.repeats + 1

    def run(self, store: Store, told: _Told, clock: Clock) -> None:
        """Measure what is not in the store."""
        racing: dict[Key, _Runner] = {}
        truth: Truth | NoReferenceError | None = None
        for key, runner in self.runners.items():
            if store.row(key) is not None:
                told.done += self.steps
                continue
            lacks = missing(runner.way)
            if lacks:
                store.write(key, self._without_numbers(runner, "left out", lacks))
            elif store.begun(key) is None:
                if truth is None:
                    told.now(f"{self.study.name}: the reference")
                    truth = self._truth()
                told.now(f"{self.study.name}: {runner.words}")
                self._begin(key, runner, truth, store, clock)
            else:
                told.now(f"{self.study.name}: {runner.words}")
                self._warm_up(key, runner, store)
            if store.row(key) is None:
                racing[key] = runner
            told.done += 1 if key in racing else self.steps
        self._rounds(racing, store, told, clock)

    def _truth(self) -> Truth | NoReferenceError:
        try:
            return truth_of(self.study.scene, self.instants)
        except NoReferenceError as error:
            return error

    def _begin(
        self, key: Key, runner: _Runner, truth: Truth | NoReferenceError, store: Store, clock: Clock
    ) -> None:
        """The first run, and the one that warms up; the row itself where they show that there is no more."""
        if isinstance(truth, NoReferenceError):
            why = f"there is no reference to hold it to: {truth}"
            store.write(key, self._without_numbers(runner, "failed", why))
            return
        stride = 1
        try:
            row = self._first(runner, truth, self.instants, clock)
            seconds = runner.seconds(self.instants, clock)
            if seconds > self.effort.most and not runner.way.dense:
                stride = max(min(math.ceil(seconds / self.effort.most), len(self.instants) // FEWEST), 1)
            if stride > 1:
                few = self.instants[::stride]
                row = replace(
                    self._first(runner, truth.every(stride), few, clock),
                    reason=f"at {len(few)} of the {len(self.instants)} instants, since all of them take "
                    f"{seconds:.2g} s; its first run, which was of all of them, is not told",
                    times={},
                )
                seconds = runner.seconds(few, clock)
        except Exception as error:
            store.write(key, self._of_error(runner, error))
            return
        store.begin(key, Begun(row, loops_for(seconds, self.effort.least), stride))

    def _first(self, runner: _Runner, truth: Truth, instants: Array, clock: Clock) -> Row:
        """A run with its errors and counts.

        Raises:
            NoNumbers: a number is none, or missing.
        """
        with no_garbage_collector():
            laps = Laps(clock)
            ready, solved, numbers = runner.run(instants, laps)
        seconds = sum(laps.seconds.values())
        errors, not_given = errors_of(numbers, truth)
        return Row(
            part="accuracy",
            scene=self.study.name,
            way=runner.way.name,
            setting=runner.setting.words,
            value=runner.setting.value,
            configurations=len(instants),
            dense=runner.way.dense,
            errors=errors,
            not_given=not_given,
            times={"first": Time(seconds, seconds, seconds, 1)},
            counts={name: int(count) for name, count in ready.counts(solved).items()},
        )

    def _warm_up(self, key: Key, runner: _Runner, store: Store) -> None:
        """Run here what another process began; the row itself if it does not run."""
        begun = store.begun(key)
        try:
            runner.run(self.instants[:: begun.stride if begun else 1], Laps())
        except Exception as error:
            store.write(key, self._of_error(runner, error))

    def _rounds(self, racing: Mapping[Key, _Runner], store: Store, told: _Told, clock: Clock) -> None:
        """All of them once, and all again, until each has its samples."""
        for number in range(self.effort.repeats):
            gc.collect()
            for key in round_order(list(racing), number):
                begun, runner = store.begun(key), racing[key]
                if begun is not None and store.row(key) is None and number not in store.samples(key):
                    told.now(f"{self.study.name}: {runner.words}, repeat {number + 1}")
                    seconds = self._sample(runner, begun, clock)
                    if isinstance(seconds, Exception):
                        store.write(key, self._of_error(runner, seconds))
                    else:
                        store.sample(key, number, seconds)
                told.done += 1
        for key in racing:
            begun = store.begun(key)
            if begun is not None and store.row(key) is None:
                times = times_of([seconds for _, seconds in sorted(store.samples(key).items())])
                store.write(key, replace(begun.row, times={**times, **begun.row.times}))

    def _sample(self, runner: _Runner, begun: Begun, clock: Clock) -> dict[str, float] | Exception:
        instants = self.instants[:: begun.stride]
        try:
            return sample(lambda laps: runner.run(instants, laps), begun.loops, clock)
        except Exception as error:
            return error

    def _of_error(self, runner: _Runner, error: Exception) -> Row:
        """The row of a way that gave no numbers: left out where it does not apply, and else failed."""
        if isinstance(error, LeftOut | ImportError):
            return self._without_numbers(runner, "left out", str(error))
        of_ours = isinstance(error, PointcoordError | NoNumbers)
        what = str(error) if of_ours else f"{type(error).__name__}: {error}"
        return self._without_numbers(runner, "failed", what)

    def _without_numbers(self, runner: _Runner, status: Status, reason: str) -> Row:
        return Row(
            part="accuracy",
            scene=self.study.name,
            way=runner.way.name,
            setting=runner.setting.words,
            value=runner.setting.value,
            status=status,
            reason=visible(" ".join(reason.split())),
            dense=runner.way.dense,
        )
