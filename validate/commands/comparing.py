"""A run of comparisons: writes its result files and its HTML page, however the run ends."""

from __future__ import annotations

import argparse
import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
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


def page_folder(options: argparse.Namespace) -> str | None:
    """The folder of the page that `--report` asks for, or None. Checked before anything is solved.

    Raises:
        MissingLibrary: the extra `report`, which a page needs, is not installed.
        UsageError: the folder has no name, or cannot be used for a report.
        NotFinished: the folder cannot be written.
    """
    if options.report is None:
        return None
    from validate.html.page import require_folder

    if not options.report.strip():
        option = "" if "folder" in options else "--report "
        raise UsageError(
            f"{option}{options.report!r} names no folder; give the path of a folder; it is made if needed"
        )
    for package in ("jinja2", "plotly.offline"):
        needed("report", package)
    require_folder(options.report)
    return str(options.report)


def write_page(folder: str, run: Run, console: Console) -> str:
    """Write the page of a run; returns its path, as printed."""
    from validate.html.page import write_report

    write_report(folder, run)
    place = shown(os.path.join(folder, "index.html"))
    console.written[place] = "the report"
    return place


@dataclass(frozen=True)
class Comparing:
    """A run of comparisons in progress.

    Attributes:
        journal: `journal.status` is the exit status of the run.
        drawings: the curves and pictures of the scenes for the page; None if there is no page.
    """

    record: Record
    journal: Journal
    drawings: Drawings | None

    def add(self, examined: Examined, since: Since | None = None, scene: Scene | None = None) -> None:
        """Add the results of a scene, which the page draws if it is given, and write all results so far."""
        self.record.add(examined, since, scene)
        if self.drawings is not None:
            self.drawings.add(examined, scene)
        self.journal.keep()


@contextmanager
def comparing(
    options: argparse.Namespace, console: Console, record: Record, noun: str = "scene"
) -> Iterator[Comparing]:
    """A run of comparisons. Its files are written however it ends; its page only after a whole run.

    `pointcoord report` gives `options.with_more`, which adds further results to the run for its page. Such a
    run prints only a sentence with the verdict, and the path of the page.

    Raises:
        MissingLibrary, UsageError: the page cannot be made. NotFinished: a result cannot be written.
    """
    folder, with_more = page_folder(options), getattr(options, "with_more", None)
    record.kept = None if options.save_baseline is None else {}
    mute, console.mute = console.mute, console.mute or with_more is not None

    def done() -> str:
        return share_of_all(record.examined, record.names, noun)

    def leave(journal: Journal) -> None:
        _leave_files(options, record, console, journal)

    with Journal.of(options, console, "validate", record.data, done, leave) as journal:
        if folder is None:
            yield Comparing(record, journal, None)
            journal.status = record.status
            return
        from validate.html.run import Drawings, Run

        drawings = Drawings(len(record.names))
        yield Comparing(record, journal, drawings)
        run = Run(journal.head, record, drawings.kept)
        run = run if with_more is None else with_more(run)
        place, journal.status = write_page(folder, run, console), run.status
        console.mute = mute
        if with_more is not None:
            console.say(f"{run.sentence}\n{place}")


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
        if record.ended and record.kept:
            console.put(options.save_baseline, written(record.kept), what)
        else:
            why = "no scene was compared" if record.ended else record.stopped
            console.complain(f"baseline {options.save_baseline}: not written, because {why}")
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
