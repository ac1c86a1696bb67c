"""`pointcoord study`: long studies by several processes or machines, recorded as they go."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, nullcontext
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from validate.commands.usage import UsageError, add_quiet, require_target
from validate.exit_status import ExitStatus
from validate.extras import MissingPackage
from validate.output.console import Console
from validate.output.document import Head, Journal
from validate.output.progress import progress
from validate.plain_text import shown

if TYPE_CHECKING:
    from validate.long_studies.study import Findings, Study

LOCAL = "local"

METHODS = ("pointcoord", "pointcoord-map", "pointcoord-newton")
SOON = 2.0  # seconds before the first line of how far a study is, which waits for others
MOTIONS = 20  # poses for each motion, unless they are counted

DESCRIPTION = """\
Long studies by several processes of this machine, or by any Dask cluster. Everything is numbered,
and a number means the same wherever it is worked out. What is worked out is added to a folder of
Parquet files, which can be read while the study runs; a study that is stopped goes on where it
was by the same command."""
ADDRESSES = """\
Each worker of a cluster runs the same version as here: pip install 'pointcoord[validate,cluster]',
dask worker ADDRESS --nthreads 1. It needs no disk in common with this machine."""


@dataclass(frozen=True)
class Named:
    """A study on the command line.

    Attributes:
        help, description: what it does.
        counts: its options that say how many numbers; they may change from run to run.
        add: adds its options. make: the study that they ask for.
        recorded: the study that recorded settings are of, without numbers.
    """

    help: str
    description: str
    counts: tuple[str, ...]
    add: Callable[[argparse.ArgumentParser], None]
    make: Callable[[argparse.Namespace], Study]
    recorded: Callable[[Mapping[str, Any]], Study]


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command, with a command of its own for each study."""
    parser = commands.add_parser(
        "study", help="long studies, by several processes or a cluster", description=DESCRIPTION
    )
    studies = parser.add_subparsers(required=True, metavar="STUDY", dest="study")
    for name, named in STUDIES.items():
        one = studies.add_parser(
            name,
            help=named.help,
            description=f"{named.description}\n\n{DESCRIPTION}\n\n{ADDRESSES}",
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        named.add(one)
        one.add_argument(
            "--scheduler",
            metavar="local|ADDRESS",
            default="local",
            help="processes of this machine, which is what is done if not given, or a Dask cluster's "
            "scheduler such as tcp://HOST:8786",
        )
        one.add_argument(
            "--workers",
            metavar="N",
            type=int,
            help="processes of this machine; as many as there are processors, if not given",
        )
        one.add_argument(
            "--records", metavar="FOLDER", help=f"keeps what is worked out; pointcoord-{name} if not given"
        )
        one.add_argument(
            "--from-records",
            action="store_true",
            help="say what all records in the folder come to, and work out nothing",
        )
        one.add_argument("--json", metavar="FILE", help="write the findings as JSON; - for standard output")
        add_quiet(one)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Work out what is not recorded yet, and say what all of it comes to.

    Raises:
        UsageError: the options do not go together, or ask for what is not.
        RecordsError: the folder cannot be used.
        NoCluster, ClusterLost: nobody can work it out, or not any more.
        MissingPackage: the reference, Dask or pyarrow is not there.
        OutputError: something cannot be written.
    """
    _check(options)
    console.quiet, console.mute = options.quiet, options.json == "-"
    if not console.quiet or console.mute:
        console.require("use --quiet, or --quiet --json FILE")
    named, folder = STUDIES[options.study], Path(options.records or f"pointcoord-{options.study}")
    journal = Journal(options.json, Head.of(options.study, options.command, timed=True), console)
    for package in ("mpmath", "flint", "pinocchio"):
        _module(package)
    with _known_names():
        if options.from_records:
            return _told(_found(named, folder, options.study), journal, console)
        return _worked_out(named.make(options), folder, options, journal, console)


def _check(options: argparse.Namespace) -> None:
    require_target(options.json, "--json")
    if options.records is not None and not options.records.strip():
        raise UsageError(f"--records {options.records!r} names no folder")
    if options.workers is not None and options.workers < 1:
        raise UsageError(f"--workers {options.workers}: allowed: 1 or more")
    if not options.scheduler.strip():
        raise UsageError(f"--scheduler {options.scheduler!r}: allowed: local, or an address")
    if options.workers is not None and options.scheduler != LOCAL:
        raise UsageError(
            f"--workers {options.workers} counts processes of this machine, a cluster at an address has its "
            "own; leave one of them out"
        )
    counts = {name: getattr(options, name) for name in STUDIES[options.study].counts}
    for name, value in counts.items():
        if options.from_records and value:
            raise UsageError(f"--from-records is about all that is recorded; leave {_option(name)} out")
        if isinstance(value, int) and value < 0:
            raise UsageError(f"{_option(name)} {value}: allowed: 0 or more")


def _option(name: str) -> str:
    return "CASE" if name == "cases" else f"--{name}"


def _found(named: Named, folder: Path, name: str) -> Findings:
    """What all records in a folder come to."""
    there = _module("validate.long_studies.records").look(folder)
    if there.head.study != name:
        raise UsageError(
            f"--records {shown(str(folder))} holds the study {there.head.study!r}, not {name!r}; "
            f"try: pointcoord study {shown(there.head.study)} --from-records"
        )
    rows = there.rows()
    if not rows:
        raise UsageError(f"--records {shown(str(folder))} holds nothing yet; leave --from-records out")
    rows.sort(key=lambda row: (row["part"], row["number"]))
    return named.recorded(there.head.settings).findings(rows)


def _worked_out(
    study: Study, folder: Path, options: argparse.Namespace, journal: Journal, console: Console
) -> ExitStatus:
    """Work out what is missing, and say what the numbers that are asked for come to."""
    records, scheduler = _module("validate.long_studies.records"), _module("validate.long_studies.scheduler")
    words, run_study = _module("validate.long_studies.study"), _module("validate.long_studies.run").run
    numbers = study.numbers
    if not numbers:
        raise UsageError(f"no {study.noun} is asked for; allowed: 1 or more")
    # Found out before a folder is made.
    scheduler.quiet_dask()
    with ExitStack() as stack:
        cluster = None
        if options.scheduler != LOCAL and not folder.exists():
            # A wrong address leaves no folder behind.
            with progress(console, _first_words(options.scheduler), SOON):
                cluster = stack.enter_context(scheduler.opened(options.scheduler))
        there = stack.enter_context(records.adding_to(folder, records.Head.of(study)))
        recorded = there.recorded()
        missing = [number for number in numbers if number not in recorded]
        before, begun = len(numbers) - len(missing), False

        def held(more: int) -> str:
            return (
                f"{shown(str(folder))} holds {before + more:,} of {words.counted(len(numbers), study.noun)}"
            )

        def found() -> Findings:
            return study.findings(records.in_order(there.rows(), numbers))

        console.note(f"{held(0)}; a study that is stopped goes on with the same command")
        with journal.closing(lambda: found().data, lambda: begun, lambda: held(0)) as ending:
            if missing:
                console.written = [f"{held(0)}; the same command goes on"]
                with (
                    progress(console, _first_words(options.scheduler), SOON) as told,
                    _open(scheduler, cluster, options) as workers,
                ):
                    begun = True

                    def tell(more: int) -> None:
                        console.written = [f"{held(more)}; the same command goes on"]
                        told(f"{study.noun}s, {workers.words}", before + more, len(numbers))

                    tell(0)
                    run_study(study, missing, there, workers, tell)
            findings = found()
            console.show(findings.parts)
            ending.status = findings.status
    return ending.status


def _first_words(scheduler: str) -> str:
    """What a study waits for at first."""
    return "processes start" if scheduler == LOCAL else f"the scheduler {shown(scheduler)} is asked"


def _open(scheduler: Any, cluster: Any, options: argparse.Namespace) -> Any:
    """The cluster that is there already, or else the one that is asked for."""
    if cluster is not None:
        return nullcontext(cluster)
    return scheduler.opened(options.scheduler, options.workers)


def _told(findings: Findings, journal: Journal, console: Console) -> ExitStatus:
    console.show(findings.parts)
    journal.close(lambda: findings.data, findings.status, True, "the findings")
    return findings.status


@contextmanager
def _known_names() -> Iterator[None]:
    """Gives a case that is not there as a mistake of the command line.

    Raises:
        UsageError: it is.
    """
    unknown = _module("validate.hard.catalogue").UnknownCase
    try:
        yield
    except unknown as error:
        raise UsageError(str(error)) from None


def _module(name: str) -> Any:
    """A module that needs what the solvers do without.

    Raises:
        MissingPackage: that is not there.
    """
    try:
        return import_module(name)
    except ImportError as error:
        raise MissingPackage("study", error) from None


def _add_random(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--count", metavar="N", type=int, help="scenes; 20000 if not given")
    parser.add_argument(
        "--first",
        metavar="NAME",
        choices=METHODS,
        default=METHODS[0],
        help=f"by which of pointcoord's methods: {', '.join(METHODS)}; {METHODS[0]} if not given",
    )


def _random(options: argparse.Namespace) -> Study:
    count = 20_000 if options.count is None else options.count
    study: Study = _study("random_runs").RandomStudy(count, options.first)
    return study


def _add_bounds(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--poses", metavar="N", type=int, help="poses held close to an end; 2000 if not given"
    )
    parser.add_argument(
        "--motions", metavar="N", type=int, help=f"towards one; one for {MOTIONS} poses if not given"
    )
    parser.add_argument("--seed", metavar="N", type=int, default=0, help="of both; 0 if not given")


def _bounds(options: argparse.Namespace) -> Study:
    if options.seed < 0:
        raise UsageError(f"--seed {options.seed}: allowed: 0 or more")
    poses = 2000 if options.poses is None else options.poses
    motions = poses // MOTIONS if options.motions is None else options.motions
    study: Study = _study("bounds").BoundsStudy(poses, motions, options.seed)
    return study


def _add_hard(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("cases", nargs="*", metavar="CASE", help="a hard case's name; none: all cases")


def _study(module: str) -> Any:
    return _module(f"validate.long_studies.{module}")


STUDIES: Mapping[str, Named] = {
    "random": Named(
        "random cars through both models",
        "Random cars and motions, solved by both models. What they do not agree in, what only one of them\n"
        "answers and one in twenty of the others is held to the reference.",
        ("count",),
        _add_random,
        _random,
        lambda settings: _study("random_runs").RandomStudy(0, settings["first"]),
    ),
    "bounds": Named(
        "whether proven bounds hold up to where cars lock",
        "Random poses close to the end of an input, and motions towards one: no error may be above its\n"
        "proven bound.",
        ("poses", "motions"),
        _add_bounds,
        _bounds,
        lambda settings: _study("bounds").BoundsStudy(0, 0, settings["seed"]),
    ),
    "hard": Named(
        "the hard cases",
        "What `pointcoord hard` does, by several processes, and recorded.",
        ("cases",),
        _add_hard,
        lambda options: _study("hard_runs").HardStudy(tuple(options.cases)),
        lambda settings: _study("hard_runs").HardStudy(),
    ),
}
