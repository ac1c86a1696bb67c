"""The study: error and time of every way with every setting on each scene, and what grows.

A race for each scene. It is solved for its positions alone and, where it asks for more, for everything.
Positions are judged by the first and all else by the second, so that nobody's positions wait for rates. What
is kept is not measured again.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from validate.cost import growth
from validate.cost.errors import judge
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
        growth.grow(line, store, limits)
    lines |= {line.row.line for line in growing}
    return [row for row in store.rows if row.line in lines]


def runners_of(study: StudyScene, ways: Sequence[Way], quick: bool = False) -> list[Runner]:
    """Every way with every setting, for positions and for everything; of a quick study few settings."""
    instants, runners = study_instants(study.scene, quick=quick), []
    row = Row("accuracy", study.name, "", poses=len(instants), digest=study.digest, quick=quick)
    alone = (study.positions_only(), "position", judge(study.positions_only(), instants))
    every = (study.scene, "", judge(study.scene, instants, positions=False))
    for way in ways:
        count = min(SETTINGS_QUICK, len(way.values)) if quick else len(way.values)
        for place in np.linspace(0, len(way.values) - 1, count).round().astype(int):
            value = way.values[place]
            for scene, quantity, found in [alone, *([every] if study.scene.effects else [])]:
                of = replace(
                    row,
                    way=way.name,
                    setting=way.says(value),
                    value=value,
                    dense=way.dense,
                    quantity=quantity,
                )
                runners.append(Runner(of, partial(way.ready, scene, value, instants), found))
    return runners
