"""What a pose costs at inputs that have nothing to do with each other: a race of many ways in one run.

A scene's car is solved at random values of its inputs, drawn from the ranges that its laws run through, and
what moves the chassis stands still. Two ways of ours take all of them at once: `map`, the map of the inputs,
whose making is the set-up, and `one by one`, where each pose is solved and proven by itself. Other ways know
scenes only: they get one whose inputs jump from each instant to the next, and fewer of the same poses.

Each is to be as near as `NEAR` to the assembly that is drawn. That is looked at: errors are those of the
first poses against the many-digit reference, and what our ways prove of all of theirs must be no more.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene, kinematic_map, solve_poses
from validate.cost.errors import Judge
from validate.cost.race import Found, NoNumbers, Runner
from validate.cost.scenes import StudyScene, study_instants
from validate.cost.table import Row
from validate.cost.way import Answer, Way, laws_at
from validate.cost.words import power

Array = NDArray[np.float64]

NEAR = 1e-9  # mm
POSES, POSES_QUICK = 1_000_000, 50_000
FEWER, FEWER_QUICK = 1000, 200  # of ways that take some hundred microseconds a pose, and more
CHECKED = 24  # poses that are held to the reference
SEED = 20221122
OTHERS: Mapping[str, float | None] = {"mujoco": 1e-6, "exudyn": 1e-6, "relative": 1e-6, "absolute": None}
"""Ways of the study that race with ours, by the coarsest setting that reaches `NEAR`: Newton's method squares
its last correction, in sizes of the car."""


def runners_of(
    study: StudyScene, ways: Sequence[Way], quick: bool = False, poses: tuple[int, int] | None = None
) -> list[Runner]:
    """Our two ways, and those of `OTHERS` among the ways."""
    count, fewer = poses or ((POSES_QUICK, FEWER_QUICK) if quick else (POSES, FEWER))
    scene = study.positions_only()
    ranges, inputs = drawn(scene, count)
    few, instants = as_scene(scene, inputs, min(fewer, count))
    judge = Judge(few, instants, range(min(CHECKED, len(instants))))

    def by_map() -> Callable[[], Any]:
        made = kinematic_map(scene, ranges, NEAR)
        return lambda: (made(inputs).position, made.bound.position)

    def one_by_one() -> Callable[[], Any]:
        def solve() -> Any:
            solved = solve_poses(scene, inputs, NEAR)
            return solved.position, float(max(solved.bound.max(), solved.carried_bound.max()))

        return solve

    def ours(answer: Any) -> Found:
        position, bound = answer
        if not bound <= NEAR:
            raise NoNumbers(f"is proven to {bound:.2g} mm only, not to {NEAR:.0e} mm")
        return judge(Answer({"position": {name: np.asarray(place) for name, place in position.items()}}))

    row = Row("unrelated", study.name, "", f"{power(NEAR)} mm", NEAR, poses=count, quantity="position")
    row = replace(row, digest=study.digest, quick=quick)
    runners = [Runner(replace(row, way="map"), by_map, ours)]
    runners.append(Runner(replace(row, way="one by one"), one_by_one, ours))
    for way in ways:
        if way.name in OTHERS:
            value = OTHERS[way.name]
            mine = replace(row, way=way.name, setting=way.says(value), poses=len(instants))
            runners.append(Runner(mine, partial(way.ready, few, value, instants), judge))
    return runners


def drawn(scene: Scene, count: int) -> tuple[dict[str, tuple[float, float]], dict[str, Array]]:
    """Ranges of a scene's driving inputs, and so many random values of each, (N,), rad or mm."""
    laws = laws_at(scene, study_instants(scene, 200))
    rng = np.random.default_rng(SEED)
    ranges = {
        name: (float(laws[name][:, 0].min()), float(laws[name][:, 0].max()))
        for name in scene.mechanism.topology.required_inputs
    }
    return ranges, {name: rng.uniform(*ends, count) for name, ends in ranges.items()}


def as_scene(scene: Scene, inputs: Mapping[str, Array], count: int) -> tuple[Scene, Array]:
    """A scene that jumps from each of the first inputs to the next, and its instants, (count,), s."""
    instants = np.arange(float(count))
    laws: dict[str, Any] = {
        name: {"table": {"times": instants.tolist(), "values": values[:count].tolist()}}
        for name, values in inputs.items()
    }
    content = scene.model_dump(mode="json", exclude_none=True)
    still = {name: {"constant": 0.0} for name in content["inputs"] if name not in laws}
    time = {"start": 0.0, "stop": float(instants[-1]), "samples": count}
    content |= {"inputs": {**still, **laws}, "time": time}
    return Scene.from_mapping(content, "unrelated inputs"), instants
