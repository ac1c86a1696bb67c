"""`pointcoord cost`: measures run time against accuracy, and reports it."""

from __future__ import annotations

import argparse
import os
import shlex
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from validate.commands.comparing import page_folder, write_page
from validate.commands.pages import Command
from validate.commands.usage import STANDARD_INPUT, given, load_scene, name_of, named_scene
from validate.cost.report import Report
from validate.cost.table import frame, measured_here
from validate.errors import UsageError
from validate.exit_status import ExitStatus
from validate.extras import needed
from validate.output.console import Console
from validate.output.document import Head, Journal
from validate.output.files import write_content
from validate.plain_text import counted_as

if TYPE_CHECKING:
    from validate.cost.study import Study


def run(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Measure, keep the rows, and report; or report the rows of a file."""
    if options.rows == STANDARD_INPUT or not options.rows.strip():
        raise UsageError(f"--rows {options.rows!r} names no file; allowed: the path of a file")
    if options.from_rows and (more := given(options, "scenes", "--ways", "--quick")):
        what = "SCENE" if more[0] == "scenes" else more[0]
        raise UsageError(f"--from-rows shows all rows of {options.rows}; leave {what} out")
    for package in ("pandas", "pyarrow", *(["matplotlib"] if options.report is not None else [])):
        needed("cost", package)
    folder, command = page_folder(options), shlex.join(options.command)
    if options.from_rows:
        study, report = None, Report.of_file(options.rows, command)
    else:
        study, report = _study(options, command), Report(options.rows, command, ())

    def rows_so_far() -> str:
        return counted_as(len(report.rows), "row") if report.rows else ""

    with Journal.of(options, console, "cost", lambda: report.data(), rows_so_far) as journal:
        if study is not None:
            from validate.cost.study import measure

            with console.progress("cost", everywhere=True) as progress:
                for rows in measure(study, progress):
                    report = replace(report, rows=(*report.rows, *rows))
                    write_content(options.rows, frame(report.rows).to_parquet())
                    console.written[options.rows] = rows_so_far()
        console.show(report.parts())
        if options.csv is not None:
            console.put(options.csv, report.csv(), "the rows")
        if folder is not None:
            # Imported here: most runs write no page.
            from validate.html.page import make_folder
            from validate.html.run import Run

            make_folder(folder)
            if (picture := report.headline()) is not None:
                write_content(os.path.join(folder, "headline.svg"), picture)
            write_page(folder, Run(Head.of("cost", options.command), cost=report), console)
        elif study is not None and not console.quiet and not console.mute:
            _draw_beside(options.rows, report, console)
        if not report.measured:
            console.complain(f"nothing could be measured; {options.rows} says why, row by row")
            journal.status = ExitStatus.NO_VERDICT
    return journal.status


def _study(options: argparse.Namespace, command: str) -> Study:
    """The study to measure. All scenes and methods are loaded before anything is measured."""
    # Imported here: the study of cost needs packages that a report of its rows does not need.
    from validate.cost.scenes import QUICK_SCENE, STUDY_SCENES, own_scene, with_rates
    from validate.cost.study import Study
    from validate.cost.ways.registry import NAMES, WAYS, ways_named

    ways = WAYS
    if options.ways is not None:
        names = [word.strip() for word in options.ways.split(",") if word.strip()]
        if not names:
            raise UsageError(f"--ways {options.ways!r} names nothing; there are: {', '.join(NAMES)}")
        ways = ways_named(names)
    scenes = {}
    usual = (QUICK_SCENE,) if options.quick else STUDY_SCENES
    for name in dict.fromkeys(options.scenes or usual):
        own = name in STUDY_SCENES or not options.scenes
        with named_scene(name, own_scene if own else load_scene) as (scene, _):
            scenes[name_of(name)] = with_rates(scene)
    return Study(scenes, ways, measured_here(command), options.quick)


def _draw_beside(rows: str, report: Report, console: Console) -> None:
    """Write the picture next to the file of rows."""
    place = str(Path(rows).with_suffix(".svg"))
    try:
        content = report.headline()
    except ImportError:
        console.note("no picture is written: matplotlib is missing; pip install 'pointcoord[plot]'")
        return
    if content is not None:
        console.put(place, content, "the picture")
        console.say(f"the picture: {place}")


COMMANDS = {"cost": Command(run)}
