"""`pointcoord hard`: the cases that are known to be hard, held to the reference."""

from __future__ import annotations

import argparse

from validate.commands.comparing import Page
from validate.commands.usage import Commands, add_json, refuse, require_results, share
from validate.exit_status import ExitStatus
from validate.output.console import Console
from validate.output.document import Head, Journal
from validate.output.progress import progress
from validate.output.report import counted_as

DESCRIPTION = """\
Try mechanisms and motions that are known to be hard: near dead points, on branches that meet,
in extreme sizes and rates. Every answer is compared with a reference that is solved in 60
digits and proven: it must be right within its error bound, or refused with a reason.
`pointcoord study hard` does the same by several processes or machines, and keeps records.
With --assemblies the arguments are scenes: all assemblies of their knuckles are counted, complex
ones too, with the inputs held as drawn, and certified one by one."""


def add(commands: Commands) -> None:
    """Add the command with its options."""
    parser = commands.add_parser(
        "hard", help="try the cases that are known to be hard", description=DESCRIPTION
    )
    parser.add_argument("cases", nargs="*", metavar="CASE", help="a hard case's name; none: all cases")
    parser.add_argument("--list", action="store_true", help="name the cases and say why each is hard")
    parser.add_argument("--assemblies", action="store_true", help="count the assemblies of scenes instead")
    add_json(parser, "every trial, or the list,")
    parser.add_argument("--times", action="store_true", help="say how long each case took, the longest first")
    share(parser, "--report", "--quiet")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Try the cases; each is said, and written as JSON, as soon as it is done."""
    if options.assemblies:
        return count(options, console)
    # The reference needs packages that the solvers do without.
    from validate.hard import catalogue
    from validate.hard import report as hard_report
    from validate.hard import run as hard_run

    cases = catalogue.chosen(options.cases)
    if options.list:
        refuse(options, ("--report",), "is about cases that are tried; leave it out with --list")
    require_results({"--json": options.json}, (), options, console)
    head = Head.of("hard-list" if options.list else "hard", options.command, timed=True)
    journal = Journal(options.json, head, console)
    if options.list:
        console.say(hard_report.listing(cases))
        journal.close(lambda: hard_report.listing_data(cases), ExitStatus.AGREE, True, "the list")
        return ExitStatus.AGREE
    page = Page.of(options)
    if page is not None:
        page.require()
    results: list[hard_run.Examined] = []
    headings: list[str] = []

    def finished() -> str:
        return f"{len(results)} of {counted_as(len(cases), 'case')}"

    def tell(result: hard_run.Examined) -> None:
        results.append(result)
        if result.case.group not in headings:
            headings.append(result.case.group)
            console.say(f"== {result.case.group}\n")
        console.show((*hard_report.case_parts(result, bool(options.cases)), ""))
        journal.keep(lambda: hard_report.results_data(results), finished())
        working(f"cases, {result.case.name} done", len(results))

    with (
        journal.closing(lambda: hard_report.results_data(results), lambda: results, finished) as ending,
        progress(console, "cases", total=len(cases), lines=False) as working,
    ):
        hard_run.run(cases, tell)
        if options.times:
            console.show((*hard_report.times_parts(results), ""))
        console.show(hard_report.summary_parts(results))
        if not hard_run.as_expected(results):
            ending.status = ExitStatus.DISAGREE
        if page is not None:
            from validate.html.hard_cases import HardCases
            from validate.html.run import Run

            document = head.document(hard_report.results_data(results), ending.status, complete=True)
            ending.status = page.write(Run(head, hard=HardCases.of(document)), console).status
    return ending.status


def count(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Count assemblies; status 3 where two runs do not agree on a scene, or miss the drawing's."""
    from validate.assemblies import scenes

    refuse(options, ("--list", "--times", "--report"), "is about cases; leave it out with --assemblies")
    require_results({"--json": options.json}, (), options, console)
    journal = Journal(options.json, Head.of("assemblies", options.command), console)
    found: list[scenes.SceneCount] = []
    names = options.cases or scenes.SHIPPED
    with (
        journal.closing(lambda: scenes.data(found), lambda: found, lambda: f"{len(found)} counts") as ending,
        progress(console, "scenes", total=len(names), lines=False) as working,
    ):
        for done, name in enumerate(names, start=1):
            found.extend(scenes.counts(name))
            working(f"scenes, {name} done", done)
        console.show(scenes.parts(found))
        if not all(one.found for one in found):
            ending.status = ExitStatus.NO_VERDICT
    return ending.status
