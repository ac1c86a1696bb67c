"""Time and peak memory against instants, designs and unknowns, as rows.

Each size of each way is measured in a process of its own (see `child`), smaller sizes first and the ways of
one size after each other. A size whose run would take too long or too much memory, as the sizes before it
say, is left out with that reason; so are the sizes above one that failed.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

from pointcoord.errors import visible
from validate.cost.accuracy import Progress, missing, silent
from validate.cost.growth.child import Limits, measure_apart
from validate.cost.growth.designs import INSTANTS as DESIGN_INSTANTS
from validate.cost.growth.designs import TOGETHER, DesignsInALoop, DesignsTogether
from validate.cost.growth.forecast import foreseen
from validate.cost.growth.instants import ManyInstants
from validate.cost.growth.task import Measured, Task
from validate.cost.growth.unknowns import INSTANTS as CHAIN_INSTANTS
from validate.cost.growth.unknowns import METHODS, SETTINGS, LongChain
from validate.cost.row import Row
from validate.cost.scenes import StudyScene, study_scene
from validate.cost.store import Key, Store
from validate.cost.way import Setting, Way

GROWING = ("series", "newton", "absolute", "relative", "mujoco")
"""The ways that are measured, if they are there: other ways grow as one of these does."""
ACCURACY = 1e-9  # mm; a way that can be set is set as near to this as it can
CHAIN = "chain of four-bars"
ALONE = "positions alone"

MeasureApart = Callable[[Task, Limits], Measured]


@dataclass(frozen=True)
class Plan:
    """What is measured.

    Attributes:
        instants, designs, unknowns: sizes, increasing.
        alone: whether positions alone are measured apart from all that the scene asks for.
        ways, design_ways: by name, of instants and of designs. chain_methods: see `unknowns.METHODS`.
        limits: of each point.
    """

    instants: tuple[int, ...]
    designs: tuple[int, ...]
    unknowns: tuple[int, ...]
    alone: bool
    ways: tuple[str, ...]
    design_ways: tuple[str, ...]
    chain_methods: tuple[str, ...]
    limits: Limits


FULL = Plan(
    instants=(100, 1_000, 10_000, 100_000, 1_000_000, 10_000_000),
    designs=(1, 10, 100, 1_000, 10_000),
    unknowns=(15, 45, 150, 450, 1_500),
    alone=True,
    ways=GROWING,
    design_ways=GROWING,
    chain_methods=tuple(METHODS),
    limits=Limits(seconds=60.0),
)
QUICK = Plan(
    instants=(100, 500),
    designs=(1, 10),
    unknowns=(15, 150),
    alone=False,
    ways=("series", "newton"),
    design_ways=("series",),
    chain_methods=("series", "scipy-root-jac"),
    limits=Limits(seconds=2.0),
)


def measure_growth(
    store: Store,
    scenes: Sequence[StudyScene],
    ways: Sequence[Way],
    quick: bool = False,
    progress: Progress = silent,
    *,
    plan: Plan | None = None,
    apart: MeasureApart = measure_apart,
) -> tuple[Row, ...]:
    """Measure what the store does not hold yet, and give all growth rows of these scenes and ways.

    Args:
        scenes: the first is measured: how costs grow is a matter of the way, and of the scene hardly.
        plan: what is measured, if not what `quick` says.
        apart: measures a task in a process of its own.
    Raises:
        StoreError: the store cannot be written.
    """
    plan = plan or (QUICK if quick else FULL)
    rows: list[Row] = []
    lines = [*_scene_lines(plan, scenes[:1], ways), *_chain_lines(plan, ways)]
    total, done = sum(len(line.sizes) for line in lines), 0
    for against in dict.fromkeys(line.against for line in lines):
        here = [line for line in lines if line.against == against]
        before: dict[int, list[Row]] = {number: [] for number in range(len(here))}
        for size in sorted({size for line in here for size in line.sizes}):
            for number, line in enumerate(here):
                if size not in line.sizes:
                    continue
                key = line.key(size, quick)
                row = store.row(key)
                if row is None:
                    progress(f"growth: {line.words}, {size} {against}", done, total)
                    row = line.row(size, before[number], plan.limits, apart)
                    store.write(key, row)
                before[number].append(row)
                rows.append(row)
                done += 1
    return tuple(rows)


@dataclass(frozen=True)
class Line:
    """What is measured at growing sizes: a way with a setting.

    Attributes:
        against, scene, way, setting, value, dense: as in the row. digest: of the scene.
        poses: how many configurations a size of 1 has, or a chain of any size.
        task: the work of a size.
        lacks: why there is none, if so.
    """

    against: str
    scene: str
    digest: str
    way: str
    setting: str
    value: float | None
    dense: bool
    sizes: tuple[int, ...]
    poses: int
    task: Callable[[int], Task]
    lacks: str = ""

    @property
    def words(self) -> str:
        """What is told of it."""
        return f"{self.scene}, {self.way} {self.setting}".rstrip()

    def key(self, size: int, quick: bool) -> Key:
        """Of the row of a size."""
        return Key(
            part="growth",
            scene=self.scene,
            digest=self.digest,
            way=self.way,
            setting=self.setting,
            against=self.against,
            size=size,
            quick=quick,
        )

    def row(self, size: int, before: Sequence[Row], limits: Limits, apart: MeasureApart) -> Row:
        """The row of a size.

        Args:
            before: rows of the sizes below it.
        """
        left_out = self.lacks or self._too_much(size, before, limits)
        found = Measured("left out", left_out) if left_out else apart(self.task(size), limits)
        return Row(
            part="growth",
            scene=self.scene,
            way=self.way,
            setting=self.setting,
            value=self.value,
            status=found.status,
            reason=visible(" ".join(found.reason.split())),
            configurations=(self.poses if self.against == "unknowns" else self.poses * size)
            if found.status == "measured"
            else 0,
            dense=self.dense,
            errors=found.errors,
            times=found.times,
            counts=found.counts,
            against=self.against,
            size=size,
            peak_bytes=found.peak_bytes,
        )

    def _too_much(self, size: int, before: Sequence[Row], limits: Limits) -> str:
        """Why a size is not tried; empty if it is."""
        for row in before:
            if row.status == "failed":
                return f"{row.size} {self.against} failed"
        known = [row for row in before if row.status == "measured" and row.size is not None]
        sizes = [float(row.size or 0) for row in known]
        seconds = foreseen(sizes, [sum(t.median for t in row.times.values()) for row in known], size)
        if seconds is not None and seconds > limits.seconds:
            return (
                f"a run would take some {_about(seconds)} s, as the smaller ones say; "
                f"allowed: {limits.seconds:g} s"
            )
        memory = foreseen(sizes, [float(row.peak_bytes or 0) for row in known], size)
        if memory is not None and memory > limits.memory:
            return (
                f"it would need some {_about(memory / 2**30)} GiB, as the smaller ones say; "
                f"allowed: {limits.memory / 2**30:g} GiB"
            )
        return ""


def nearest_setting(settings: Sequence[Setting], accuracy: float = ACCURACY) -> Setting:
    """The setting whose value is nearest to an accuracy, in digits; the last one if none has a value."""
    dialled = [setting for setting in settings if setting.value]
    if not dialled:
        return settings[-1]
    return min(dialled, key=lambda setting: abs(math.log(setting.value or 1.0) - math.log(accuracy)))


def _scene_lines(plan: Plan, scenes: Sequence[StudyScene], ways: Sequence[Way]) -> list[Line]:
    lines: list[Line] = []
    for whole in scenes:
        bare = study_scene(f"{whole.name}, {ALONE}", whole.scene.model_copy(update={"effects": ()}))
        asked = (bare, whole) if plan.alone and whole.scene.effects else (whole,)
        lines += [_of_instants(plan, s, way) for way in ways if way.name in plan.ways for s in asked]
        lines += [one for way in ways if way.name in plan.design_ways for one in _of_designs(plan, bare, way)]
    return lines


def _of_instants(plan: Plan, study: StudyScene, way: Way) -> Line:
    setting = nearest_setting(way.settings)
    return Line(
        against="instants",
        scene=study.name,
        digest=study.digest,
        way=way.name,
        setting=setting.words,
        value=setting.value,
        dense=way.dense,
        sizes=plan.instants,
        poses=1,
        task=partial(ManyInstants, study.scene, way, setting),
        lacks=missing(way),
    )


def _of_designs(plan: Plan, study: StudyScene, way: Way) -> list[Line]:
    one = replace(
        _of_instants(plan, study, way), against="designs", sizes=plan.designs, poses=DESIGN_INSTANTS
    )
    loop = replace(
        one,
        setting=_words(one.setting, "one by one"),
        task=partial(DesignsInALoop, study.scene, way, nearest_setting(way.settings)),
    )
    if way.name not in TOGETHER:
        return [loop]
    scene = study.scene.model_copy(update={"tolerance": one.value or study.scene.tolerance})
    together = replace(
        one, setting=_words(one.setting, "together"), task=partial(DesignsTogether, scene, way.name)
    )
    return [together, loop]


def _chain_lines(plan: Plan, ways: Sequence[Way]) -> list[Line]:
    asked = {way.name for way in ways}
    return [
        Line(
            against="unknowns",
            scene=CHAIN,
            digest="",
            way=method,
            setting=SETTINGS[method].words,
            value=SETTINGS[method].value,
            dense=method == "series",
            sizes=plan.unknowns,
            poses=len(CHAIN_INSTANTS),
            task=partial(LongChain, method),
        )
        for method in plan.chain_methods
        if method in asked
    ]


def _words(*parts: str) -> str:
    return ", ".join(part for part in parts if part)


def _about(value: float) -> str:
    """Two digits: it is a forecast."""
    return f"{value:.2g}" if value < 100.0 else f"{float(f'{value:.2g}'):.0f}"
