"""`pointcoord cost`: what accuracy costs in time, measured and shown."""

from __future__ import annotations

import argparse
import os
import shlex
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from pointcoord import UnknownName
from validate.commands.comparing import Page
from validate.commands.usage import (
    SCENE_HELP,
    STANDARD_INPUT,
    Commands,
    add_json,
    load_scene,
    name_of,
    require_input_once,
    require_results,
    share,
    told_as,
    write_result,
)
from validate.cost.report import Report
from validate.cost.table import PARTS, Part, Row, Store, StoreError, latest, measured_here
from validate.errors import UsageError
from validate.exit_status import ExitStatus
from validate.extras import needed
from validate.output.console import Console
from validate.output.document import Head, Journal
from validate.output.files import write_content
from validate.output.progress import progress
from validate.output.report import counted_as

if TYPE_CHECKING:
    from validate.cost.study import Study
    from validate.cost.way import Way

ROWS = "pointcoord-cost.parquet"

DESCRIPTION = """\
What accuracy costs in time: every way to solve a scene, over the range of its settings, compared with
a many-digit reference. Three sentences say who is quickest, what a digit costs and where others
win; a picture shows error against time; tables hold the rest, and how time and memory grow with
instants, designs and unknowns.

What is measured is kept in a Parquet file, a row for each number: a run that is stopped goes on
with the scene that it was in, and --from-rows makes the report again without measuring."""


def add(commands: Commands) -> None:
    """Add the command with its options."""
    parser = commands.add_parser(
        "cost", help="measure and show what accuracy costs in time", description=DESCRIPTION
    )
    parser.add_argument(
        "scenes", nargs="*", metavar="SCENE", help=f"{SCENE_HELP}; none: the scenes of the study"
    )
    parser.add_argument("--list", action="store_true", help="name the ways, scenes and parts, and end")
    parser.add_argument(
        "--quick", action="store_true", help="a first look at one scene: its accuracy, in under a minute"
    )
    parser.add_argument("--ways", metavar="A,B", help="measure these ways only; --list names them")
    parser.add_argument(
        "--parts",
        metavar="A,B",
        help=f"of {', '.join(PARTS)}; both if not given, with --quick accuracy",
    )
    parser.add_argument(
        "--rows", metavar="FILE", default=ROWS, help=f"keeps what is measured; {ROWS} if not given"
    )
    parser.add_argument(
        "--from-rows", action="store_true", help="report what the file holds, and measure nothing"
    )
    add_json(parser, "everything")
    parser.add_argument("--csv", metavar="FILE", help="write every row as CSV; - for standard output")
    pictures = ", the picture, all tables as Markdown and CSV, and the rows as JSON into a folder"
    share(parser, "--report", help=f"write a page of HTML that needs no network{pictures}")
    share(parser, "--quiet")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Measure what the file of rows does not hold yet, and report."""
    require_input_once(options.scenes)
    if options.rows == STANDARD_INPUT or not options.rows.strip():
        raise UsageError(f"--rows {options.rows!r} names no file; allowed: the path of a file")
    results, read = {"--json": options.json, "--csv": options.csv}, [*options.scenes]
    if options.from_rows or options.list:
        read.append(options.rows)
    else:
        results["--rows"] = options.rows
    require_results(results, read, options, console)
    if options.list:
        console.say(_listing())
        return ExitStatus.AGREE
    parts = _parts(options)
    if options.report is not None:
        needed("--report", "matplotlib", "plot")
        Page(options.report).require()
    needed("cost", "pyarrow")
    journal = Journal(options.json, Head.of("cost", options.command, timed=True), console)
    if options.from_rows:
        report = _from_rows(options, parts)
        status = _told(report, options, console)
        journal.close(report.data, status, True, counted_as(len(report.rows), "row"))
        return status
    study = _study(options, parts)
    try:
        store = Store(Path(options.rows), measured_here(shlex.join(options.command)))
    except StoreError as error:
        raise UsageError(f"--rows {error}") from None
    return _measured(study, store, options, journal, console)


def _listing() -> str:
    """Ways, scenes and parts by name."""
    scenes = needed("cost", "validate.cost.scenes").STUDY_SCENES
    ways: tuple[Way, ...] = needed("cost", "validate.cost.ways.registry").WAYS
    needs = {way.name: f" (needs the package {way.package})" if way.package else "" for way in ways}
    wide = max(map(len, needs))
    lines = ["ways:", *(f"  {way.name.ljust(wide)}  {way.words}{needs[way.name]}" for way in ways)]
    lines += ["scenes of the study; a scene of your own is measured by its file:"]
    return "\n".join([*lines, *(f"  {name}" for name in scenes), f"parts: {', '.join(PARTS)}"])


def _parts(options: argparse.Namespace) -> tuple[Part, ...]:
    """The parts that are asked for, in their order."""
    if options.parts is None and options.quick and not options.from_rows:
        return ("accuracy",)
    if options.parts is None:
        return PARTS
    return tuple(
        part for part in PARTS if part in _chosen(options.parts, "--parts", "part of the study", PARTS)
    )


def _chosen(words: str, option: str, what: str, allowed: Sequence[str]) -> list[str]:
    """Names that an option lists."""
    names = [word.strip() for word in words.split(",") if word.strip()]
    if not names:
        raise UsageError(f"{option} {words!r} names nothing; there are: {', '.join(allowed)}")
    for name in names:
        if name not in allowed:
            raise UnknownName(what, name, allowed)
    return names


def _study(options: argparse.Namespace, parts: tuple[Part, ...]) -> Study:
    """What is to be measured; everything is found before anything is measured."""
    of_study = needed("cost", "validate.cost.scenes")
    registry = needed("cost", "validate.cost.ways.registry")
    study = needed("cost", "validate.cost.study")
    ways = registry.WAYS
    if options.ways is not None:
        ways = registry.ways_named(_chosen(options.ways, "--ways", "way", [way.name for way in ways]))
    scenes = []
    for name in dict.fromkeys(options.scenes):
        with told_as(name_of(name)):
            own = name in of_study.STUDY_SCENES
            scene = of_study.own_scene(name) if own else load_scene(name)
            scenes.append(of_study.study_scene(name_of(name), scene))
    if not scenes:
        names = (of_study.QUICK_SCENE,) if options.quick else of_study.STUDY_SCENES
        scenes = [of_study.study_scene(name, of_study.own_scene(name)) for name in names]
    found: Study = study.Study(parts, tuple(scenes), ways, options.quick)
    return found


def _measured(
    study: Study, store: Store, options: argparse.Namespace, journal: Journal, console: Console
) -> ExitStatus:
    """Measure, and report; what was measured is kept and named however it ends."""
    there = f"rows are kept in {options.rows} ({len(store.rows)} there)"
    console.note(f"{there}; a run that is stopped goes on with its scene")

    def report(rows: Iterable[Row]) -> Report:
        return Report(options.rows, shlex.join(options.command), options.quick, tuple(rows))

    rows: list[Row] = []
    try:
        with journal.closing(
            lambda: report(rows).data(), lambda: rows, lambda: counted_as(len(rows), "row")
        ) as ending:
            try:
                with progress(console, "what accuracy costs") as told:
                    rows += needed("cost", "validate.cost.study").measure(study, store, told)
            except BaseException:
                # What was kept before it stopped is in the file only.
                rows[:] = [row for row in latest(store.rows, study.quick) if row.part in study.parts]
                raise
            ending.status = _told(report(rows), options, console)
    finally:
        console.written.insert(0, f"{options.rows} holds {counted_as(len(store.rows), 'row')}")
    return ending.status


def _from_rows(options: argparse.Namespace, parts: tuple[Part, ...]) -> Report:
    """The rows of a file, chosen as they would be measured."""
    try:
        report = Report.of_file(options.rows, shlex.join(options.command), options.quick)
    except StoreError as error:
        raise UsageError(f"--rows {error}") from None
    rows = [row for row in report.rows if row.part in parts]
    if options.scenes:
        names = [name_of(name) for name in options.scenes]
        there = [*dict.fromkeys(row.scene for row in rows if row.scene)]
        # A scene without its effects is named after a comma.
        about = {name: [one for one in there if f"{one}, ".startswith(f"{name}, ")] for name in names}
        for name in names:
            if not about[name]:
                raise UnknownName(f"scene of the rows in {options.rows}", name, there)
        rows = [row for row in rows if any(row.scene in about[name] for name in names)]
    if options.ways is not None:
        there = [*dict.fromkeys(row.way for row in rows)]
        asked = _chosen(options.ways, "--ways", f"way in the rows of {options.rows}", there)
        rows = [row for row in rows if row.way in asked]
    return replace(report, rows=tuple(rows))


def _told(report: Report, options: argparse.Namespace, console: Console) -> ExitStatus:
    """Say and write the report, its JSON apart; the status is that of a run that comes to its end."""
    status = ExitStatus.AGREE if report.measured else ExitStatus.NO_VERDICT
    console.show(report.parts())
    if options.csv:
        write_result(options.csv, report.csv(), "the rows", console)
    if options.report:
        # Most runs write no page.
        from validate.html.folder import make_folder
        from validate.html.run import Run

        make_folder(options.report)
        for name, written in report.files():
            write_content(os.path.join(options.report, name), written)
        Page(options.report).write(Run(Head.of("cost", options.command), cost=report), console)
    elif not options.from_rows and not console.quiet and not console.mute:
        place = Path(options.rows).with_suffix(".svg")
        try:
            content = report.headline()
        except ImportError:
            content = None
            console.note("there is no picture of it: pip install 'pointcoord[plot]' brings matplotlib")
        if content is not None:
            write_content(str(place), content)
            console.written.append(f"{place} holds the picture")
            console.say(f"the picture: {place}")
    if not report.measured:
        console.complain(f"nothing could be measured; {options.rows} says why, row by row")
    return status
