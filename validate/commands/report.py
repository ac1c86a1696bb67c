"""`pointcoord report`: scenes validated, and what came of it as a page with its data."""

from __future__ import annotations

import argparse
import os
import shlex
from dataclasses import replace
from functools import partial
from pathlib import Path

from pointcoord import built_in_scenes
from validate.commands.comparison import add_options, compare_scenes
from validate.commands.reporting import Page
from validate.cost.report import Report
from validate.cost.table import StoreError
from validate.errors import UsageError
from validate.exit_status import ExitStatus
from validate.html.hard_cases import HardCases, read_hard_cases
from validate.html.run import Run
from validate.output.console import Console
from validate.output.document import Head
from validate.output.progress import progress
from validate.plain_text import shown
from validate.published.tables import compare_published

# What a report of all built-in scenes tries itself: of each kind of singular place one, and few ways on one
# scene; some five seconds.
HARD = ("arm-highest-held-wishbone", "upper-arm-locks-held", "knuckle-in-line-wishbone")
SCENE, WAYS = "bounce", ("series", "absolute", "relative")

DESCRIPTION = """\
Compare scenes as `pointcoord validate` does, with its options, and write a report of it into a
folder: index.html, one page that needs no network and opens from disk, with its data as JSON
and CSV beside it.

Without SCENE it is about all built-in scenes, and holds the paper's and other programs' printed
tables, a few hard cases, and a first look at what accuracy costs in time. Whole studies of these
are taken from files, for they take minutes: `pointcoord hard --json FILE` and then --hard FILE,
`pointcoord cost --rows FILE` and then --cost FILE."""


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command with its options."""
    parser = commands.add_parser(
        "report", help="validate scenes and write a page of HTML about it", description=DESCRIPTION
    )
    parser.add_argument("folder", metavar="DIR", help="the report's folder, made if it is not there")
    add_options(parser)
    parser.add_argument(
        "--hard", metavar="FILE", help="show the hard cases that `pointcoord hard --json` kept"
    )
    parser.add_argument("--cost", metavar="FILE", help="show the times that `pointcoord cost --rows` kept")
    parser.set_defaults(run=run, report=None)


def run(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Compare the scenes and write the report.

    Raises:
        UsageError: the options do not go together, or a file of rows cannot be used.
        UsageError: a file holds no hard cases.
        MissingPackage: a page needs the extra `report`, a formulation its own packages.
        OutputError: the report cannot be written.
    """
    if options.data is not None:
        return _of_file(options, console)
    _require_folder_first(options.folder)
    hard = None if options.hard is None else read_hard_cases(options.hard)
    cost = None if options.cost is None else _kept_cost(options)
    page = Page(options.folder, partial(_with_more, options, hard, cost, console), option="")
    return compare_scenes(options, console, page, brief=True)


def _of_file(options: argparse.Namespace, console: Console) -> ExitStatus:
    """The page of a file of results."""
    # Most pages are of no file.
    from validate.commands.data import run as run_data

    _require_folder_first(options.folder)
    for option, value in (("--hard", options.hard), ("--cost", options.cost)):
        if value is not None:
            raise UsageError(
                f"{option} is not about a file of results; leave it out with --data, or give {option} to "
                "pointcoord report DIR without --data"
            )
    return run_data(options, console, Page(options.folder, option=""), brief=True)


def _require_folder_first(folder: str) -> None:
    """Refuse a scene in the place of the folder, which would make a folder of its name.

    Raises:
        UsageError: it is one.
    """
    is_scene = folder in built_in_scenes() or (folder.endswith(".toml") and not Path(folder).is_dir())
    if is_scene:
        raise UsageError(
            f"{shown(folder)!r} is a scene, and the folder of the report comes first: pointcoord report DIR "
            f"{shown(folder)}; a folder of that name is given as {shown(os.path.join(os.curdir, folder, ''))}"
        )


def _with_more(
    options: argparse.Namespace, hard: HardCases | None, cost: Report | None, console: Console, run: Run
) -> Run:
    """A run with the rest of a report; what is not computed is named, with the command that does."""
    left_out: list[tuple[str, str]] = []
    # The paper's tables are compared in a run of all that is built in, and of nothing else.
    whole = bool(run.record.paper)
    if hard is None and whole:
        hard = _some_hard_cases(run.head, console)
    if cost is None and whole:
        cost = _first_look_at_cost(run.head, console)
    if options.hard is None:
        what = "more than a few hard cases" if whole else "hard cases"
        left_out.append(
            (what, "pointcoord hard --json hard.json; then pointcoord report with --hard hard.json")
        )
    if options.cost is None:
        what = "more than a first look at accuracy against time" if whole else "accuracy against time"
        left_out.append(
            (what, "pointcoord cost --rows cost.parquet; then pointcoord report with --cost cost.parquet")
        )
    if not whole:
        what = "the paper's figures, tables and errata, other programs' tables"
        left_out.append((what, "pointcoord report DIR, without naming scenes"))
    published = compare_published() if whole else ()
    return replace(run, hard=hard, cost=cost, published=published, left_out=tuple(left_out))


def _some_hard_cases(head: Head, console: Console) -> HardCases:
    # The reference and its cases need packages that most commands do without.
    from validate.hard import report as hard_report
    from validate.hard import run as hard_run
    from validate.hard.catalogue import chosen

    cases = chosen(HARD)
    with progress(console, "hard cases", total=len(cases)) as at:
        done: list[str] = []

        def tell(one: hard_run.Examined) -> None:
            done.append(one.case.name)
            at(one.case.name, len(done))

        results = hard_run.run(cases, tell)
    status = ExitStatus.AGREE if hard_run.as_expected(results) else ExitStatus.DISAGREE
    mine = replace(head, kind="hard")
    return HardCases.of(mine.document(hard_report.results_data(results), status, complete=True))


def _first_look_at_cost(head: Head, console: Console) -> Report:
    # So does the study of cost.
    from validate.cost.scenes import own_scene, study_scene
    from validate.cost.study import Study, measure
    from validate.cost.table import Store, measured_here
    from validate.cost.ways.registry import ways_named

    command = shlex.join(head.command)
    study = Study(("accuracy",), (study_scene(SCENE, own_scene(SCENE)),), ways_named(WAYS), quick=True)
    with progress(console, "a first look at cost") as told:
        rows = measure(study, Store(None, measured_here(command)), told)
    return Report("in this run", command, True, tuple(rows))


def _kept_cost(options: argparse.Namespace) -> Report:
    try:
        return Report.of_file(options.cost)
    except StoreError as error:
        raise UsageError(f"--cost {error}") from None
