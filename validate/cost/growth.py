"""How time and memory grow with instants of a scene, designs of a car, and unknowns of a chain of four-bars.

Smaller sizes are measured first. A size whose run would take too long, if that went in proportion to the size
before it, is left out with that reason; so are the sizes above one that failed, as of too much memory.

A design is the car with every moving hardpoint moved at random; its drawing is put together by whoever
solves it. Design number k is the same car in however large a batch.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pointcoord import Designs, Scene, designs_of, sweep
from validate.cost.apart import Limits, Make, measure_apart
from validate.cost.chain import ROCKERS, STOP, chain_scene, closed_form
from validate.cost.errors import judge, summed_up
from validate.cost.race import Found, NoNumbers, Runner
from validate.cost.scenes import StudyScene, study_instants
from validate.cost.table import Row, Store
from validate.cost.way import Answer, Way
from validate.cost.ways.registry import ways_named

Array = NDArray[np.float64]

GROWING = ("series", "newton", "absolute", "relative", "mujoco")
"""The ways that are measured: other ways grow as one of these does."""
ACCURACY = 1e-9  # mm; a way that can be set is set as near to this as it can
CHAIN = "chain of four-bars"
CHAIN_INSTANTS = np.linspace(0.0, STOP, 6)[1:]  # s; the longest chains take a second and more for each
INSTANTS = 101  # of a design
MOVED = 2.0  # mm, at most, along each axis: what a designer tries, and no drawing turns into another one
SEED = 2026
CHECKED = 16  # instants whose numbers are compared with the reference, which takes some 5 ms for each
NOT_RIGHT = 1e-3  # of the shortest rocker: an answer that far off is another assembly, or none


Plan = Mapping[str, tuple[tuple[int, ...], tuple[str, ...]]]
"""Sizes, increasing, of what is varied, and the ways that are measured."""
FULL: Plan = {
    "instants": ((100, 1_000, 10_000, 100_000, 1_000_000, 10_000_000), GROWING),
    "designs": ((1, 10, 100, 1_000, 10_000), GROWING),
    "unknowns": ((15, 45, 150, 450, 1_500), (*GROWING, "scipy-root", "scipy-root-jac")),
}
QUICK: Plan = {
    "instants": ((100, 500), ("series", "newton")),
    "designs": ((1, 10), ("series",)),
    "unknowns": ((15, 150), ("series", "scipy-root-jac")),
}
LIMITS, LIMITS_QUICK = Limits(seconds=60.0), Limits(seconds=2.0)


@dataclass(frozen=True)
class Line:
    """A way at growing sizes.

    Attributes:
        row: what its rows have in common. make: the work of a size. least: the smallest there is.
        poses: of a size of 1; 0 where they are the same for any size.
    """

    row: Row
    sizes: tuple[int, ...]
    poses: int
    make: Make
    least: int


def grow(line: Line, store: Store, limits: Limits) -> None:
    """Measure each size that the store does not hold; a row that it holds tells what larger sizes take."""
    for size in line.sizes:
        row = replace(line.row, size=size, poses=line.poses * size or len(CHAIN_INSTANTS))
        if store.has(row):
            continue
        smaller = [one for one in store.rows if one.line == row.line and (one.size or 0) < size]
        if reason := _too_much(size, smaller, limits):
            store.write([replace(row, poses=0, verdict="left out", reason=reason)])
        else:
            store.write(measure_apart(line.make, line.least, row, limits))


def lines_of(study: StudyScene, ways: Sequence[Way], quick: bool = False) -> list[Line]:
    """All that grows, for one scene: how costs grow is a matter of the way, and of the scene hardly."""
    plan = QUICK if quick else FULL
    alone = StudyScene(f"{study.name}, positions alone", study.positions_only())
    cars = [alone, *([study] if study.scene.effects and not quick else [])]
    lines = []
    for way in ways:
        value = nearest(way.values)
        words, row = way.says(value), Row("growth", "", way.name, value=value, dense=way.dense, quick=quick)
        kinds: list[tuple[str, StudyScene, str, Make, int, int]] = [
            ("instants", car, words, partial(many_instants, car.scene), 1, 2) for car in cars
        ]
        for told, make in (("together", designs_together), ("one by one", designs_one_by_one)):
            if make is designs_one_by_one or way.name == "series":
                setting = ", ".join(filter(None, (words, told)))
                kinds.append(("designs", alone, setting, partial(make, alone.scene), INSTANTS, 1))
        for against, car, setting, work, poses, least in kinds:
            row_of = replace(row, scene=car.name, digest=car.digest, setting=setting, against=against)
            lines.append(Line(row_of, plan[against][0], poses, work, least))
        of_chain = replace(row, scene=CHAIN, setting=words, against="unknowns")
        lines.append(Line(of_chain, plan["unknowns"][0], 0, long_chain, 6))
    return [line for line in lines if line.row.way in plan[line.row.against][1]]


def many_instants(scene: Scene, row: Row, size: int) -> Runner:
    """A way at so many instants of a scene, and its errors at some, the first and the last among them."""
    instants = study_instants(scene, size)
    ready = partial(_way(row).ready, scene, row.value, instants)
    return Runner(row, ready, judge(scene, instants, some_of(size, CHECKED)))


def designs_together(scene: Scene, row: Row, size: int) -> Runner:
    """So many designs of a scene's car, whose positions are solved by one sweep."""
    designs = drawn_at_random(scene, size, row.value)

    def swept() -> Any:
        found = sweep(designs)
        for failure in found.failures.values():
            raise failure.error
        return lambda k: Answer({"position": {n: x[k] for n, x in found.position.items()}})

    return Runner(row, lambda: swept, partial(worst_design, designs, size))


def designs_one_by_one(scene: Scene, row: Row, size: int) -> Runner:
    """The same designs, each solved by itself by a way."""
    designs = drawn_at_random(scene, size, row.value)
    scenes = [designs.design(k) for k in range(size)]

    def prepared() -> Callable[[], Any]:
        runs = [_way(row).ready(one, row.value, one.instants) for one in scenes]
        return lambda: [run() for run in runs].__getitem__

    return Runner(row, prepared, partial(worst_design, designs, size))


def worst_design(designs: Designs, size: int, answers: Callable[[int], Answer]) -> Found:
    """The errors of the worst of some designs, at some instants."""
    founds = []
    for k in some_of(size, CHECKED // 4):
        scene = designs.design(k)
        founds.append(judge(scene, scene.instants, some_of(INSTANTS, CHECKED // 4))(answers(k)))
    return max(founds, key=lambda one: float(one["position"]["error"]))


def long_chain(row: Row, size: int) -> Runner:
    """A chain of four-bars of so many unknowns, and its errors against the closed form."""
    ready = partial(_way(row).ready, chain_scene(size), row.value, CHAIN_INSTANTS)
    return Runner(row, ready, partial(chain_errors, size))


def chain_errors(unknowns: int, answer: Answer) -> Found:
    """The errors of every tip against the closed form, mm.

    Raises:
        NoNumbers: this is another assembly, or none.
    """
    tips, places = closed_form(unknowns, CHAIN_INSTANTS), answer.numbers["position"]
    off = np.abs([places[name] - right for name, right in tips.items()])
    if not (off <= NOT_RIGHT * min(ROCKERS)).all():
        worst = np.unravel_index(int(np.argmax(np.where(np.isnan(off), np.inf, off))), off.shape)
        raise NoNumbers(f"tip_{worst[0]} is {off[worst]:.3g} mm from the closed form")
    largest = max(float(np.abs(right).max()) for right in tips.values())
    return {"position": {**summed_up(off), "radius": 0.5 * float(np.spacing(largest))}}


def drawn_at_random(scene: Scene, count: int, tolerance: float | None) -> Designs:
    """So many designs, to be solved at `INSTANTS` instants; the first one is as drawn."""
    time = scene.time.model_copy(update={"samples": INSTANTS})
    scene = scene.model_copy(update={"time": time, "tolerance": tolerance or scene.tolerance})
    drawn = [name for name in scene.mechanism.topology.moving if name in scene.mechanism.points]
    far = np.random.default_rng(SEED).uniform(-MOVED, MOVED, (count, len(drawn), 3))
    far[0] = 0.0
    return designs_of(scene, offsets={name: far[:, i] for i, name in enumerate(drawn)})


def nearest(values: Sequence[float | None]) -> float | None:
    """The value nearest to `ACCURACY`, in digits."""
    given = [value for value in values if value]
    return min(given, key=lambda value: abs(math.log(value / ACCURACY)), default=None)


def some_of(size: int, most: int) -> list[int]:
    """So many numbers from 0 to size - 1, evenly, both included; all of them if there are fewer."""
    return sorted({int(place) for place in np.linspace(0, size - 1, most)})


def _too_much(size: int, before: Sequence[Row], limits: Limits) -> str:
    """Why a size is not tried, in proportion to the largest one that was timed; empty if it is."""
    for row in before:
        if row.verdict == "failed":
            return f"{row.size} {row.against} failed"
    known = max((row for row in before if row.time is not None), key=lambda row: row.size or 0, default=None)
    if known is None:
        return ""
    # Against instants without the set-up, which is the same for any number of them.
    set_up = 0.0 if known.against == "instants" else known.set_up or 0.0
    times = size / (known.size or size)
    seconds = times * ((known.time or 0.0) * known.poses + set_up)
    if seconds <= limits.seconds:
        return ""
    return f"it would take some {seconds:.2g} s, as {known.size} say; allowed: {limits.seconds:g} s"


def _way(row: Row) -> Way:
    return ways_named([row.way])[0]
