"""The study: error and time of every method with every setting on each scene.

Each scene is one race. It is solved for positions alone and, if it asks for more, again for everything. The
first run gives the rows of positions and the second all other rows, so that times of positions include no
rates.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from pointcoord import Scene
from validate.cost.errors import judge
from validate.cost.race import FULL, QUICK, Progress, Runner, race, silent
from validate.cost.scenes import study_instants
from validate.cost.table import Row
from validate.cost.way import Way

SETTINGS_QUICK = 3  # number of settings of a method in a quick study, the first and the last among them


@dataclass(frozen=True)
class Study:
    """The scenes by name and the methods to measure, and the columns of program and machine."""

    scenes: Mapping[str, Scene]
    ways: tuple[Way, ...]
    where: Mapping[str, Any]
    quick: bool = False


def measure(study: Study, progress: Progress = silent) -> Iterator[list[Row]]:
    """Measure scene by scene; yields the rows of each."""
    for name, scene in study.scenes.items():
        rows = race(
            runners_of(name, scene, study.ways, study.quick), QUICK if study.quick else FULL, progress
        )
        yield [replace(row, quick=study.quick, **study.where) for row in rows]


def runners_of(name: str, scene: Scene, ways: Sequence[Way], quick: bool = False) -> list[Runner]:
    """Every method with every setting, for positions and for everything; in a quick study few settings."""
    instants, runners = study_instants(scene, quick=quick), []
    row, still = Row(name, "", poses=len(instants)), scene.model_copy(update={"effects": ()})
    parts = [(still, "position", judge(still, instants))]
    if scene.effects:
        parts.append((scene, "", judge(scene, instants, positions=False)))
    for way in ways:
        count = min(SETTINGS_QUICK, len(way.values)) if quick else len(way.values)
        for place in np.linspace(0, len(way.values) - 1, count).round().astype(int):
            value = way.values[place]
            of = replace(row, way=way.name, setting=way.says(value), value=value, dense=way.dense)
            runners += [
                Runner(replace(of, quantity=quantity), partial(way.ready, part, value, instants), found)
                for part, quantity, found in parts
            ]
    return runners
