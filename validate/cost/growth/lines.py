"""What is measured at growing sizes, smaller ones first.

A size whose run would take too long or too much memory, as the sizes before it say, is left out with that
reason; so are the sizes above one that failed. A chain of linkages is of no scene.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from validate.cost.growth.child import Limits, Task, measure_apart
from validate.cost.growth.tasks import CHAIN_INSTANTS, INSTANTS, LongChain, ManyDesigns, ManyInstants
from validate.cost.row import Row
from validate.cost.scenes import StudyScene
from validate.cost.store import scene_digest
from validate.cost.way import Way

GROWING = ("series", "newton", "absolute", "relative", "mujoco")
"""The ways that are measured: other ways grow as one of these does."""
ACCURACY = 1e-9  # mm; a way that can be set is set as near to this as it can
CHAIN = "chain of four-bars"
Measure = Callable[[Task, Row, Limits], list[Row]]


@dataclass(frozen=True)
class Plan:
    """What is measured.

    Attributes:
        limits: of each size. instants, designs, unknowns: sizes, increasing.
        ways: of instants. design_ways: of designs. chain_ways: of unknowns.
    """

    limits: Limits
    instants: tuple[int, ...] = (100, 1_000, 10_000, 100_000, 1_000_000, 10_000_000)
    designs: tuple[int, ...] = (1, 10, 100, 1_000, 10_000)
    unknowns: tuple[int, ...] = (15, 45, 150, 450, 1_500)
    ways: tuple[str, ...] = GROWING
    design_ways: tuple[str, ...] = GROWING
    chain_ways: tuple[str, ...] = (*GROWING, "scipy-root", "scipy-root-jac")


FULL = Plan(limits=Limits(seconds=60.0))
QUICK = Plan(
    Limits(seconds=2.0),
    (100, 500),
    (1, 10),
    (15, 150),
    ("series", "newton"),
    ("series",),
    ("series", "scipy-root-jac"),
)


@dataclass(frozen=True)
class Line:
    """A way at growing sizes.

    Attributes:
        row: what its rows have in common. poses: of a size of 1; 0 where they are the same for any size.
        task: the work of a size.
    """

    row: Row
    sizes: tuple[int, ...]
    poses: int
    task: Callable[[int], Task]

    def rows(
        self, known: Sequence[Row], limits: Limits, measure: Measure = measure_apart
    ) -> Iterator[list[Row]]:
        """Those of each size that is not known yet; a known row tells what larger sizes take."""
        seen = [row for row in known if row.line == self.row.line]
        for size in self.sizes:
            if any(row.size == size for row in seen):
                continue
            row = replace(self.row, size=size, poses=self.poses * size or len(CHAIN_INSTANTS))
            reason = self._too_much(size, [one for one in seen if (one.size or 0) < size], limits)
            if reason:
                found = [replace(row, poses=0, verdict="left out", reason=reason)]
            else:
                found = measure(self.task(size), row, limits)
            seen += found
            yield found

    def _too_much(self, size: int, before: Sequence[Row], limits: Limits) -> str:
        """Why a size is not tried; empty if it is."""
        for row in before:
            if row.verdict == "failed":
                return f"{row.size} {row.against} failed"
        known = {row.size or 0: row for row in before if row.time is not None}
        for what, unit, allowed, costs in (
            ("it would take", "s", limits.seconds, [whole_run(row) for row in known.values()]),
            (
                "it would need",
                "GiB",
                limits.memory / 2**30,
                [(r.peak_bytes or 0) / 2**30 for r in known.values()],
            ),
        ):
            cost = foreseen(list(known), costs, size)
            if cost is not None and cost > allowed:
                return f"{what} some {cost:.2g} {unit}, as the smaller ones say; allowed: {allowed:g} {unit}"
        return ""


def whole_run(row: Row) -> float:
    """What a run takes; s. Against instants without its set-up, which is the same for any number of them."""
    return (row.time or 0.0) * row.poses + (0.0 if row.against == "instants" else row.set_up or 0.0)


def foreseen(sizes: Sequence[float], costs: Sequence[float], size: float) -> float | None:
    """What a larger size will cost, carried on from the last two: the more of two laws.

    c size^p is right where a cost grows faster than its size; fixed + each size where a part that does not
    grow still hides the part that does. None if fewer than two sizes are known.
    """
    kept = [(known, cost) for known, cost in zip(sizes, costs, strict=True) if cost > 0.0]
    if len(kept) < 2:
        return None
    (smaller, less), (larger, more) = kept[-2:]
    exponent = max(np.log(more / less) / np.log(larger / smaller), 0.0)
    each = max((more - less) / (larger - smaller), 0.0)
    return float(max(more * (size / larger) ** exponent, more + each * (size - larger)))


def lines_of(
    study: StudyScene, ways: Sequence[Way], quick: bool = False, plan: Plan | None = None
) -> list[Line]:
    """All that grows, for one scene: how costs grow is a matter of the way, and of the scene hardly."""
    plan = plan or (QUICK if quick else FULL)
    bare = study.positions_only()
    alone = StudyScene(f"{study.name}, positions alone", bare, scene_digest(bare))
    asked = [alone, *([study] if study.scene.effects and not quick else [])]
    lines = []
    for way in ways:
        value = nearest(way.values)
        row = Row("growth", "", way.name, way.says(value), value, way.dense, quick=quick)
        if way.name in plan.ways:
            for one in asked:
                named = replace(row, scene=one.name, digest=one.digest, against="instants")
                lines.append(Line(named, plan.instants, 1, partial(ManyInstants, one.scene, way.name)))
        if way.name in plan.design_ways:
            for together in (True, False) if way.name == "series" else (False,):
                words = ", ".join(filter(None, (row.setting, "together" if together else "one by one")))
                named = replace(row, scene=alone.name, digest=alone.digest, against="designs", setting=words)
                task = partial(ManyDesigns, bare, way.name, together)
                lines.append(Line(named, plan.designs, INSTANTS, task))
        if way.name in plan.chain_ways:
            named = replace(row, scene=CHAIN, against="unknowns")
            lines.append(Line(named, plan.unknowns, 0, partial(LongChain, way.name)))
    return lines


def nearest(values: Sequence[float | None]) -> float | None:
    """The value nearest to `ACCURACY`, in digits."""
    dialled = [value for value in values if value]
    return min(dialled, key=lambda value: abs(math.log(value / ACCURACY)), default=None)
