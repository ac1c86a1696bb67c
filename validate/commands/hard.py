"""`pointcoord hard`: solves the cases that are known to be hard, and compares them with the reference."""

from __future__ import annotations

import argparse

from validate.commands.comparing import page_folder, write_page
from validate.commands.pages import Command
from validate.commands.usage import given
from validate.errors import UsageError
from validate.exit_status import ExitStatus
from validate.formulations.registry import missing
from validate.output.console import Console
from validate.output.document import Journal
from validate.output.report import share_of_all
from validate.plain_text import counted_as


def run(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Run the cases. Each result is printed, and written as JSON, as soon as it is known."""
    if options.assemblies:
        return _count(options, console)
    # Imported here: the reference needs packages that the solvers do not need.
    from validate.hard import catalogue, report

    cases = catalogue.chosen(options.cases)
    if options.list:
        if options.report is not None:
            raise UsageError("--report needs solved cases, and --list solves none; leave one of them out")
        console.say(report.listing(cases))
        with Journal.of(
            options, console, "hard-list", lambda: report.listing_data(cases), lambda: "the list"
        ):
            return ExitStatus.AGREE
    folder, results = page_folder(options), list[report.Examined]()
    lacking = missing(name for case in cases for name in case.expected)
    console.warn(*(f"{name} is left out: {why}" for name, why in lacking.items()))
    cases = tuple(one for one in (case.without(lacking) for case in cases) if one.expected)

    def done() -> str:
        return share_of_all(results, cases, "case")

    with (
        Journal.of(options, console, "hard", lambda: report.results_data(results), done) as journal,
        console.progress("cases", total=len(cases)) as working,
    ):
        for case in cases:
            result = report.examine(case)
            if case.group not in {one.case.group for one in results}:
                console.say(f"== {case.group}\n")
            results.append(result)
            console.show((*report.case_parts(result, bool(options.cases)), ""))
            journal.keep()
            working(f"cases, {case.name} done", len(results))
        console.show(report.summary_parts(results))
        if not report.as_expected(results):
            journal.status = ExitStatus.DISAGREE
        if folder is not None:
            from validate.html.hard_cases import HardCases
            from validate.html.run import Run

            document = journal.head.document(report.results_data(results), journal.status, complete=True)
            run = Run(journal.head, hard=HardCases(document))
            write_page(folder, run, console)
            journal.status = run.status
    return journal.status


def _count(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Count assembly modes; status 3 if two counts of a scene differ, or do not contain the drawn mode."""
    from validate.assemblies import scenes

    if others := given(options, "--list", "--report"):
        raise UsageError(f"{others[0]} goes with cases only; leave it out with --assemblies")
    found, names = list[scenes.Count](), options.cases or scenes.SHIPPED

    def done() -> str:
        return counted_as(len(found), "count") if found else ""

    with (
        Journal.of(options, console, "assemblies", lambda: {"counts": found}, done) as journal,
        console.progress("scenes", total=len(names)) as working,
    ):
        for number, name in enumerate(names, start=1):
            found.extend(scenes.counts(name))
            working(f"scenes, {name} done", number)
        console.show(scenes.parts(found))
        if not scenes.complete(found):
            journal.status = ExitStatus.NO_VERDICT
    return journal.status


COMMANDS = {"hard": Command(run)}
