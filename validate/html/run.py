"""What a report is about: the scenes of a run with all that came of them, and where it was done."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from pointcoord import Motion, Scene
from validate.comparison.examined import Examined
from validate.comparison.findings import Finding, findings
from validate.diagnosis import Explanation
from validate.exit_status import ExitStatus, combined
from validate.output import report
from validate.output.document import Head
from validate.paper.tables import PaperRow


@dataclass(frozen=True)
class Told:
    """One scene of the run.

    Attributes:
        scene: None where its file could not be read.
        motion: as pointcoord solves it, or the part that could be solved; None if nothing could.
        explained: of each of its comparisons, what would explain that it disagrees.
    """

    examined: Examined
    scene: Scene | None
    motion: Motion | None = None
    explained: tuple[Sequence[Explanation], ...] = ()

    @property
    def verdict(self) -> str:
        """In one of the words of a verdict: a scene of which nothing can be said is not tested."""
        status = self.examined.status
        if status is ExitStatus.AGREE:
            return "agrees"
        return "disagrees" if status is ExitStatus.DISAGREE else "not tested"


@dataclass(frozen=True)
class Run:
    """All that a report is made of.

    Attributes:
        told: its scenes. factor: how many times the derived tolerance differences are held to.
        paper: the paper's printed tables beside ours, where they were asked for.
    """

    head: Head
    told: tuple[Told, ...]
    factor: float = 1.0
    paper: tuple[PaperRow, ...] = ()

    @property
    def status(self) -> ExitStatus:
        """What the run ends with."""
        return combined(one.examined.status for one in self.told)

    @property
    def sentence(self) -> str:
        """The verdict in a sentence; what does not agree is named."""
        count = len(self.told)
        by_verdict: dict[str, list[str]] = {}
        for one in self.told:
            by_verdict.setdefault(one.verdict, []).append(one.examined.name)
        agreeing = len(by_verdict.pop("agrees", ()))
        noun, verb = ("scene", "agrees") if count == 1 else ("scenes", "agree")
        parts = [f"{agreeing} of {count} {noun} {verb}"]
        parts += [f"{verdict}: {', '.join(names)}" for verdict, names in sorted(by_verdict.items())]
        if self.factor != 1.0:
            parts.append(report.held_to(self.factor))
        return f"{'; '.join(parts)}."

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What the paper's formulas as printed get wrong."""
        printed = (one.examined.printed for one in self.told)
        return tuple(findings([outcome for outcome in printed if outcome is not None]))

    @property
    def document(self) -> Mapping[str, Any]:
        """The run as plain data, in the form of `validate --json`."""
        results = {
            "scenes": [report.examined_data(one.examined, one.explained) for one in self.told],
            "printed_formulas": [report.finding_data(finding) for finding in self.findings],
            "printed_tables": report.paper_data(self.paper) if self.paper else None,
            "tolerance_factor": self.factor,
            "not_run": [],
            "baseline": None,
        }
        return self.head.document(results, self.status, complete=True)
