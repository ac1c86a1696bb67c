"""`pointcoord cost`: what accuracy costs in time, measured and shown."""

from __future__ import annotations

import argparse
import os
import shlex
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from pointcoord import UnknownName
from validate.commands.comparing import Page
from validate.commands.usage import (
    STANDARD_INPUT,
    Command,
    load_scene,
    name_of,
    require_input_once,
    require_results,
    told_as,
)
from validate.cost.report import Report
from validate.cost.table import PARTS, Part, Row, Store, StoreError, latest, measured_here
from validate.errors import UsageError
from validate.exit_status import ExitStatus
from validate.extras import needed
from validate.output.console import Console
from validate.output.document import Head, Journal
from validate.output.files import write_content
from validate.output.report import counted_as

if TYPE_CHECKING:
    from validate.cost.study import Study
    from validate.cost.way import Way


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
    page = Page.of(options)
    needed("cost", "pyarrow")
    study = None if options.from_rows else _study(options, parts)
    command = shlex.join(options.command)
    try:
        store = Store(Path(options.rows), measured_here(command)) if study else None
        report = Report.of_file(options.rows, command, options.quick) if study is None else None
    except StoreError as error:
        raise UsageError(f"--rows {error}") from None
    rows = [] if report is None else _chosen_rows(report, parts, options)

    def so_far() -> Report:
        return replace(report or Report(options.rows, command, options.quick, ()), rows=tuple(rows))

    journal = Journal(
        options.json,
        Head.of("cost", options.command, timed=True),
        console,
        lambda: so_far().data(),
        lambda: counted_as(len(rows), "row") if rows else "",
    )
    if store is not None:
        there = f"rows are kept in {options.rows} ({len(store.rows)} there)"
        console.note(f"{there}; a run that is stopped goes on with its scene")
    with journal.closing() as ending:
        if study is not None and store is not None:
            _measure(study, store, rows, options, console)
        ending.status = _told(so_far(), page, options, console)
    return ending.status


def _measure(
    study: Study, store: Store, rows: list[Row], options: argparse.Namespace, console: Console
) -> None:
    """Measure into rows; what was measured is kept and named however it ends."""
    try:
        with console.progress("what accuracy costs") as told:
            rows += needed("cost", "validate.cost.study").measure(study, store, told)
    except BaseException:
        # What was kept before it stopped is in the file only.
        rows[:] = [row for row in latest(store.rows, study.quick) if row.part in study.parts]
        raise
    finally:
        console.written[options.rows] = counted_as(len(store.rows), "row")


def _listing() -> str:
    scenes = needed("cost", "validate.cost.scenes").STUDY_SCENES
    ways: tuple[Way, ...] = needed("cost", "validate.cost.ways.registry").WAYS
    needs = {way.name: f" (needs the package {way.package})" if way.package else "" for way in ways}
    wide = max(map(len, needs))
    lines = ["ways:", *(f"  {way.name.ljust(wide)}  {way.words}{needs[way.name]}" for way in ways)]
    lines += ["scenes of the study; a scene of your own is measured by its file:"]
    return "\n".join([*lines, *(f"  {name}" for name in scenes), f"parts: {', '.join(PARTS)}"])


def _parts(options: argparse.Namespace) -> tuple[Part, ...]:
    if options.parts is not None:
        chosen = _chosen(options.parts, "--parts", "part of the study", PARTS)
        return tuple(part for part in PARTS if part in chosen)
    return ("accuracy",) if options.quick and not options.from_rows else PARTS


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
    usual = (of_study.QUICK_SCENE,) if options.quick else of_study.STUDY_SCENES
    for name in dict.fromkeys(options.scenes or usual):
        with told_as(name_of(name)):
            own = name in of_study.STUDY_SCENES or not options.scenes
            scene = of_study.own_scene(name) if own else load_scene(name)
            scenes.append(of_study.study_scene(name_of(name), scene))
    found: Study = study.Study(parts, tuple(scenes), ways, options.quick)
    return found


def _chosen_rows(report: Report, parts: Sequence[Part], options: argparse.Namespace) -> list[Row]:
    """The rows of a file, chosen as they would be measured."""
    rows = [row for row in report.rows if row.part in parts]
    # A scene without its effects is named after a comma.
    there = [*dict.fromkeys(row.scene for row in rows if row.scene)]
    chosen: set[str] = set()
    for name in map(name_of, options.scenes):
        about = {one for one in there if f"{one}, ".startswith(f"{name}, ")}
        if not about:
            raise UnknownName(f"scene of the rows in {options.rows}", name, there)
        chosen |= about
    rows = [row for row in rows if not chosen or row.scene in chosen]
    if options.ways is not None:
        known = [*dict.fromkeys(row.way for row in rows)]
        asked = _chosen(options.ways, "--ways", f"way in the rows of {options.rows}", known)
        rows = [row for row in rows if row.way in asked]
    return rows


def _told(report: Report, page: Page | None, options: argparse.Namespace, console: Console) -> ExitStatus:
    """Say and write the report, its JSON apart; the status is that of a run that comes to its end."""
    console.show(report.parts())
    if options.csv:
        console.put(options.csv, report.csv(), "the rows")
    if page is not None:
        # Most runs write no page.
        from validate.html.page import make_folder
        from validate.html.run import Run

        make_folder(page.folder)
        for name, written in report.files():
            write_content(os.path.join(page.folder, name), written)
        page.write(Run(Head.of("cost", options.command), cost=report), console)
    elif not options.from_rows and not console.quiet and not console.mute:
        _draw_beside(options.rows, report, console)
    if not report.measured:
        console.complain(f"nothing could be measured; {options.rows} says why, row by row")
    return ExitStatus.AGREE if report.measured else ExitStatus.NO_VERDICT


def _draw_beside(rows: str, report: Report, console: Console) -> None:
    """The picture, beside the file of rows."""
    place = str(Path(rows).with_suffix(".svg"))
    try:
        content = report.headline()
    except ImportError:
        console.note("there is no picture of it: pip install 'pointcoord[plot]' brings matplotlib")
        return
    if content is not None:
        console.put(place, content, "the picture")
        console.say(f"the picture: {place}")


COMMANDS = {"cost": Command(run, {"parts": ", ".join(PARTS)})}
