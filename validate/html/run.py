"""What a report is about: the scenes of a run and all that came of them, and what else it holds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from pointcoord import Motion, PointcoordError, Scene, simulate
from validate.ci.record import Record, without_numbers
from validate.ci.verdict import sentence
from validate.comparison.examined import Examined
from validate.comparison.given import usable
from validate.cost.report import Report
from validate.exit_status import ExitStatus, combined
from validate.formulations.protocol import Accuracy, Solution
from validate.html.hard_cases import HardCases
from validate.measured.comparing import DataOutcome
from validate.output.document import Head
from validate.output.report import file_data
from validate.paper.tables import PaperRow
from validate.published.tables import Published

# Scenes that are drawn, and not only told in tables: the first ones, and so many more that do not agree.
FIRST, FURTHER = 8, 8
# Points of one curve, in all scenes together that are drawn (see `points`), and instants of a drawing in
# space.
POINTS = 1600
FEWEST, MOST = 100, 600
FRAMES, FEWER_FRAMES = 121, 61


@dataclass(frozen=True)
class Told:
    """One scene of the run.

    Attributes:
        scene: None where its file could not be read.
        motion: as pointcoord solves it, or the part that could be solved; None if nothing could.
        drawn: whether the page draws it; of another one the numbers were let go, and tables tell of it. Of a
            file's scene nothing is drawn but the file's own columns.
        file: of results that the scene's car was held to, if it is about one.
    """

    examined: Examined
    scene: Scene | None
    motion: Motion | None = None
    drawn: bool = True
    file: DataOutcome | None = None

    @property
    def stopped(self) -> str:
        """Why no two models could be compared on the scene; empty if they were."""
        if self.examined.outcomes or not self.examined.complaint:
            return ""
        return self.examined.complaint.removeprefix(f"{self.examined.name}: ")

    @property
    def models(self) -> tuple[Solution, ...]:
        """Both solutions of its first comparison: what each really gives, when it does.

        Of a scene that is refused there is one at most: what pointcoord solves of it before it stops.
        """
        if self.scene is None:
            return ()
        if self.examined.outcomes:
            both = self.examined.outcomes[0].solutions
            return tuple(usable(solution, self.scene.instants) for solution in both)
        if self.motion is None:
            return ()
        times = self.motion.times
        return (Solution("pointcoord", times, self.motion.numbers, Accuracy(np.ones(len(times)))),)


@dataclass
class Telling:
    """Takes in the scenes of a run, and keeps the numbers of those that are drawn.

    Attributes:
        count: how many there are.
    """

    count: int
    told: list[Told] = field(default_factory=list)

    def add(self, examined: Examined, scene: Scene | None, file: DataOutcome | None = None) -> None:
        """Take in what came of a scene, or of a file of results and the scene of its car."""
        if file is not None or not self._is_drawn(examined):
            kept = examined if file is not None else without_numbers(examined)
            self.told.append(Told(kept, scene, drawn=False, file=file))
        else:
            self.told.append(Told(examined, scene, None if scene is None else _motion(scene)))

    def run(self, head: Head, record: Record) -> Run:
        """The run that the scenes are of."""
        return Run(head, tuple(self.told), record)

    def _is_drawn(self, examined: Examined) -> bool:
        if self.count <= FIRST + FURTHER or len(self.told) < FIRST:
            return True
        further = sum(one.drawn for one in self.told[FIRST:])
        return bool(examined.status is not ExitStatus.AGREE and examined.outcomes and further < FURTHER)


def _motion(scene: Scene) -> Motion | None:
    try:
        return simulate(scene)
    except PointcoordError as error:
        # Why it is refused is told already.
        partial = error.partial
        return partial if isinstance(partial, Motion) else None


@dataclass(frozen=True)
class Run:
    """All that a report is made of; what was not computed is not there.

    Attributes:
        told: its scenes. record: what they come to, with those that it did not come to.
        published: printed tables of other programs.
        hard: hard cases. cost: what accuracy costs in time.
        left_out: what else a report can hold, and the command that adds it.
    """

    head: Head
    told: tuple[Told, ...] = ()
    record: Record | None = None
    published: tuple[Published, ...] = ()
    hard: HardCases | None = None
    cost: Report | None = None
    left_out: tuple[tuple[str, str], ...] = ()

    @property
    def status(self) -> ExitStatus:
        """What the run ends with."""
        found = [] if self.record is None else [self.record.status]
        if self.hard is not None:
            found.append(self.hard.status)
        if self.cost is not None and not self.cost.measured:
            found.append(ExitStatus.NO_VERDICT)
        if not all(one.found.outcome.agreed for one in self.published):
            found.append(ExitStatus.DISAGREE)
        return combined(found)

    @property
    def sentence(self) -> str:
        """The verdict in a sentence; what does not agree is named."""
        parts = [] if self.record is None else [sentence(self.record)]
        wrong = [one.table.title for one in self.published if not one.found.outcome.agreed]
        if wrong:
            parts.append(f"other programs' tables disagree: {', '.join(wrong)}")
        if self.hard is not None:
            parts.append(self.hard.sentence)
        if self.cost is not None and not self.told:
            parts.append((*self.cost.sentences, "nothing was measured")[0].rstrip("."))
        return f"{'; '.join(parts)}."

    @property
    def paper(self) -> Sequence[PaperRow]:
        """The paper's printed tables beside ours, if they were compared."""
        return () if self.record is None else self.record.paper

    @property
    def factor(self) -> float:
        """How many times the derived tolerance differences are held to."""
        return 1.0 if self.record is None else self.record.factor

    @property
    def files(self) -> tuple[DataOutcome, ...]:
        """The files of results that the run is about."""
        return tuple(one.file for one in self.told if one.file is not None)

    @property
    def drawn(self) -> tuple[Told, ...]:
        """The scenes that the page draws."""
        return tuple(one for one in self.told if one.drawn)

    @property
    def points(self) -> int:
        """Points of a curve, at most: a page stays small however many scenes and instants there are."""
        return min(max(POINTS // max(len(self.drawn), 1), FEWEST), MOST)

    @property
    def frames(self) -> int:
        """Instants of a drawing in space, at most."""
        return FRAMES if len(self.drawn) <= FIRST else FEWER_FRAMES

    @cached_property
    def document(self) -> Mapping[str, Any]:
        """The run as plain data, in the form of `--json` of the command that it is of."""
        return self.head.document(self._results, self.status, complete=True)

    @property
    def _results(self) -> Mapping[str, Any]:
        if self.hard is not None and self.head.kind == "hard":
            return self.hard.results
        if self.cost is not None and self.head.kind == "cost":
            return self.cost.data()
        results = {} if self.record is None else self.record.data()
        published = [
            {"title": one.table.title, "source": one.table.source} | file_data(one.found)
            for one in self.published
        ]
        return {**results, **({"published_tables": published} if published else {})}
