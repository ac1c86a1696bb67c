"""`pointcoord study`: long studies by several processes or machines, recorded as they go."""

from __future__ import annotations

import argparse
from contextlib import ExitStack
from inspect import signature
from pathlib import Path
from typing import TYPE_CHECKING

from validate.commands.pages import Command
from validate.commands.usage import require_results
from validate.errors import UsageError
from validate.exit_status import ExitStatus
from validate.extras import needed
from validate.formulations.registry import NAMES
from validate.output.console import Console
from validate.output.document import Head, Journal
from validate.output.report import counted_as
from validate.plain_text import shown

if TYPE_CHECKING:
    from validate.studies.study import Findings, Study

LOCAL = "local"
SOON = 2.0  # seconds before the first line of how far a study is, which waits for others


# What makes each study, of `validate.studies`; its arguments are options of the command line.
STUDIES = {
    "random": ("random_cars", "random_cars"),
    "bounds": ("bounds", "bounds"),
    "claims": ("claims", "claims"),
    "hard": ("hard_cases", "hard"),
}


def run(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Work out what is not recorded yet, and say what all of it comes to."""
    folder = Path(options.records or f"pointcoord-{options.study}")
    if options.records is not None and not options.records.strip():
        raise UsageError(f"--records {options.records!r} names no folder")
    if not options.scheduler.strip():
        raise UsageError(f"--scheduler {options.scheduler!r}: allowed: local, or an address")
    if options.workers is not None and options.scheduler != LOCAL:
        raise UsageError(
            f"--workers {options.workers} counts processes of this machine, a cluster at an address has its "
            "own; leave one of them out"
        )
    require_results(options, console, ("--json",))
    for package in ("mpmath", "flint", "pinocchio"):
        needed("study", package)
    module, function = STUDIES[options.study]
    make = getattr(needed("study", f"validate.studies.{module}"), function)
    values = {name: getattr(options, name, None) for name in signature(make).parameters}
    study: Study = make(**{name: value for name, value in values.items() if value is not None})
    if not study.tasks:
        raise UsageError(f"no {study.noun} is asked for; allowed: 1 or more")
    return _worked_out(study, folder, options, console)


def _worked_out(study: Study, folder: Path, options: argparse.Namespace, console: Console) -> ExitStatus:
    """Work out what is missing, and say what the tasks that are asked for come to."""
    cluster, where = needed("study", "validate.studies.cluster"), shown(str(folder))
    local = options.scheduler == LOCAL
    who = "processes of this machine" if local else f"the scheduler {shown(options.scheduler)}"
    # Found out before a folder is made.
    cluster.quiet_dask()
    with ExitStack() as stack:
        store = needed("study", "validate.studies.store").records(folder, study)
        recorded = store.rows()
        missing = [task for task in study.tasks if task not in recorded]
        before = there = len(study.tasks) - len(missing)

        def held() -> str:
            return f"{there:,} of {counted_as(len(study.tasks), study.noun)}"

        def found() -> Findings:
            rows = store.rows()
            return study.summary([row for task in study.tasks for row in rows.get(task, ())])

        def tell(done: int) -> None:
            nonlocal there
            there = before + done
            if there:
                console.written[where] = f"{held()}; the same command goes on"
            told(f"{study.noun}s, {who}", there, len(study.tasks))

        if missing:
            told = stack.enter_context(console.progress(f"{who} start" if local else f"{who} is asked", SOON))
            client = stack.enter_context(cluster.opened(options.scheduler, options.workers))
        console.note(f"{where} holds {held()}; a study that is stopped goes on with the same command")
        head = Head.of(options.study, options.command, timed=True)
        journal = Journal(options.json, head, console, lambda: found().data, lambda: held() if there else "")
        with journal.closing() as ending:
            if missing:
                tell(0)
                cluster.run(study, missing, store, client, tell)
            findings = found()
            ending.status = findings.status
    console.show(findings.parts)
    return ending.status


FORMULATIONS = {"formulations": ", ".join(NAMES)}, {"--formulation": {"choices": NAMES}}
COMMANDS = {
    "study": Command(
        run, inner={name: Command(run, *(FORMULATIONS if name == "claims" else ())) for name in STUDIES}
    )
}
