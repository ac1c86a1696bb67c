"""How time and memory grow with instants of a scene, designs of a car, and unknowns of a chain of four-bars.

Smaller sizes are measured first. A size whose run would take too long or too much memory, if both went in
proportion to the size before it, is left out with that reason; so are the sizes above one that failed.

A design is the car with every moving hardpoint moved at random; its drawing is put together by whoever
solves it. Design number k is the same car in however large a batch.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pointcoord import Designs, Scene, designs_of, sweep
from validate.cost.apart import Limits, Make, measure_apart
from validate.cost.chain import STOP, FourBarChain
from validate.cost.errors import Judge, summed_up
from validate.cost.race import Found, NoNumbers, Runner
from validate.cost.scenes import StudyScene, study_instants
from validate.cost.table import Row
from validate.cost.way import Answer, Way
from validate.cost.ways.registry import ways_named

Array = NDArray[np.float64]
Measure = Callable[[Make, int, Row, Limits], list[Row]]

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

    def rows(
        self, known: Sequence[Row], limits: Limits, measure: Measure = measure_apart
    ) -> Iterator[list[Row]]:
        """Those of each size that is not known yet; a known row tells what larger sizes take."""
        seen = [row for row in known if row.line == self.row.line]
        for size in self.sizes:
            if any(row.size == size for row in seen):
                continue
            row = replace(self.row, size=size, poses=self.poses * size or len(CHAIN_INSTANTS))
            reason = _too_much(size, [one for one in seen if (one.size or 0) < size], limits)
            if reason:
                found = [replace(row, poses=0, verdict="left out", reason=reason)]
            else:
                found = measure(self.make, self.least, row, limits)
            seen += found
            yield found


def lines_of(study: StudyScene, ways: Sequence[Way], quick: bool = False) -> list[Line]:
    """All that grows, for one scene: how costs grow is a matter of the way, and of the scene hardly."""
    plan = QUICK if quick else FULL
    alone = StudyScene(f"{study.name}, positions alone", study.positions_only())
    lines = []

    def add(way: Way, against: str, poses: int, make: Make, least: int, **columns: Any) -> None:
        sizes, names = plan[against]
        if way.name in names:
            value = nearest(way.values)
            row = Row("growth", "", way.name, way.says(value), value, way.dense, against, quick=quick)
            row = replace(row, **columns)
            lines.append(Line(row, sizes, poses, make, least))

    for way in ways:
        for one in [alone, *([study] if study.scene.effects and not quick else [])]:
            make = partial(many_instants, one.scene)
            add(way, "instants", 1, make, 2, scene=one.name, digest=one.digest)
        for words, together in (("together", True), ("one by one", False)):
            if way.name == "series" or not together:
                setting = ", ".join(filter(None, (way.says(nearest(way.values)), words)))
                make = partial(designs_together if together else designs_one_by_one, alone.scene)
                of = {"scene": alone.name, "digest": alone.digest, "setting": setting}
                add(way, "designs", INSTANTS, make, 1, **of)
        add(way, "unknowns", 0, long_chain, 6, scene=CHAIN)
    return lines


def many_instants(scene: Scene, row: Row, size: int) -> Runner:
    """A way at so many instants of a scene, and its errors at some, the first and the last among them."""
    instants = study_instants(scene, size)
    judge = Judge(scene, instants, some_of(size, CHECKED))
    return Runner(row, partial(_way(row).ready, scene, row.value, instants), judge)


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
        founds.append(Judge(scene, scene.instants, some_of(INSTANTS, CHECKED // 4))(answers(k)))
    return max(founds, key=lambda one: float(one["position"]["error"]))


def long_chain(row: Row, size: int) -> Runner:
    """A chain of four-bars of so many unknowns, and its errors against the closed form."""
    scene = FourBarChain.with_unknowns(size).scene()
    return Runner(
        row, partial(_way(row).ready, scene, row.value, CHAIN_INSTANTS), partial(chain_errors, size)
    )


def chain_errors(unknowns: int, answer: Answer) -> Found:
    """The errors of every tip against the closed form, mm.

    Raises:
        NoNumbers: this is another assembly, or none.
    """
    chain = FourBarChain.with_unknowns(unknowns)
    right, places = chain.closed_form(CHAIN_INSTANTS), answer.numbers["position"]
    off = np.abs(np.stack([places[name] for name in chain.tips], axis=1) - right)
    if not (off <= NOT_RIGHT * np.min(np.abs(right[..., 1:]).max(axis=-1))).all():
        worst = np.unravel_index(int(np.argmax(np.where(np.isnan(off), np.inf, off))), off.shape)
        raise NoNumbers(f"tip_{worst[1]} is {off[worst]:.3g} mm from the closed form")
    return {"position": {**summed_up(off), "radius": 0.5 * float(np.spacing(np.abs(right)).max())}}


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
    for what, unit, cost, allowed in (
        ("it would take", "s", times * ((known.time or 0.0) * known.poses + set_up), limits.seconds),
        ("it would need", "GiB", times * (known.peak_bytes or 0) / 2**30, limits.memory / 2**30),
    ):
        if cost > allowed:
            return f"{what} some {cost:.2g} {unit}, as {known.size} say; allowed: {allowed:g} {unit}"
    return ""


def _way(row: Row) -> Way:
    return ways_named([row.way])[0]
