"""The files that a run of comparisons leaves, written when it ends.

Test results and the summary are written however the run ends. A baseline is what later runs are held to, so
that one of a run that was interrupted does not take the place of a whole one.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, field

from pointcoord import Scene
from validate.ci.baseline import Recorder
from validate.ci.junit import junit
from validate.ci.record import Record
from validate.ci.summary import summary
from validate.comparison.compare import Outcome
from validate.exit_status import ExitStatus
from validate.output.console import STANDARD_OUTPUT, Console
from validate.output.document import Ending, at_the_end
from validate.output.files import OutputError


@dataclass(frozen=True)
class Files:
    """Where the results of a run go; None of what is not asked for, `-` of a text for standard output."""

    junit: str | None = None
    summary: str | None = None
    baseline: str | None = None
    recorder: Recorder = field(default_factory=Recorder)

    def keep(self, name: str, scene: Scene, outcomes: Sequence[Outcome]) -> None:
        """Take in a scene for the baseline, if there is to be one."""
        if self.baseline is not None:
            self.recorder.add(name, scene, outcomes)

    def closing(self, record: Record, console: Console) -> AbstractContextManager[Ending]:
        """Write the files when a block ends, however it ends, if there is anything to write.

        Raises:
            OutputError: one of them cannot be written; the others are tried all the same. And whatever ends
                the block.
        """

        def write(ending: Ending) -> None:
            if record.examined:
                self._write(record, record.status if ending.complete else ending.status, console)

        return at_the_end(write)

    def _write(self, record: Record, status: ExitStatus, console: Console) -> None:
        problem: OutputError | None = None

        def attempt(target: str, content: str | bytes) -> None:
            nonlocal problem
            try:
                console.put(target, content)
                where = STANDARD_OUTPUT if target == "-" else target
                console.written.append(f"{where} holds {len(record.examined)} of {len(record.names)} scenes")
            except OutputError as error:
                problem = problem or error

        if self.baseline is not None:
            why = "" if len(self.recorder) else "no scene was compared"
            if why := why if record.ended else "the run did not come to its end":
                console.complain(f"baseline {self.baseline}: not written, because {why}")
            else:
                attempt(self.baseline, self.recorder.content())
        if self.junit is not None:
            attempt(self.junit, junit(record))
        if self.summary is not None:
            # It is the last one, so that it can say that another one is not there.
            attempt(self.summary, summary(record, ExitStatus.NOT_FINISHED if problem else status))
        if problem is not None:
            raise problem
