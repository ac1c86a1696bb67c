"""What a report is about: the scenes of a run and all that came of them, and what else it holds."""

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

# Scenes that are drawn, and not only told in tables: the first ones, and so many more that do not agree.
FIRST, FURTHER = 8, 8
# Points of one curve, and instants of a drawing in space, at most: a page stays small.
POINTS, FRAMES = 120, 61


@dataclass(frozen=True)
class Drawn:
    """A scene of the run that the page draws, with its numbers; motion is of all points, by pointcoord."""

    examined: Examined
    scene: Scene
    motion: Motion

    @property
    def models(self) -> tuple[Solution, ...]:
        """Both solutions of its first comparison: what each really gives, when it does."""
        both = self.examined.outcomes[0].solutions
        return tuple(usable(solution, self.scene.instants) for solution in both)


@dataclass(frozen=True)
class Drawings:
    """The scenes of a run that are drawn; of the others tables tell, and their numbers are let go.

    Attributes:
        count: how many scenes the run has.
    """

    count: int
    kept: list[Drawn] = field(default_factory=list)

    def add(self, examined: Examined, scene: Scene | None) -> None:
        """Keep a scene that was compared if it is one of the first, or one of some more that do not agree."""
        disagrees = examined.status is not ExitStatus.AGREE
        room = FIRST + FURTHER if disagrees or self.count <= FIRST + FURTHER else FIRST
        if scene is not None and examined.outcomes and len(self.kept) < room:
            # Why pointcoord refuses it is told already.
            with suppress(PointcoordError):
                motion = simulate(scene.model_copy(update={"points": None}))
                self.kept.append(Drawn(examined, scene, motion))


@dataclass(frozen=True)
class Run:
    """All that a report is made of; what was not computed is not there.

    Attributes:
        record: what its scenes come to. drawn: those of them that the page draws.
        published: printed tables of other programs.
        hard: hard cases. cost: what accuracy costs in time.
    """

    head: Head
    record: Record = field(default_factory=lambda: Record(()))
    drawn: Sequence[Drawn] = ()
    published: tuple[Published, ...] = ()
    hard: HardCases | None = None
    cost: Report | None = None

    @property
    def not_drawn(self) -> Sequence[str]:
        """Which scenes are drawn, in a sentence, where these are not all."""
        drawn, compared = len(self.drawn), sum(bool(one.outcomes) for one in self.record.examined)
        # Of a file's scene no motion is solved, which the page says in a place of its own.
        if drawn == compared or self.record.files:
            return ()
        told = f"Drawn are {drawn} of {compared} scenes: the first {FIRST}, and the first {FURTHER} further "
        return (f"{told}ones that do not agree. The tables and the data beside this page have all.",)

    @property
    def status(self) -> ExitStatus:
        """What the run ends with."""
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
        """The verdict in a sentence; what does not agree is named."""
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
        """The run as plain data, in the form of `--json` of the command that it is of."""
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
