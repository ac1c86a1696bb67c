"""`pointcoord report`: validates scenes, and writes the results as an HTML page with its data."""

from __future__ import annotations

import argparse
import os
import shlex
from dataclasses import replace
from pathlib import Path

from pointcoord import built_in_scenes
from validate.commands import comparison
from validate.commands.pages import Command
from validate.cost.report import Report
from validate.errors import UsageError
from validate.exit_status import ExitStatus
from validate.html.hard_cases import HardCases, read_hard_cases
from validate.html.run import Run
from validate.output.console import Console
from validate.plain_text import shown
from validate.published.tables import compare_published

# Hard cases and cost measurements that a report of all built-in scenes runs: one case of each kind of
# singular pose, and few methods on one scene. They take about five seconds.
HARD = ("arm-highest-held-wishbone", "upper-arm-locks-held", "knuckle-in-line-wishbone")
SCENE, WAYS = "bounce", ("series", "absolute", "relative")


def run(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Compare the scenes and write the report."""
    folder = options.folder
    # If the folder is forgotten, the first scene would be taken for it.
    if folder in built_in_scenes() or (folder.endswith(".toml") and not Path(folder).is_dir()):
        raise UsageError(
            f"{shown(folder)!r} is a scene, and the first argument is the folder of the report: pointcoord "
            f"report DIR {shown(folder)}; for a folder of that name, give "
            f"{shown(os.path.join(os.curdir, folder, ''))}"
        )
    comparison.require_sense(options)
    hard = None if options.hard is None else read_hard_cases(options.hard)
    cost = None if options.cost is None else Report.of_file(options.cost)

    def with_more(run: Run) -> Run:
        """The run with hard cases and cost; a run of all built-in scenes also has printed tables."""
        if not run.record.paper:
            return replace(run, hard=hard, cost=cost)
        some, first = hard or _some_hard_cases(run, console), cost or _first_look_at_cost(run, console)
        return replace(run, hard=some, cost=first, published=compare_published())

    options.report, options.with_more = folder, with_more
    return comparison.run(options, console)


def _some_hard_cases(run: Run, console: Console) -> HardCases:
    # Imported here: the reference and its cases need packages that most commands do not need.
    from validate.hard import report as hard_report
    from validate.hard.catalogue import chosen

    with console.progress("hard cases"):
        results = [hard_report.examine(case) for case in chosen(HARD)]
    status = ExitStatus.AGREE if hard_report.as_expected(results) else ExitStatus.DISAGREE
    head = replace(run.head, kind="hard")
    return HardCases(head.document(hard_report.results_data(results), status, complete=True))


def _first_look_at_cost(run: Run, console: Console) -> Report:
    # Imported here: the study of cost needs packages that most commands do not need.
    from validate.cost.scenes import own_scene, with_rates
    from validate.cost.study import Study, measure
    from validate.cost.table import measured_here
    from validate.cost.ways.registry import ways_named

    command = shlex.join(run.head.command)
    study = Study({SCENE: with_rates(own_scene(SCENE))}, ways_named(WAYS), measured_here(command), quick=True)
    with console.progress("a first look at cost") as progress:
        (rows,) = measure(study, progress)
    return Report("in this run", command, tuple(rows))


COMMANDS = {"report": Command(run, comparison.PAGE_WORDS)}
