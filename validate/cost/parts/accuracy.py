"""Error and time of every way with every setting on a scene: a race for each scene.

A scene is solved for its positions alone and, where it asks for more, for everything. Positions are judged
by the first and all else by the second, so that nobody's positions wait for rates.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from pointcoord import Scene
from validate.cost.errors import Judge
from validate.cost.race import Runner
from validate.cost.scenes import StudyScene, study_instants
from validate.cost.table import Row
from validate.cost.way import Way

SETTINGS_QUICK = 3  # of a way, the first and the last among them


def runners_of(study: StudyScene, ways: Sequence[Way], quick: bool = False) -> list[Runner]:
    """Every way with every setting, for positions and for everything."""
    scene, instants = study.scene, study_instants(study.scene, quick=quick)
    asked = [study.positions_only(), *([scene] if scene.effects else [])]

    judge = Judge(scene, instants)

    def runner(way: Way, value: float | None, part: Scene) -> Runner:
        row = Row("accuracy", study.name, way.name, way.says(value), value, way.dense, poses=len(instants))
        quantity = "" if part.effects else "position"
        row = replace(row, quantity=quantity, digest=study.digest, quick=quick)
        return Runner(
            row, partial(way.ready, part, value, instants), partial(judge, positions=not part.effects)
        )

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
