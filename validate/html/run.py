"""The content of a report: the scenes of a run with their results, and further results."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from pointcoord import Motion, PointcoordError, Scene, simulate
from validate.ci.record import Record
from validate.ci.verdict import sentence
from validate.comparison.examined import Examined
from validate.comparison.given import usable
from validate.cost.report import Report
from validate.exit_status import ExitStatus, combined
from validate.formulations.protocol import Solution
from validate.html.hard_cases import HardCases
from validate.output.document import Head
from validate.output.report import outcome_data
from validate.published.tables import Published

# Numbers of scenes that are drawn, not only listed in tables: the first ones, and further ones that disagree.
FIRST, FURTHER = 8, 8
# Largest numbers of points of a curve and of instants of an animation, so that the page stays small.
POINTS, FRAMES = 120, 61


@dataclass(frozen=True)
class Drawn:
    """A scene that the page draws, with its numbers; `motion` has all points, solved by pointcoord."""

    examined: Examined
    scene: Scene
    motion: Motion

    @property
    def models(self) -> tuple[Solution, ...]:
        """Both solutions of its first comparison: the usable numbers of each, at the instants it gives."""
        both = self.examined.outcomes[0].solutions
        return tuple(usable(solution, self.scene.instants) for solution in both)


@dataclass(frozen=True)
class Drawings:
    """The scenes of a run that are drawn; the numbers of other scenes, which tables list, are not kept.

    Attributes:
        count: number of scenes of the run.
    """

    count: int
    kept: list[Drawn] = field(default_factory=list)

    def add(self, examined: Examined, scene: Scene | None) -> None:
        """Keep a compared scene if it is one of the first, or one of the further ones that do not agree."""
        disagrees = examined.status is not ExitStatus.AGREE
        room = FIRST + FURTHER if disagrees or self.count <= FIRST + FURTHER else FIRST
        if scene is not None and examined.outcomes and len(self.kept) < room:
            # If pointcoord refuses the scene, the comparison has reported the reason already.
            with suppress(PointcoordError):
                motion = simulate(scene.model_copy(update={"points": None}))
                self.kept.append(Drawn(examined, scene, motion))


@dataclass(frozen=True)
class Run:
    """All content of a report; results that were not computed are empty or None.

    Attributes:
        record: results of the scenes.
        drawn: the scenes that the page draws.
        published: printed tables of other programs.
        hard: hard cases.
        cost: run time against accuracy.
    """

    head: Head
    record: Record = field(default_factory=lambda: Record(()))
    drawn: Sequence[Drawn] = ()
    published: tuple[Published, ...] = ()
    hard: HardCases | None = None
    cost: Report | None = None

    @property
    def by_verdict(self) -> Sequence[Drawn]:
        """The scenes that the page draws; those that do not agree come first."""
        return sorted(self.drawn, key=lambda one: one.examined.status is ExitStatus.AGREE)

    @property
    def not_drawn(self) -> Sequence[str]:
        """A sentence on which scenes are drawn, if not all are."""
        drawn, compared = len(self.drawn), sum(bool(one.outcomes) for one in self.record.examined)
        # With a file of results no motion is solved; the page has a section for the file.
        if drawn == compared or self.record.files:
            return ()
        text = f"{drawn} of {compared} scenes are drawn: the first {FIRST}, and the first {FURTHER} others "
        return (f"{text}that do not agree. The tables and the data files of this page contain all scenes.",)

    @property
    def status(self) -> ExitStatus:
        """The exit status of the run."""
        found = [self.record.status]
        if self.hard is not None:
            found.append(self.hard.status)
        if self.cost is not None and not self.cost.measured:
            found.append(ExitStatus.NO_VERDICT)
        if not all(one.agreed for one in self.published):
            found.append(ExitStatus.DISAGREE)
        return combined(found)

    @property
    def sentence(self) -> str:
        """The verdict in a sentence, which names everything that does not agree."""
        parts = [sentence(self.record)] if self.record.names else []
        wrong = [one.table.title for one in self.published if not one.agreed]
        if wrong:
            parts.append(f"other programs' tables disagree: {', '.join(wrong)}")
        if self.hard is not None:
            parts.append(self.hard.sentence)
        if self.cost is not None and not self.record.names:
            parts.append((*self.cost.sentences, "nothing was measured")[0].rstrip("."))
        return f"{'; '.join(parts)}."

    @cached_property
    def document(self) -> Mapping[str, Any]:
        """The run as plain data, in the form that `--json` of its command writes."""
        if self.hard is not None and self.head.kind == "hard":
            return self.hard.document
        results = self.record.data()
        if self.cost is not None and self.head.kind == "cost":
            results = self.cost.data()
        elif self.published:
            results["published_tables"] = [
                {"title": one.table.title, "source": one.table.source} | outcome_data(outcome)
                for one in self.published
                for outcome in one.outcomes
            ]
        return self.head.document(results, self.status, complete=True)
