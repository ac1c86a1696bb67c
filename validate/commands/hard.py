"""`pointcoord hard`: the cases that are known to be hard, held to the reference."""

from __future__ import annotations

import argparse

from validate.commands.comparing import Page
from validate.commands.usage import JSON, QUIET, REPORT, Command, require_results
from validate.errors import UsageError
from validate.exit_status import ExitStatus
from validate.output.console import Console
from validate.output.document import Head, Journal
from validate.output.progress import progress

DESCRIPTION = """\
Try mechanisms and motions that are known to be hard: near dead points, on branches that meet,
in extreme sizes and rates. Every answer is compared with a reference that is solved in 60
digits and proven: it must be right within its error bound, or refused with a reason.
`pointcoord study hard` does the same by several processes or machines, and keeps records."""

OPTIONS = f"""\
cases=[CASE ...]  a hard case's name; none: all cases
--list  name the cases and say why each is hard
--times  say how long each case took, the longest first
{JSON}{REPORT}{QUIET}"""


def run(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Try the cases; each is said, and written as JSON, as soon as it is done."""
    # The reference needs packages that the solvers do without.
    from validate.hard import catalogue
    from validate.hard import report as hard_report
    from validate.hard import run as hard_run

    cases = catalogue.chosen(options.cases)
    if options.list and options.report is not None:
        raise UsageError("--report is about cases that are tried; leave it out with --list")
    require_results({"--json": options.json}, (), options, console)
    head = Head.of("hard-list" if options.list else "hard", options.command, timed=True)
    if options.list:
        console.say(hard_report.listing(cases))
        listed = Journal(
            options.json, head, console, lambda: hard_report.listing_data(cases), lambda: "the list"
        )
        with listed.closing():
            return ExitStatus.AGREE
    page = Page.of(options)
    if page is not None:
        page.require()
    results: list[hard_run.Examined] = []
    journal = Journal(
        options.json,
        head,
        console,
        lambda: hard_report.results_data(results),
        lambda: f"{len(results)} of {hard_report.numbered(len(cases), 'case')}",
        lambda: results,
    )

    def tell(result: hard_run.Examined) -> None:
        if result.case.group not in {one.case.group for one in results}:
            console.say(f"== {result.case.group}\n")
        results.append(result)
        console.show((*hard_report.case_parts(result, bool(options.cases)), ""))
        journal.keep()
        working(f"cases, {result.case.name} done", len(results))

    with (
        journal.closing() as ending,
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


COMMANDS = {"hard": Command(DESCRIPTION, OPTIONS, run)}
