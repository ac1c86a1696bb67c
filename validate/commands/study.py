"""`pointcoord study`: long studies with several processes or machines; results are recorded as they come."""

from __future__ import annotations

import argparse
from contextlib import ExitStack
from importlib import import_module
from inspect import signature
from pathlib import Path
from typing import TYPE_CHECKING

from validate.commands.pages import Command
from validate.errors import UsageError
from validate.exit_status import ExitStatus
from validate.extras import needed
from validate.formulations.registry import NAMES
from validate.output.console import Console
from validate.output.document import Journal
from validate.plain_text import counted_as, shown

if TYPE_CHECKING:
    from validate.studies.study import Findings, Study

LOCAL = "local"
# The function in `validate.studies` that makes each study; its arguments are command-line options.
STUDIES = {
    "random": "random_cars.random_cars",
    "bounds": "bounds.bounds",
    "claims": "claims.claims",
    "hard": "hard_cases.hard",
}


def run(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Run the tasks that are not recorded yet, and print the findings of all tasks."""
    if options.records is not None and not options.records.strip():
        raise UsageError(f"--records {options.records!r} names no folder")
    if not options.scheduler.strip():
        raise UsageError(f"--scheduler {options.scheduler!r}: allowed: local, or an address")
    local = options.scheduler == LOCAL
    if options.workers is not None and not local:
        raise UsageError(
            f"--workers {options.workers} is for processes on this machine only; the cluster at --scheduler "
            "has its own workers; leave one of the two options out"
        )
    for package in ("mpmath", "flint", "pinocchio"):
        needed("study", package)
    study = _study(options)
    # Imported here: Dask may be missing, and is missed before the folder is made.
    from validate.studies import cluster
    from validate.studies.store import records

    cluster.quiet_dask()
    folder = Path(options.records or f"pointcoord-{options.study}")
    where = shown(str(folder))
    who = "processes of this machine" if local else f"the scheduler {shown(options.scheduler)}"
    with ExitStack() as stack:
        store = records(folder, study)
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
                console.written[where] = f"{held()}; the same command continues"
                progress(f"{study.noun}s, {who}", there, len(study.tasks))

        if missing:
            starting = f"{who} start" if local else f"connecting to {who}"
            progress = stack.enter_context(console.progress(starting, everywhere=True))
            client = stack.enter_context(cluster.opened(options.scheduler, options.workers))
        console.note(f"{where} holds {held()}; to continue a stopped study, give the same command again")
        results, what = (lambda: found().data), (lambda: held() if there else "")
        with Journal.of(options, console, options.study, results, what) as journal:
            if missing:
                tell(0)
                cluster.run(study, missing, store, client, tell)
            findings = found()
            journal.status = findings.status
    console.show(findings.parts)
    return journal.status


def _study(options: argparse.Namespace) -> Study:
    """The study that the options describe."""
    module, _, function = STUDIES[options.study].partition(".")
    make = getattr(import_module(f"validate.studies.{module}"), function)
    values = {name: getattr(options, name, None) for name in signature(make).parameters}
    study: Study = make(**{name: value for name, value in values.items() if value is not None})
    if not study.tasks:
        raise UsageError(f"the study has no {study.noun}; allowed: 1 or more")
    return study


INNER = {name: Command(run, {"formulations": ",".join(NAMES)}) for name in STUDIES}
COMMANDS = {"study": Command(run, inner=INNER)}
