"""What a report is about: the scenes of a run and all that came of them, and what else it holds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

from pointcoord import Motion, PointcoordError, Scene, simulate
from validate.ci.record import Record, without_numbers
from validate.comparison.examined import Examined
from validate.comparison.findings import Finding, findings
from validate.cost.report import Report
from validate.diagnosis import Explanation
from validate.exit_status import ExitStatus, combined
from validate.html.hard_cases import HardCases
from validate.measured.comparing import DataOutcome
from validate.output import report
from validate.output.document import Head
from validate.output.results_text import data_of, examined_data_of
from validate.paper.tables import PaperRow
from validate.published.tables import Published

# Scenes that are drawn, and not only told in tables: the first ones, and so many more that do not agree.
FIRST, FURTHER = 8, 8
# Points of one curve, in all scenes together that are drawn (see `points`), and instants of a drawing in
# space.
POINTS = 1600
FEWEST, MOST = 100, 600
FRAMES, FEWER_FRAMES = 121, 61
# Scenes that a sentence names of each verdict.
NAMED = 10


@dataclass(frozen=True)
class Told:
    """One scene of the run.

    Attributes:
        scene: None where its file could not be read.
        motion: as pointcoord solves it, or the part that could be solved; None if nothing could.
        explained: of each of its comparisons, what would explain that it disagrees.
        drawn: whether the page draws it; of another one the numbers were let go, and tables tell of it. Of a
            file's scene nothing is drawn but the file's own columns.
        file: of results that the scene's car was held to, if it is about one.
    """

    examined: Examined
    scene: Scene | None
    motion: Motion | None = None
    explained: tuple[Sequence[Explanation], ...] = ()
    drawn: bool = True
    file: DataOutcome | None = None

    @property
    def verdict(self) -> str:
        """In one of the words of a verdict: a scene of which nothing can be said is not tested."""
        status = self.examined.status
        if status is ExitStatus.AGREE:
            return "agrees"
        return "disagrees" if status is ExitStatus.DISAGREE else "not tested"

    @property
    def why_not(self) -> str:
        """Why a scene is not tested, in a word or two; empty of one that is, or whose claims are too wide."""
        status = self.examined.status
        if self.verdict != "not tested" or not self.examined.complaint:
            return ""
        if status is ExitStatus.WRONG_INPUT:
            return status.verdict
        return "failed" if status is ExitStatus.NOT_FINISHED else "refused"

    @property
    def stopped(self) -> str:
        """Why no two models could be compared on the scene; empty if they were."""
        if self.examined.outcomes or not self.examined.complaint:
            return ""
        return self.examined.complaint.removeprefix(f"{self.examined.name}: ")


@dataclass
class Telling:
    """Takes in the scenes of a run, and keeps the numbers of those that are drawn.

    Attributes:
        count: how many there are.
    """

    count: int
    told: list[Told] = field(default_factory=list)

    def add(
        self, examined: Examined, scene: Scene | None, explained: Sequence[Sequence[Explanation]] = ()
    ) -> None:
        """Take in what came of a scene."""
        why = tuple(explained) or tuple(() for _ in examined.outcomes)
        one = Told(examined, scene, None, why, self._is_drawn(examined))
        if one.drawn:
            one = replace(one, motion=None if scene is None else _motion(scene))
        else:
            one = replace(one, examined=without_numbers(examined))
        self.told.append(one)

    def add_file(self, examined: Examined, scene: Scene, found: DataOutcome) -> None:
        """Take in what came of a file of results."""
        self.told.append(Told(examined, scene, None, (found.explanations,), drawn=False, file=found))

    def run(
        self, head: Head, record: Record, paper: Sequence[PaperRow], baseline: Mapping[str, Any] | None
    ) -> Run:
        """The run that the scenes are of."""
        return Run(
            head, tuple(self.told), record.factor, paper=tuple(paper), record=record, baseline=baseline
        )

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
        told: its scenes. factor: how many times the derived tolerance differences are held to.
        paper: the paper's printed tables beside ours. published: those of other programs.
        record: of a run of comparisons, with the scenes that it did not come to. baseline: what moved, as
            plain data.
        hard: hard cases. cost: what accuracy costs in time.
        left_out: what else a report can hold, and the command that adds it.
    """

    head: Head
    told: tuple[Told, ...] = ()
    factor: float = 1.0
    paper: tuple[PaperRow, ...] = ()
    published: tuple[Published, ...] = ()
    record: Record | None = None
    baseline: Mapping[str, Any] | None = None
    hard: HardCases | None = None
    cost: Report | None = None
    left_out: tuple[tuple[str, str], ...] = ()

    @property
    def status(self) -> ExitStatus:
        """What the run ends with."""
        found = [one.examined.status for one in self.told] if self.record is None else [self.record.status]
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
        parts = [*(self._of_files() if self.files else self._of_scenes()), *self._since()]
        wrong = [one.table.title for one in self.published if not one.found.outcome.agreed]
        if wrong:
            parts.append(f"other programs' tables disagree: {', '.join(wrong)}")
        if self.hard is not None:
            parts.append(self.hard.sentence)
        if self.cost is not None and not self.told:
            parts.append((*self.cost.sentences, "nothing was measured")[0].rstrip("."))
        return f"{'; '.join(parts)}."

    @property
    def files(self) -> tuple[DataOutcome, ...]:
        """The files of results that the run is about."""
        return tuple(one.file for one in self.told if one.file is not None)

    def _of_files(self) -> list[str]:
        parts = []
        for one in self.told:
            if one.file is None:
                continue
            rows, (file, _) = one.file.outcome.rows, one.file.outcome.solutions
            by_verdict: dict[str, list[str]] = {}
            for row in rows:
                by_verdict.setdefault(row.verdict, []).append(report.about(row.quantity, row.name))
            agreeing = len(by_verdict.pop("agrees", ()))
            told = f"{file.formulation} and the car of {one.examined.name}: {agreeing} of {len(rows)} agree"
            parts += [told, *(f"{verdict}: {named(names)}" for verdict, names in sorted(by_verdict.items()))]
        if self.factor != 1.0:
            parts.append(report.held_to(self.factor))
        return parts

    def _of_scenes(self) -> list[str]:
        not_run = () if self.record is None else self.record.not_run
        count = len(self.told) + len(not_run)
        if not count:
            return []
        by_verdict: dict[str, list[str]] = {}
        for one in self.told:
            word = f"{one.verdict} ({one.why_not})" if one.why_not else one.verdict
            by_verdict.setdefault(word, []).append(one.examined.name)
        agreeing = len(by_verdict.pop("agrees", ()))
        parts = [report.agreeing(agreeing, count)]
        parts += [f"{verdict}: {named(names)}" for verdict, names in sorted(by_verdict.items())]
        if self.record is not None and not_run:
            parts.append(f"not run ({self.record.stopped}): {named(not_run)}")
        if self.factor != 1.0:
            parts.append(report.held_to(self.factor))
        return parts

    def _since(self) -> list[str]:
        if self.record is None or self.record.baseline is None:
            return []
        moved = [since.scene for since in self.record.since if since.moved]
        held = any(since.compared for since in self.record.since)
        told = f"moved since the baseline: {named(moved)}" if moved else "nothing moved since the baseline"
        return [told if held else "nothing could be held to the baseline"]

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

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What the paper's formulas as printed get wrong."""
        printed = (one.examined.printed for one in self.told)
        return tuple(findings([outcome for outcome in printed if outcome is not None]))

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
        published = [
            {"title": one.table.title, "source": one.table.source} | data_of(one.found)
            for one in self.published
        ]
        return {
            "scenes": [
                report.examined_data(one.examined, one.explained)
                if one.file is None
                else examined_data_of(one.examined, one.file)
                for one in self.told
            ],
            "printed_formulas": [report.finding_data(finding) for finding in self.findings],
            "printed_tables": report.paper_data(self.paper) if self.paper else None,
            **({"published_tables": published} if published else {}),
            "tolerance_factor": self.factor,
            "not_run": [] if self.record is None else list(self.record.not_run),
            "baseline": self.baseline,
        }


def named(names: Sequence[str]) -> str:
    """The first names of many."""
    rest = f" and {len(names) - NAMED} more" if len(names) > NAMED else ""
    return ", ".join(names[:NAMED]) + rest
