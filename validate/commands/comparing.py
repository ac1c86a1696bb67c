"""A run of comparisons: writes its result files and its HTML page, however the run ends."""

from __future__ import annotations

import argparse
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from pointcoord import Scene
from validate.ci.baseline import Since, written
from validate.ci.record import Record
from validate.comparison.examined import Examined
from validate.errors import UsageError
from validate.extras import needed
from validate.output.console import Console
from validate.output.document import Journal
from validate.output.report import share_of_all
from validate.plain_text import shown

# The modules of the HTML page are imported only where a page is made: most runs make none.
if TYPE_CHECKING:
    from validate.html.run import Drawings, Run


@dataclass(frozen=True)
class Page:
    """The HTML page of a run.

    Attributes:
        folder: where it is written.
        drawings: the curves and pictures of the scenes.
        with_more: for `pointcoord report`: adds further results to the run for its page. Such a run prints
            only a sentence with the verdict, and the path of the page.
    """

    folder: str
    drawings: Drawings
    with_more: Callable[[Run], Run] | None = None

    @classmethod
    def of(cls, options: argparse.Namespace, scenes: int = 0) -> Page | None:
        """The page that `--report` asks for, or None. Checked before anything is solved.

        Args:
            scenes: number of scenes of the run.
        Raises:
            MissingLibrary: the extra `report`, which a page needs, is not installed.
            UsageError: the folder has no name, or cannot be used for a report.
            NotFinished: the folder cannot be written.
        """
        if options.report is None:
            return None
        from validate.html.page import require_folder
        from validate.html.run import Drawings

        if not options.report.strip():
            option = "" if "folder" in options else "--report "
            raise UsageError(
                f"{option}{options.report!r} names no folder; give the path of a folder; it is made if needed"
            )
        for package in ("jinja2", "plotly.offline"):
            needed("report", package)
        require_folder(options.report)
        return cls(options.report, Drawings(scenes), getattr(options, "with_more", None))

    @property
    def place(self) -> str:
        """The path of the page, as printed."""
        return shown(os.path.join(self.folder, "index.html"))

    def write(self, run: Run, console: Console) -> Run:
        """Write the page of a run; returns the run with the results that `with_more` added."""
        from validate.html.page import write_report

        whole = run if self.with_more is None else self.with_more(run)
        write_report(self.folder, whole)
        console.written[self.place] = "the report"
        return whole


@dataclass(frozen=True)
class Comparing:
    """A run of comparisons in progress; `journal.status` is its exit status."""

    record: Record
    journal: Journal
    page: Page | None

    def add(self, examined: Examined, since: Since | None = None, scene: Scene | None = None) -> None:
        """Add the results of a scene, which the page draws if it is given, and write all results so far."""
        self.record.add(examined, since, scene)
        if self.page is not None:
            self.page.drawings.add(examined, scene)
        self.journal.keep()


@contextmanager
def comparing(
    options: argparse.Namespace, console: Console, record: Record, noun: str = "scene"
) -> Iterator[Comparing]:
    """A run of comparisons. Its files are written however it ends; its page only after a whole run.

    Raises:
        MissingLibrary, UsageError: the page cannot be made. NotFinished: a result cannot be written.
    """
    page = Page.of(options, len(record.names))
    record.kept = None if options.save_baseline is None else {}
    what = partial(share_of_all, record.examined, record.names, noun)
    journal = Journal.of(options, console, "validate", record.data, what)
    mute, brief = console.mute, page is not None and page.with_more is not None
    console.mute = mute or brief
    with journal.closing(), journal.closing(partial(_leave_files, options, record, console, journal)):
        yield Comparing(record, journal, page)
        journal.status = record.status
        if page is not None:
            from validate.html.run import Run

            made = page.write(Run(journal.head, record, page.drawings.kept), console)
            journal.status = made.status
            console.mute = mute
            if brief:
                console.say(f"{made.sentence}\n{page.place}")


def _leave_files(options: argparse.Namespace, record: Record, console: Console, journal: Journal) -> None:
    """Write JUnit, summary and baseline if any scene was examined; the baseline only after a whole run.

    A cut-off run says that its page is not written.

    Raises:
        NotFinished: a file cannot be written.
    """
    if not record.examined:
        return
    what = f"{len(record.examined)} of {len(record.names)} scenes"
    if record.kept is not None:
        why = "" if record.kept else "no scene was compared"
        if why := why if record.ended else record.stopped:
            console.complain(f"baseline {options.save_baseline}: not written, because {why}")
        else:
            console.put(options.save_baseline, written(record.kept), what)
    # Imported here: most runs do not write these files.
    if options.junit is not None:
        from validate.ci.junit import junit

        console.put(options.junit, junit(record), what)
    if options.summary is not None:
        from validate.ci.summary import summary

        status = record.status if journal.complete else journal.status
        console.put(options.summary, summary(record, status), what)
    if options.report is not None and not record.ended:
        console.complain(f"report {shown(options.report)}: not written, because {record.stopped}")
