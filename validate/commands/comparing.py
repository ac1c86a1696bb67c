"""What every run of comparisons does: the files and the page that it leaves, however it ends."""

from __future__ import annotations

import argparse
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

from pointcoord import Scene
from validate.ci.baseline import Since, written
from validate.ci.record import Record
from validate.comparison.examined import Examined
from validate.errors import NotFinished, UsageError
from validate.exit_status import ExitStatus
from validate.extras import needed
from validate.output.console import Console
from validate.output.document import Ending, Head, Journal, at_the_end
from validate.output.report import share_of_all
from validate.plain_text import shown

# What a page is made of is imported where one is made: most runs make none.
if TYPE_CHECKING:
    from validate.html.run import Drawings, Run


RESULTS = ("--json", "--junit", "--summary", "--save-baseline")
"""The files that a run of comparisons may leave."""


@dataclass(frozen=True)
class Page:
    """Where the page of a run goes.

    Attributes:
        with_more: of `pointcoord report`, adds to a run what else is computed for its page; such a run says
            nothing but the verdict in a sentence, and where the page is.
    """

    folder: str
    with_more: Callable[[Run], Run] | None = None

    @classmethod
    def of(cls, options: argparse.Namespace) -> Page | None:
        """The page that `--report` asks for, if it does, found to be possible before anything is solved.

        Raises:
            MissingLibrary: a page needs the extra `report`.
            UsageError: the folder has no name, or cannot be a report's.
            NotFinished: it cannot be written.
        """
        if options.report is None:
            return None
        from validate.html.page import require_folder

        if not options.report.strip():
            option = "" if "folder" in options else "--report "
            raise UsageError(
                f"{option}{options.report!r} names no folder; give the path of one, which is made if needed"
            )
        for package in ("jinja2", "plotly.offline"):
            needed("report", package, "report")
        require_folder(options.report)
        return cls(options.report, getattr(options, "with_more", None))

    @property
    def place(self) -> str:
        """The page itself, for people."""
        return shown(os.path.join(self.folder, "index.html"))

    def write(self, run: Run, console: Console) -> Run:
        """Write the page of a run; returns it with what the page holds beside it."""
        from validate.html.page import write_report

        whole = run if self.with_more is None else self.with_more(run)
        write_report(self.folder, whole)
        console.written[self.place] = "the report"
        return whole


@dataclass(frozen=True)
class Comparing:
    """A run of comparisons that goes on; `ending.status` is what it ended with.

    Attributes:
        drawings: what a page is made of; None where none is asked for.
    """

    record: Record
    journal: Journal
    drawings: Drawings | None
    ending: Ending

    def add(self, examined: Examined, since: Since | None = None, scene: Scene | None = None) -> None:
        """Take in what came of a scene, and write what there is so far."""
        self.record.add(examined, since, scene)
        # Of a file's scene no motion is solved.
        if self.drawings is not None and examined.name not in self.record.files:
            self.drawings.add(examined, scene)
        self.journal.keep()


@contextmanager
def comparing(
    options: argparse.Namespace, console: Console, record: Record, noun: str = "scene"
) -> Iterator[Comparing]:
    """A run of comparisons; its files are written however it ends, its page if it comes to its end.

    Raises:
        MissingLibrary, UsageError: there can be no page. NotFinished: a result cannot be written.
    """
    drawings, page = None, Page.of(options)
    if page is not None:
        from validate.html.run import Drawings, Run

        drawings = Drawings(len(record.names))
    head = Head.of("validate", options.command, options.timings)
    record.kept = None if options.save_baseline is None else {}
    journal = Journal(
        options.json, head, console, record.data, lambda: share_of_all(record.examined, record.names, noun)
    )

    def leave(end: Ending) -> None:
        _leave_files(options, record, end, console)

    mute, brief = console.mute, page is not None and page.with_more is not None
    console.mute = mute or brief
    with journal.closing() as ending, at_the_end(leave):
        yield Comparing(record, journal, drawings, ending)
        ending.status = record.status
        if page is not None and drawings is not None:
            made = page.write(Run(head, record, drawings.kept), console)
            ending.status = made.status
            console.mute = mute
            if brief:
                console.say(f"{made.sentence}\n{page.place}")


def _leave_files(options: argparse.Namespace, record: Record, ending: Ending, console: Console) -> None:
    """Write what services read, however the run ends, if it came to anything; a baseline of a whole run only.

    Raises:
        NotFinished: one of them cannot be written; the others are tried all the same.
    """
    if not record.examined:
        return
    problems: list[NotFinished] = []

    def attempt(target: str, content: str | bytes) -> None:
        try:
            console.put(target, content, f"{len(record.examined)} of {len(record.names)} scenes")
        except NotFinished as error:
            problems.append(error)

    if record.kept is not None:
        why = "" if record.kept else "no scene was compared"
        if why := why if record.ended else record.stopped:
            console.complain(f"baseline {options.save_baseline}: not written, because {why}")
        else:
            attempt(options.save_baseline, written(record.kept))
    # Most runs leave no such files.
    if options.junit is not None:
        from validate.ci.junit import junit

        attempt(options.junit, junit(record))
    if options.summary is not None:
        from validate.ci.summary import summary

        # It is the last one, so that it can say that another one is not there.
        status = record.status if ending.complete else ending.status
        attempt(options.summary, summary(record, ExitStatus.NOT_FINISHED if problems else status))
    if problems:
        raise problems[0]
