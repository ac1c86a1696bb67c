"""The study: error and time of every way with every setting on each scene, and what grows.

A race for each scene. It is solved for its positions alone and, where it asks for more, for everything.
Positions are judged by the first and all else by the second, so that nobody's positions wait for rates. What
is kept is not measured again.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from pointcoord import Scene
from validate.cost import growth
from validate.cost.errors import Judge
from validate.cost.race import FULL, QUICK, Progress, Runner, race, silent
from validate.cost.scenes import StudyScene, study_instants
from validate.cost.table import Part, Row, Store
from validate.cost.way import Way

SETTINGS_QUICK = 3  # of a way, the first and the last among them


@dataclass(frozen=True)
class Study:
    """What is to be measured; of the first scene also how its cost grows."""

    parts: tuple[Part, ...]
    scenes: tuple[StudyScene, ...]
    ways: tuple[Way, ...]
    quick: bool = False


def measure(study: Study, store: Store, progress: Progress = silent) -> list[Row]:
    """Measure what the store does not hold yet, and give all rows of the study.

    What was measured is kept when its race ends, and of growth with each size: a run that is stopped goes on
    with the race that it was in.

    Raises:
        OutputError: the store cannot be written.
    """
    lines: set[tuple[object, ...]] = set()
    for scene in study.scenes if "accuracy" in study.parts else ():
        runners = runners_of(scene, study.ways, study.quick)
        lines |= {runner.row.line for runner in runners}
        missing = [runner for runner in runners if not store.has(runner.row)]
        if missing:
            store.write(race(missing, QUICK if study.quick else FULL, progress))
    limits = growth.LIMITS_QUICK if study.quick else growth.LIMITS
    growing = growth.lines_of(study.scenes[0], study.ways, study.quick) if "growth" in study.parts else []
    for i, line in enumerate(growing):
        progress(f"growth in {line.row.against}: {line.row.scene}, {line.row.way}", i, len(growing))
        for rows in line.rows(store.rows, limits):
            store.write(rows)
    lines |= {line.row.line for line in growing}
    return [row for row in store.rows if row.line in lines]


def runners_of(study: StudyScene, ways: Sequence[Way], quick: bool = False) -> list[Runner]:
    """Every way with every setting, for positions and for everything."""
    scene, instants = study.scene, study_instants(study.scene, quick=quick)
    asked = [study.positions_only(), *([scene] if scene.effects else [])]
    judge = Judge(scene, instants)

    def runner(way: Way, value: float | None, part: Scene) -> Runner:
        row = Row(
            *("accuracy", study.name, way.name, way.says(value), value, way.dense),
            poses=len(instants),
            quantity="" if part.effects else "position",
            digest=study.digest,
            quick=quick,
        )
        ready = partial(way.ready, part, value, instants)
        return Runner(row, ready, partial(judge, positions=not part.effects))

    return [
        runner(way, value, part)
        for way in ways
        for value in chosen(way.values, SETTINGS_QUICK if quick else None)
        for part in asked
    ]


def chosen(values: Sequence[Any], most: int | None) -> list[Any]:
    """Some of the values, evenly from the first to the last."""
    if most is None or len(values) <= most:
        return list(values)
    return [values[place] for place in np.linspace(0, len(values) - 1, most).round().astype(int)]
