"""`pointcoord study`: long studies by several processes or machines, recorded as they go."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from validate.commands.usage import JSON, QUIET, Command, given, require_results
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
METHODS = ("pointcoord", "pointcoord-map", "pointcoord-newton")
SOON = 2.0  # seconds before the first line of how far a study is, which waits for others

DESCRIPTION = """\
Long studies by several processes of this machine, or by any Dask cluster. Everything is numbered,
and a number means the same wherever it is worked out. What is worked out is added to a folder of
Parquet files, which can be read while the study runs; a study that is stopped goes on where it
was by the same command."""
ADDRESSES = """\
Each worker of a cluster runs the same version as here: pip install 'pointcoord[validate,cluster]',
dask worker ADDRESS --nthreads 1. It needs no disk in common with this machine.

Processes of this machine listen on 127.0.0.1 only. A cluster at an address trusts its network:
whoever reaches its scheduler or its workers can run any code on them and on this machine, for
what travels are Python's pickles. Keep it in a network of your own, or give a tls://HOST:8786 and
Dask's settings of TLS, here and there: DASK_DISTRIBUTED__COMM__TLS__CA_FILE, ...__CLIENT__CERT and
...__CLIENT__KEY, or the same in Dask's configuration file."""


@dataclass(frozen=True)
class Named:
    """A study on the command line.

    Attributes:
        module, function: of `validate.studies`, that make it.
        description: what it does. options: those of its own. choices: the names that one of them takes.
        settings: what it is made of; the counts among them say which tasks, and may change from run to run.
    """

    module: str
    function: str
    description: str
    options: str
    settings: tuple[str, ...]
    counts: tuple[str, ...]
    choices: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)

    def made(self, settings: Mapping[str, Any]) -> Study:
        """The study of these options, or of settings that were recorded.

        Raises:
            MissingPackage: what it needs is not there.
        """
        module = needed("study", f"validate.studies.{self.module}")
        study: Study = getattr(module, self.function)(**settings)
        return study


STUDIES: Mapping[str, Named] = {
    "random": Named(
        "random_cars",
        "random_cars",
        "Random cars and motions, solved by both models. Where the two disagree or only one answers, the\n"
        "reference decides; of the others it looks at one in twenty.",
        "--count K  scenes; 20000 if not given\n"
        f"--first NAME  by which of pointcoord's methods: {', '.join(METHODS)}; {METHODS[0]} if not given\n",
        ("count", "first"),
        ("--count",),
        {"--first": {"choices": METHODS}},
    ),
    "bounds": Named(
        "bounds",
        "bounds",
        "Random poses close to the end of an input, and motions towards one: no error may be above its\n"
        "proven bound.",
        "--poses K  poses held close to an end; 2000 if not given\n"
        "--motions K  towards one; one for 20 poses if not given\n"
        "--seed K  of both; 0 if not given\n",
        ("poses", "motions", "seed"),
        ("--poses", "--motions"),
    ),
    "claims": Named(
        "claims",
        "claims",
        "Random cars and motions, solved by one model: every number of every instant is compared with\n"
        "the reference, and its error with its bound.",
        "--count K  scenes; 300 if not given\n"
        "--first K  of them; 0 if not given\n"
        f"--formulation NAME  the model: {', '.join(NAMES)}; {NAMES[0]} if not given\n",
        ("count", "first", "formulation"),
        ("--count", "--first"),
        {"--formulation": {"choices": NAMES}},
    ),
    "hard": Named(
        "hard_cases",
        "hard",
        "What `pointcoord hard` does, by several processes, and recorded.",
        "cases=[CASE ...]  a hard case's name; none: all cases\n",
        ("cases",),
        ("cases",),
    ),
}
OPTIONS = f"""\
--scheduler local|ADDRESS  local, which is usual, is processes of this machine; or the scheduler of a Dask
    cluster, such as tcp://HOST:8786, whose network is trusted (see above)
--workers N  processes of this machine; one a processor if not given
--records FOLDER  where records are kept; pointcoord-STUDY if not given
--from-records  report what the folder holds, and solve nothing
{JSON}{QUIET}"""


def run(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Work out what is not recorded yet, and say what all of it comes to."""
    named, folder = STUDIES[options.study], Path(options.records or f"pointcoord-{options.study}")
    if options.records is not None and not options.records.strip():
        raise UsageError(f"--records {options.records!r} names no folder")
    if not options.scheduler.strip():
        raise UsageError(f"--scheduler {options.scheduler!r}: allowed: local, or an address")
    if options.workers is not None and options.scheduler != LOCAL:
        raise UsageError(
            f"--workers {options.workers} counts processes of this machine, a cluster at an address has its "
            "own; leave one of them out"
        )
    if options.from_records and (counts := given(options, *named.counts)):
        what = "CASE" if counts[0] == "cases" else counts[0]
        raise UsageError(f"--from-records is about all that is recorded; leave {what} out")
    require_results({"--json": options.json}, (), options, console)
    head = Head.of(options.study, options.command, timed=True)
    for package in ("mpmath", "flint", "pinocchio"):
        needed("study", package)
    if options.from_records:
        findings = _recorded(named, folder, options.study)
        journal = Journal(options.json, head, console, lambda: findings.data, lambda: "the findings")
        with journal.closing() as ending:
            console.show(findings.parts)
            ending.status = findings.status
        return findings.status
    values = {name: getattr(options, name) for name in named.settings}
    study = named.made({name: value for name, value in values.items() if value is not None})
    if not study.tasks:
        raise UsageError(f"no {study.noun} is asked for; allowed: 1 or more")
    return _worked_out(study, folder, options, head, console)


def _recorded(named: Named, folder: Path, name: str) -> Findings:
    """What all records in a folder come to."""
    there = needed("study", "validate.studies.store").look(folder)
    if there.study != name:
        raise UsageError(
            f"--records {shown(str(folder))} holds the study {there.study!r}, not {name!r}; "
            f"try: pointcoord study {shown(there.study)} --from-records"
        )
    if not (rows := there.rows()):
        raise UsageError(f"--records {shown(str(folder))} holds nothing yet; leave --from-records out")
    return named.made(there.settings).summary(rows)


def _worked_out(
    study: Study, folder: Path, options: argparse.Namespace, head: Head, console: Console
) -> ExitStatus:
    """Work out what is missing, and say what the tasks that are asked for come to."""
    cluster, where = needed("study", "validate.studies.cluster"), shown(str(folder))
    local = options.scheduler == LOCAL
    who = "processes of this machine" if local else f"the scheduler {shown(options.scheduler)}"
    # Found out before a folder is made.
    cluster.quiet_dask()
    with ExitStack() as stack:
        store = needed("study", "validate.studies.store").adding_to(folder, study)
        recorded = store.tasks()
        missing = [task for task in study.tasks if task not in recorded]
        before = there = len(study.tasks) - len(missing)

        def held() -> str:
            return f"{there:,} of {counted_as(len(study.tasks), study.noun)}"

        def found() -> Findings:
            return study.summary(store.rows(study.tasks))

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
        journal = Journal(options.json, head, console, lambda: found().data, lambda: held() if there else "")
        with journal.closing() as ending:
            if missing:
                tell(0)
                cluster.run(study, missing, store, client, tell)
            findings = found()
            ending.status = findings.status
    console.show(findings.parts)
    return ending.status


COMMANDS = {
    "study": Command(
        DESCRIPTION,
        "",
        run,
        inner={
            name: Command(
                f"{named.description}\n\n{DESCRIPTION}\n\n{ADDRESSES}",
                named.options + OPTIONS,
                run,
                {**named.choices, "--scheduler": {"default": LOCAL}},
            )
            for name, named in STUDIES.items()
        },
    )
}
