"""What each effect costs: a solved scene read at many instants with none, with each alone and with all.

A scene is solved once for each choice of effects; what is measured is reading the motion at any instants, the
phase `read`, into arrays that are there already. Beside it, in the same rounds, stands a copy of the same
bytes, the phase `copy`: less than that nothing can take that fills such arrays. What an effect costs where it
is not asked for is shown by `sums alone`: the same positions, summed from the series by a loop that knows of
no effects. Both rates of all points are read together too, because positions alone are compared with that.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from pointcoord import Motion, PointcoordError, Scene, simulate
from pointcoord.effects.registry import EFFECTS
from pointcoord.errors import visible
from pointcoord.results.even_instants import even_instants
from pointcoord.results.readout import BLOCK
from validate.cost.accuracy import Progress, silent
from validate.cost.row import NO_EFFECT, Row
from validate.cost.scenes import StudyScene
from validate.cost.stopwatch import (
    LEAST_REPEATS,
    REPEATS,
    Clock,
    Job,
    Laps,
    interleaved,
    loops_for,
    sample,
    times_of,
)
from validate.cost.store import Key, Store

Array = NDArray[np.float64]

INSTANTS, INSTANTS_QUICK = 100_000, 10_000
LEAST = 0.02  # s, of a sample
WAY = "series"

SUMS, RATES, ALL = "sums alone", "both rates of points", "all effects"
POINT_STATES = tuple(name for name, effect in EFFECTS.items() if effect.reports_states)
CHOICES: dict[str, tuple[str, ...]] = {
    SUMS: (),
    NO_EFFECT: (),
    **{name: (name,) for name in EFFECTS},
    RATES: POINT_STATES,
    ALL: tuple(EFFECTS),
}
"""Which effects are asked for, by what a row says of it."""


@dataclass(frozen=True)
class Reading:
    """A motion to be read at instants, (N,), s, into an array that is there.

    Attributes:
        bare: whether no effect is looked at, not even those that are not asked for.
    """

    motion: Motion
    instants: Array
    bare: bool = False

    def job(self, out: Array, other: Array) -> Job:
        """Reads and copies, a phase each.

        Args:
            out, other: arrays of at least as many rows as there are numbers, (rows, N).
        """
        rows, copied = out[: self.motion.height], other[: self.motion.height]

        def read(laps: Laps) -> None:
            if self.bare:
                self._sum(rows)
            else:
                self.motion.at(self.instants, out=rows)
            laps.lap("read")
            np.copyto(copied, rows)
            laps.lap("copy")

        return read

    def _sum(self, rows: Array) -> None:
        """The positions from the series, and the user's origin added."""
        solved = self.motion.solved
        for low in range(0, len(self.instants), BLOCK):
            times, block = self.instants[low : low + BLOCK], rows[:, low : low + BLOCK]
            solved.states.states(times, block)
            offset = solved.readout.added(times)[0]
            if offset is not None:
                triples = block.reshape(len(block) // 3, 3, len(times))
                triples += np.broadcast_to(offset, (len(times), 3)).T


def measure_effects(
    store: Store,
    scenes: Sequence[StudyScene],
    quick: bool = False,
    progress: Progress = silent,
    *,
    instants: int | None = None,
    clock: Clock = time.perf_counter_ns,
) -> tuple[Row, ...]:
    """Measure what the store does not hold yet, by one thread, and give all rows of effects.

    Args:
        instants: how many, if not what `quick` says.
    Raises:
        StoreError: the store cannot be written.
    """
    count = instants or (INSTANTS_QUICK if quick else INSTANTS)
    found: list[Row] = []
    for number, study in enumerate(scenes):
        keys = {choice: _key(study, choice, quick, count) for choice in CHOICES}
        # Ratios are of one run: a scene is measured whole.
        if any(store.row(key) is None for key in keys.values()):
            progress(f"effects: {study.name}", number, len(scenes))
            # Here as in the other parts.
            with threadpool_limits(limits=1):
                measured = _measured(study, count, quick, clock)
            for choice, row in measured.items():
                store.write(keys[choice], row)
        found += [row for row in map(store.row, keys.values()) if row is not None]
    return tuple(found)


def _key(study: StudyScene, choice: str, quick: bool, count: int) -> Key:
    return Key("effects", study.name, study.digest, WAY, choice, quick=quick, configurations=count)


def _measured(study: StudyScene, count: int, quick: bool, clock: Clock) -> dict[str, Row]:
    """A row for each choice of effects, all measured in the same rounds."""
    readings: dict[str, Reading] = {}
    rows: dict[str, Row] = {}
    for choice, effects in CHOICES.items():
        row = Row("effects", study.name, WAY, choice, configurations=count, dense=True)
        try:
            readings[choice] = _reading(study.scene, effects, count, choice == SUMS)
        except PointcoordError as error:
            rows[choice] = replace(row, status="failed", reason=visible(str(error)))
            continue
        work = readings[choice].motion.work
        counts = {
            "derivatives": work.derivatives_evaluated,
            "sums": work.coordinates_evaluated,
            "numbers": readings[choice].motion.height,
        }
        rows[choice] = replace(row, counts=counts)
    if not readings:
        return rows
    highest = max(reading.motion.height for reading in readings.values())
    out, other = (np.zeros((highest, count)) for _ in range(2))
    jobs = {choice: reading.job(out, other) for choice, reading in readings.items()}
    first = {choice: sum(sample(job, 1, clock).values()) for choice, job in jobs.items()}
    loops = {choice: loops_for(seconds, LEAST) for choice, seconds in first.items()}
    samples: dict[str, list[dict[str, float]]] = {choice: [] for choice in jobs}
    for _, choice, seconds in interleaved(jobs, loops, LEAST_REPEATS if quick else REPEATS, clock):
        samples[choice].append(seconds)
    return rows | {choice: replace(rows[choice], times=times_of(each)) for choice, each in samples.items()}


def _reading(scene: Scene, effects: tuple[str, ...], count: int, bare: bool) -> Reading:
    """A scene solved for some effects.

    Raises:
        PointcoordError: it cannot be solved.
    """
    motion = simulate(scene.model_copy(update={"effects": effects}))
    return Reading(motion, even_instants(scene.time.start, scene.time.stop, count), bare)
