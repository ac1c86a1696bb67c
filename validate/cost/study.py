"""The study: one loop over its parts, whose missing runs are raced and kept."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from validate.cost.parts import accuracy, effects, growth, loading, unrelated
from validate.cost.race import FULL, QUICK, Progress, Runner, race, silent
from validate.cost.scenes import QUICK_SCENE, StudyScene
from validate.cost.table import Part, Row, Store
from validate.cost.way import Way


@dataclass(frozen=True)
class Study:
    """What is to be measured.

    Attributes:
        scenes: the first one's cost is measured as it grows. own: whether a user named them; else
            `QUICK_SCENE` alone is raced at unrelated inputs.
    """

    parts: tuple[Part, ...]
    scenes: tuple[StudyScene, ...]
    ways: tuple[Way, ...]
    quick: bool = False
    own: bool = False

    def races(self) -> Iterator[list[Runner]]:
        """What is raced together; each is made when its turn comes."""
        for part in self.parts:
            if part == "loading":
                yield loading.runners_of(self.quick)
            for scene in self.scenes:
                if part == "accuracy":
                    yield accuracy.runners_of(scene, self.ways, self.quick)
                elif part == "effects":
                    yield effects.runners_of(scene, self.quick)
                elif part == "unrelated" and (self.own or scene.name == QUICK_SCENE):
                    yield unrelated.runners_of(scene, self.ways, self.quick)

    def lines(self) -> Sequence[growth.Line]:
        """What is measured as it grows."""
        return growth.lines_of(self.scenes[0], self.ways, self.quick) if "growth" in self.parts else ()


def measure(study: Study, store: Store, progress: Progress = silent) -> list[Row]:
    """Measure what the store does not hold yet, and give all rows of the study.

    What was measured is kept when its race ends, and of growth with each size: a run that is stopped goes on
    with the race that it was in.

    Raises:
        OutputError: the store cannot be written.
    """
    wanted: set[tuple[object, ...]] = set()
    for runners in study.races():
        wanted |= {runner.row.key for runner in runners}
        missing = [runner for runner in runners if not store.has(runner.row)]
        if missing:
            store.write(race(missing, QUICK if study.quick else FULL, progress))
    limits = growth.LIMITS_QUICK if study.quick else growth.LIMITS
    growing = study.lines()
    for i, line in enumerate(growing):
        progress(f"growth in {line.row.against}: {line.row.scene}, {line.row.way}", i, len(growing))
        for rows in line.rows(store.rows, limits):
            store.write(rows)
    grown = {line.row.line for line in growing}
    return [row for row in store.rows if row.key in wanted or row.line in grown]
