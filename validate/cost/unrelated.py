"""What a pose costs at inputs that have nothing to do with each other: a race of many ways in one run.

A scene's car is solved at random values of its inputs, drawn from the ranges that its laws run through, and
what moves the chassis stands still. Two ways of ours take all of them at once: `map`, the map of the inputs,
whose making is the phase `set-up`, and `one by one`, where each pose is solved and proven by itself. Other
ways know scenes only: they get one whose inputs jump from each instant to the next, and fewer of the same
poses. What is timed is finding the positions of all points, the phase `solve`; rounds are interleaved.

Each is to be as near as `NEAR` to the assembly that is drawn. That is looked at: errors are those of the
first poses against the many-digit reference, and what our ways prove of all of theirs must be no more.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from pointcoord import PointcoordError, Scene, kinematic_map, solve_poses
from pointcoord.errors import visible
from validate.cost.accuracy import Progress, silent
from validate.cost.errors import NoNumbers, Truth, errors_of, truth_of
from validate.cost.instants import study_instants
from validate.cost.row import Row, Status, Time
from validate.cost.scenes import StudyScene
from validate.cost.stopwatch import Clock, Job, Laps, interleaved, loops_for, sample, times_of
from validate.cost.store import Key, Store
from validate.cost.way import LeftOut, Ready, Setting, Way
from validate.cost.ways.inputs import laws_at
from validate.formulations.protocol import Numbers
from validate.reference import NoReferenceError

Array = NDArray[np.float64]

NEAR = 1e-9  # mm
POSES, POSES_QUICK = 1_000_000, 50_000
# Of ways that go from instant to instant; they take some hundred microseconds a pose, and more.
FEWER, FEWER_QUICK = 1000, 200
CHECKED = 24  # poses that are held to the reference
REPEATS, REPEATS_QUICK = 5, 3
LEAST = 0.02  # s, of a sample
SEED = 20221122

OTHERS: Mapping[str, Setting] = {
    "mujoco": Setting("last step 1e-06", 1e-6),
    "exudyn": Setting("last step 1e-06", 1e-6),
    "relative": Setting(f"{NEAR:.0e} mm", NEAR),
    "absolute": Setting(),
}
"""Ways of the study that race with ours, by the coarsest setting that reaches `NEAR`: Newton's method squares
its last correction, in sizes of the car."""
MAP, ALONE = "map", "one by one"


class _Runner(Protocol):
    """A way that is ready."""

    @property
    def count(self) -> int:
        """How many poses it solves."""
        ...

    def solve(self) -> Any:
        """Find them."""
        ...

    def positions(self, solved: Any) -> Numbers:
        """Those of the first poses at least, and of ours a check of all.

        Raises:
            NoNumbers: not all of them are proven to be near enough.
        """
        ...


@dataclass(frozen=True)
class _Map:
    """The map of the inputs."""

    scene: Scene
    ranges: Mapping[str, tuple[float, float]]
    inputs: Mapping[str, Array]

    @property
    def count(self) -> int:
        return len(next(iter(self.inputs.values())))

    def solve(self, laps: Laps | None = None) -> Any:
        made = kinematic_map(self.scene, self.ranges, NEAR)
        if laps is not None:
            laps.lap("set-up")
        return made(self.inputs), made.bound.position

    def positions(self, solved: Any) -> Numbers:
        found, bound = solved
        _require_near(bound)
        return {"position": found.position}


@dataclass(frozen=True)
class _OneByOne:
    """Each pose solved and proven by itself."""

    scene: Scene
    inputs: Mapping[str, Array]

    @property
    def count(self) -> int:
        return len(next(iter(self.inputs.values())))

    def solve(self, laps: Laps | None = None) -> Any:
        return solve_poses(self.scene, self.inputs, NEAR)

    def positions(self, solved: Any) -> Numbers:
        _require_near(float(max(solved.bound.max(), solved.carried_bound.max())))
        return {"position": solved.position}


@dataclass(frozen=True)
class _Other:
    """A way of the study on a scene whose inputs jump."""

    ready: Ready
    instants: Array

    @property
    def count(self) -> int:
        return len(self.instants)

    def solve(self, laps: Laps | None = None) -> Any:
        return self.ready.solve(self.instants)

    def positions(self, solved: Any) -> Numbers:
        return self.ready.output(self.ready.rates(solved))


def _require_near(bound: float) -> None:
    if not bound <= NEAR:
        raise NoNumbers(f"is proven to {bound:.2g} mm only, not to {NEAR:.0e} mm")


@dataclass(frozen=True)
class Draw:
    """Random inputs of a scene's car.

    Attributes:
        ranges: of each driving input. inputs: values of each, (N,), rad or mm.
    """

    scene: Scene
    ranges: Mapping[str, tuple[float, float]]
    inputs: Mapping[str, Array]

    @classmethod
    def of(cls, scene: Scene, count: int) -> Draw:
        """So many from where the scene's laws go; positions are all that is asked for."""
        scene = scene.model_copy(update={"effects": ()})
        driving = scene.mechanism.topology.required_inputs
        laws = laws_at(scene, study_instants(scene, 200))
        rng = np.random.default_rng(SEED)
        ranges = {n: (float(laws[n][:, 0].min()), float(laws[n][:, 0].max())) for n in driving}
        return cls(scene, ranges, {name: rng.uniform(*ranges[name], count) for name in driving})

    def as_scene(self, count: int) -> tuple[Scene, Array]:
        """A scene that jumps from each of the first inputs to the next, and its instants, (count,), s."""
        instants = np.arange(float(count))
        laws: dict[str, Any] = {
            name: {"table": {"times": instants.tolist(), "values": values[:count].tolist()}}
            for name, values in self.inputs.items()
        }
        content = self.scene.model_dump(mode="json", exclude_none=True)
        still = {name: {"constant": 0.0} for name in content["inputs"] if name not in laws}
        content |= {
            "inputs": {**still, **laws},
            "time": {"start": 0.0, "stop": float(instants[-1]), "samples": count},
        }
        return Scene.from_mapping(content, "unrelated inputs"), instants


def measure_unrelated(
    store: Store,
    scenes: Sequence[StudyScene],
    ways: Sequence[Way],
    quick: bool = False,
    progress: Progress = silent,
    *,
    poses: tuple[int, int] | None = None,
    clock: Clock = time.perf_counter_ns,
) -> tuple[Row, ...]:
    """Measure what the store does not hold yet, and give all rows of unrelated inputs.

    Args:
        ways: those of `OTHERS` among them race; ours always do.
        poses: how many, and how many of other ways, if not what `quick` says.
    Raises:
        StoreError: the store cannot be written.
    """
    count, fewer = poses or ((POSES_QUICK, FEWER_QUICK) if quick else (POSES, FEWER))
    names = (MAP, ALONE, *(way.name for way in ways if way.name in OTHERS))
    found: list[Row] = []
    for number, study in enumerate(scenes):
        keys = {
            name: Key(
                "unrelated", study.name, study.digest, name, _setting(name), quick=quick, configurations=count
            )
            for name in names
        }
        # Ratios are of one run: a scene is measured whole.
        if any(store.row(key) is None for key in keys.values()):
            progress(f"unrelated inputs: {study.name}", number, len(scenes))
            rows = _measured(study, ways, (count, fewer), REPEATS_QUICK if quick else REPEATS, clock)
            for name, row in rows.items():
                store.write(keys[name], row)
        found += [row for row in map(store.row, keys.values()) if row is not None]
    return tuple(found)


def _setting(name: str) -> str:
    return OTHERS[name].words if name in OTHERS else f"{NEAR:.0e} mm"


def _measured(
    study: StudyScene, ways: Sequence[Way], poses: tuple[int, int], repeats: int, clock: Clock
) -> dict[str, Row]:
    """A row for each way, all measured in the same rounds."""
    count, fewer = poses
    names = [MAP, ALONE, *(way.name for way in ways if way.name in OTHERS)]
    try:
        draw = Draw.of(study.scene, count)
        few, instants = draw.as_scene(min(fewer, count))
        truth = truth_of(few, instants[: min(CHECKED, len(instants))])
    except (NoReferenceError, PointcoordError) as error:
        why = f"there is no reference to hold it to: {error}"
        rows = {name: Row("unrelated", study.name, name, _setting(name), NEAR) for name in names}
        return {name: _without_numbers(row, NoNumbers(why)) for name, row in rows.items()}
    runners: dict[str, _Map | _OneByOne | _Other] = {}
    rows = {}
    by_name = {way.name: way for way in ways}
    first: dict[str, Time] = {}
    for name in names:
        row = Row("unrelated", study.name, name, _setting(name), NEAR)
        try:
            begun = clock()
            runner: _Map | _OneByOne | _Other
            if name == MAP:
                runner = _Map(draw.scene, draw.ranges, draw.inputs)
            elif name == ALONE:
                runner = _OneByOne(draw.scene, draw.inputs)
            else:
                runner = _Other(by_name[name].prepare(few, OTHERS[name]), instants)
            solved = runner.solve()
            seconds = 1e-9 * (clock() - begun)
            first[name] = Time(seconds, seconds, seconds, 1)
            row = replace(row, configurations=runner.count, errors=_errors(runner, solved, truth))
            runners[name] = runner
        except Exception as error:
            row = _without_numbers(row, error)
        rows[name] = row
    jobs = {name: _job(runner) for name, runner in runners.items()}
    loops = {name: loops_for(sum(sample(job, 1, clock).values()), LEAST) for name, job in jobs.items()}
    samples: dict[str, list[dict[str, float]]] = {name: [] for name in jobs}
    for _, name, phases in interleaved(jobs, loops, repeats, clock):
        samples[name].append(phases)
    for name, each in samples.items():
        rows[name] = replace(rows[name], times={**times_of(each), "first": first[name]})
    return rows


def _job(runner: _Map | _OneByOne | _Other) -> Job:
    def solve(laps: Laps) -> None:
        runner.solve(laps)
        laps.lap("solve")

    return solve


def _errors(runner: _Runner, solved: Any, truth: Truth) -> Any:
    """Of the first poses, by quantity."""
    count = len(truth.instants)
    positions = {
        "position": {name: np.asarray(p)[:count] for name, p in runner.positions(solved)["position"].items()}
    }
    errors, _ = errors_of(positions, truth)
    return errors


def _without_numbers(row: Row, error: Exception) -> Row:
    """The row of a way that gave no numbers: left out where it does not apply, and else failed."""
    status: Status = "left out" if isinstance(error, LeftOut | ImportError) else "failed"
    told = isinstance(error, PointcoordError | NoNumbers | LeftOut | ImportError)
    words = str(error) if told else f"{type(error).__name__}: {error}"
    return replace(row, status=status, reason=visible(" ".join(words.split())))
