"""The files that a run of comparisons leaves: found to be writable before it, and written when it ends.

Test results and the summary are written however the run ends. A baseline is what later runs are held to, so
that one of a run that was interrupted does not take the place of a whole one.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass

from validate.ci.baseline import Recorder
from validate.ci.junit import junit
from validate.ci.record import Record
from validate.ci.summary import summary
from validate.exit_status import ExitStatus
from validate.output.console import STANDARD_OUTPUT, Console
from validate.output.document import Ending, at_the_end
from validate.output.files import OutputError, require_writable


@dataclass(frozen=True)
class Files:
    """Where the results of a run go; None of what is not asked for, `-` of a text for standard output."""

    junit: str | None = None
    summary: str | None = None
    baseline: str | None = None

    def require_writable(self) -> None:
        """Refuse what cannot be written, before anything is solved.

        Raises:
            OutputError: it cannot be.
        """
        for target in (self.junit, self.summary, self.baseline):
            if target is not None and target != "-":
                require_writable(target)

    def closing(
        self, record: Record, recorder: Recorder | None, console: Console
    ) -> AbstractContextManager[Ending]:
        """Write the files when a block ends, however it ends, if there is anything to write.

        Raises:
            OutputError: one of them cannot be written; the others are tried all the same. And whatever ends
                the block.
        """

        def write(ending: Ending) -> None:
            if record.examined:
                self._write(record, recorder, record.status if ending.complete else ending.status, console)

        return at_the_end(write)

    def _write(self, record: Record, recorder: Recorder | None, status: ExitStatus, console: Console) -> None:
        problem: OutputError | None = None

        def attempt(target: str, write: Callable[[], None]) -> None:
            nonlocal problem
            try:
                write()
                where = STANDARD_OUTPUT if target == "-" else target
                console.written.append(f"{where} holds {len(record.examined)} of {len(record.names)} scenes")
            except OutputError as error:
                problem = problem or error

        if self.baseline is not None and recorder is not None:
            target, keep = self.baseline, recorder
            if not record.ended:
                console.complain(f"baseline {target}: not written, because the run did not come to its end")
            elif not len(keep):
                console.complain(f"baseline {target}: not written, because no scene was compared")
            else:
                attempt(target, lambda: keep.write(target))
        if self.junit is not None:
            place, data = self.junit, junit(record)
            attempt(place, lambda: console.put(place, data))
        if self.summary is not None:
            # It is the last one, so that it can say that another one is not there.
            where, text = self.summary, summary(record, ExitStatus.NOT_FINISHED if problem else status)
            attempt(where, lambda: console.put(where, text))
        if problem is not None:
            raise problem
