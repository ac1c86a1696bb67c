"""The files that a run of comparisons leaves: found to be writable before it, and written when it ends.

Test results and the summary are written however the run ends. A baseline is what later runs are held to, so
that one of a run that was interrupted does not take the place of a whole one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from validate.ci.baseline import Recorder
from validate.ci.junit import junit
from validate.ci.record import Record
from validate.ci.summary import summary
from validate.exit_status import ExitStatus
from validate.output.console import STANDARD_OUTPUT, Console
from validate.output.files import OutputError, require_writable, write_content


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

    @contextmanager
    def closing(self, record: Record, recorder: Recorder | None, console: Console) -> Iterator[None]:
        """Write the files when the block ends, however it ends, if there is anything to write.

        Raises:
            OutputError: one of them cannot be written; the others are tried all the same. And whatever ends
                the block.
        """
        status = ExitStatus.INTERRUPTED
        try:
            yield
            status = ExitStatus.NOT_FINISHED if record.ended is None else record.ended
        except KeyboardInterrupt:
            raise
        except BaseException:
            status = ExitStatus.NOT_FINISHED
            raise
        finally:
            if record.examined:
                self._write(record, recorder, status, console)

    def _write(self, record: Record, recorder: Recorder | None, status: ExitStatus, console: Console) -> None:
        problem: OutputError | None = None
        holds = f"holds {len(record.examined)} of {len(record.names)} scenes"

        def attempt(target: str, write: Callable[[], object]) -> None:
            nonlocal problem
            try:
                write()
                console.written.append(f"{STANDARD_OUTPUT if target == '-' else target} {holds}")
            except OutputError as error:
                problem = problem or error

        if self.baseline is not None and recorder is not None:
            target, keep = self.baseline, recorder
            if record.ended is None:
                console.complain(f"baseline {target}: not written, because the run did not come to its end")
            elif not len(keep):
                console.complain(f"baseline {target}: not written, because no scene was compared")
            else:
                attempt(target, lambda: keep.write(target))
        if self.junit is not None:
            place, data = self.junit, junit(record)
            attempt(place, lambda: _put(place, data, console))
        if self.summary is not None:
            # It is the last one, so that it can say that another one is not there.
            where, text = self.summary, summary(record, ExitStatus.NOT_FINISHED if problem else status)
            attempt(where, lambda: _put(where, text.encode(), console))
        if problem is not None:
            raise problem


def _put(target: str, data: bytes, console: Console) -> None:
    if target == "-":
        console.write(data.decode())
        console.flush()
    else:
        write_content(target, data)
