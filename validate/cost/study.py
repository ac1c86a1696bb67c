"""The study: a race for each scene, and what grows; what is kept is not measured again."""

from __future__ import annotations

from dataclasses import dataclass

from validate.cost.parts import accuracy, growth
from validate.cost.race import FULL, QUICK, Progress, race, silent
from validate.cost.scenes import StudyScene
from validate.cost.table import Part, Row, Store
from validate.cost.way import Way


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
        runners = accuracy.runners_of(scene, study.ways, study.quick)
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
