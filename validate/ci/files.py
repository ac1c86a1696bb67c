"""The files that a run of comparisons leaves for services that decide on it, written when it ends.

Test results and the summary are written however the run ends. A baseline is what later runs are held to, so
that one of a run that was interrupted does not take the place of a whole one.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from validate.ci.baseline import Recorder
from validate.ci.record import Record
from validate.exit_status import ExitStatus
from validate.output.console import Console
from validate.output.document import Ending
from validate.output.files import OutputError


@dataclass(frozen=True)
class Files:
    """Where the results of a run go; None of what is not asked for, `-` of a text for standard output.

    Attributes:
        recorder: keeps what the baseline is made of.
    """

    junit: str | None = None
    summary: str | None = None
    baseline: str | None = None
    recorder: Recorder = field(default_factory=Recorder)

    def write(self, record: Record, ending: Ending, console: Console) -> None:
        """Write the files of a run, if it came to anything.

        Raises:
            OutputError: one of them cannot be written; the others are tried all the same.
        """
        if not record.examined:
            return
        problems: list[OutputError] = []

        def attempt(target: str, content: str | bytes) -> None:
            try:
                console.put(target, content, f"{len(record.examined)} of {len(record.names)} scenes")
            except OutputError as error:
                problems.append(error)

        if self.baseline is not None:
            why = "" if len(self.recorder) else "no scene was compared"
            if why := why if record.ended else "the run did not come to its end":
                console.complain(f"baseline {self.baseline}: not written, because {why}")
            else:
                attempt(self.baseline, self.recorder.content())
        if self.junit is not None:
            # Most runs leave no such files.
            from validate.ci.junit import junit

            attempt(self.junit, junit(record))
        if self.summary is not None:
            from validate.ci.summary import summary

            # It is the last one, so that it can say that another one is not there.
            status = record.status if ending.complete else ending.status
            attempt(self.summary, summary(record, ExitStatus.NOT_FINISHED if problems else status))
        if problems:
            raise problems[0]
