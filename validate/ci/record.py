"""The results of a run so far, without the solved numbers: the source of test results and summary."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, field, replace
from typing import TYPE_CHECKING, Any

from pointcoord import Scene
from validate.ci.baseline import Baseline, Kept, Since, baseline_data
from validate.comparison.compare import Outcome
from validate.comparison.examined import Examined
from validate.comparison.findings import Finding, findings
from validate.exit_status import ExitStatus, combined
from validate.output.report import examined_data, paper_data
from validate.paper.tables import PaperRow

if TYPE_CHECKING:  # most runs compare no file
    from validate.measured.comparing import DataOutcome

CUT_OFF = "the run did not finish"


@dataclass
class Record:
    """A run of comparisons.

    Attributes:
        names: names of all scenes, as shown; the examined ones come first.
        factor: multiple of the derived tolerance that differences are compared with.
        baseline: the baseline that the scenes are compared with, if any.
        examined: the results of each scene, in order.
        since: the comparison of each scene with the baseline.
        files: files of results, by the name of the scene that each is compared with.
        paper: the paper's printed tables compared with computed numbers.
        kept: the content of a baseline of this run, by scene name; None if no baseline is asked for.
        stopped: why the remaining scenes were not run.
    """

    names: Sequence[str]
    factor: float = 1.0
    baseline: Baseline | None = None
    examined: list[Examined] = field(default_factory=list)
    since: list[Since] = field(default_factory=list)
    files: dict[str, DataOutcome] = field(default_factory=dict)
    paper: Sequence[PaperRow] = ()
    kept: dict[str, Kept] | None = None
    stopped: str = CUT_OFF

    def add(self, examined: Examined, since: Since | None = None, scene: Scene | None = None) -> None:
        """Add the results of a scene. Its solved numbers are kept only for a baseline."""
        if self.kept is not None and scene is not None and examined.outcomes:
            self.kept.setdefault(examined.name, Kept.of(scene, examined.outcomes))
        printed = None if examined.printed is None else _emptied(examined.printed)
        outcomes = tuple(map(_emptied, examined.outcomes))
        self.examined.append(replace(examined, outcomes=outcomes, printed=printed))
        if since is not None:
            self.since.append(since)

    @property
    def ended(self) -> bool:
        """Whether the run ended regularly, possibly before its last scene because of --fail-fast."""
        return not self.not_run or self.stopped != CUT_OFF

    @property
    def not_run(self) -> tuple[str, ...]:
        """The scenes that were not run."""
        return tuple(self.names[len(self.examined) :])

    @property
    def gone(self) -> tuple[Since, ...]:
        """The scenes of the baseline that are not in this run."""
        known = {} if self.baseline is None else self.baseline.scenes
        words = "is gone: it is in the baseline and not in this run"
        return tuple(Since(name, "gone", f"{name} {words}") for name in known if name not in self.names)

    @property
    def outcomes(self) -> Iterator[Outcome]:
        """Every comparison of every scene."""
        return (outcome for examined in self.examined for outcome in examined.outcomes)

    @property
    def findings(self) -> tuple[Finding, ...]:
        """The errors of the paper's formulas as printed."""
        return findings([one.printed for one in self.examined if one.printed is not None])

    @property
    def status(self) -> ExitStatus:
        """The exit status of the run; a run that compares nothing with its baseline has no verdict."""
        found = [*(one.status for one in self.examined), *(one.status for one in self.since)]
        if self.baseline is not None and not any(one.compared for one in self.since):
            found.append(ExitStatus.NO_VERDICT)
        return combined(found)

    def data(self) -> dict[str, Any]:
        """The record as plain data."""
        baseline = self.baseline
        return {
            "scenes": [examined_data(one, self.files.get(one.name)) for one in self.examined],
            "printed_formulas": [*map(asdict, self.findings)],
            "printed_tables": paper_data(self.paper) if self.paper else None,
            "tolerance_factor": self.factor,
            "not_run": list(self.not_run),
            "baseline": None if baseline is None else baseline_data(baseline, self.since, self.gone),
        }


def _emptied(outcome: Outcome) -> Outcome:
    """A comparison without the solved numbers that it was made from."""
    one, two = (
        replace(solution, numbers={}, accuracy=replace(solution.accuracy, claims={}, usual={}))
        for solution in outcome.solutions
    )
    return replace(outcome, solutions=(one, two))


def ends_the_run(examined: Examined, since: Since | None) -> bool:
    """Whether a scene ends a run with --fail-fast: it disagrees, has moved, or is refused."""
    disagrees = any(outcome.disagreements for outcome in examined.outcomes)
    moved = since is not None and since.status is ExitStatus.DISAGREE
    return disagrees or moved or bool(examined.complaint)
