"""`pointcoord validate`: scenes solved by several formulations, and every quantity compared."""

from __future__ import annotations

import argparse
import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass, field, replace
from typing import Any, get_args

from pointcoord import Scene, SceneError
from validate.ci.baseline import Baseline, Recorder, Since, read_baseline
from validate.ci.moves import baseline_data, lost_lines, since_text
from validate.ci.record import Record, ends_the_run, why_undecided
from validate.ci.scene_folder import scenes_below
from validate.commands.reporting import Page, add_report, page_of
from validate.commands.usage import (
    SCENE_HELP,
    STANDARD_INPUT,
    UsageError,
    add_quiet,
    add_timings,
    load_scene,
    name_of,
    result_files,
)
from validate.comparison.compare import Verdict
from validate.comparison.examined import Examined, examine
from validate.comparison.findings import Finding, findings
from validate.diagnosis import Explanation, explain_outcome
from validate.exit_status import ExitStatus
from validate.formulations.refusals import Refusal
from validate.formulations.registry import NAMES, WORDS, formulation
from validate.output import report
from validate.output.console import Console
from validate.output.document import Head, Journal, program_version
from validate.paper.scenes import DEFAULT_SCENES, PAPER_SCENES
from validate.paper.tables import PaperRow, compare_with_paper
from validate.plain_text import shown
from validate.solvers.apart import LIMIT, Apart
from validate.solvers.check import ACCURACY, required_accuracy
from validate.solvers.load import solver_at
from validate.solvers.plain import PlainSolver

Explained = Sequence[Sequence[Explanation]]

FIRST, SECOND = "pointcoord", "absolute"
# Without names on the command line the paper's own algorithm is held to the other model too.
FURTHER = ("pointcoord-newton", "absolute")

_WIDTH = max(map(len, WORDS))
DESCRIPTION = """\
Solve each scene by two formulations and compare every number that it asks for. Each
formulation claims how far off its numbers may be, and a difference is held to the sum of both
claims, its tolerance. Of each quantity the largest difference is printed, and how much of its
tolerance any number of it uses at most.

formulations:
""" + "\n".join(f"  {name.ljust(_WIDTH)}  {words}" for name, words in WORDS.items())


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command with its options."""
    parser = commands.add_parser(
        "validate",
        help="solve scenes by two formulations and compare them",
        description=DESCRIPTION,
    )
    add_options(parser)
    add_report(parser)
    parser.set_defaults(run=run)


def add_options(parser: argparse.ArgumentParser) -> None:
    """What is compared, how, and where results go beside a report."""
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=f"{SCENE_HELP}; none: all built-in scenes")
    parser.add_argument(
        "--first",
        metavar="NAME",
        help=f"a formulation ({FIRST} if not given)",
    )
    parser.add_argument(
        "--second",
        metavar="NAME",
        help=f"the one to compare it with ({SECOND} if not given); without --first and --second "
        f"{FURTHER[0]} is compared with {FURTHER[1]} as well",
    )
    parser.add_argument(
        "--data",
        metavar="FILE",
        help="compare a file of results (CSV, whitespace table, Parquet) with the one SCENE's car, at the "
        "file's own times, inputs or travels, to the digits that it is written with",
    )
    parser.add_argument(
        "--map",
        metavar="FILE.toml",
        help="what the columns of --data are; not needed for files that pointcoord simulate -o writes",
    )
    parser.add_argument(
        "--solver",
        metavar="MODULE:NAME",
        help="a solver of your own in the place of --first: a function, object or class that takes plain "
        f"data (see the README); without --second it is held to {FIRST}",
    )
    parser.add_argument(
        "--accuracy",
        metavar="A",
        type=float,
        help=f"how exactly the solver of --solver says it places points, mm ({ACCURACY:g} if not given): "
        "what is tolerated of every number is derived from it, pose by pose; or how far off the numbers of "
        "--data may be beside their digits, each in its column's unit",
    )
    parser.add_argument(
        "--traceback", action="store_true", help="show where in its files that solver raises an error"
    )
    parser.add_argument(
        "--solver-timeout",
        type=_timeout,
        metavar="S",
        help=f"how long that solver may take for a scene, s ({LIMIT:g} if not given); one that takes longer, "
        "or crashes, has no answer there, and is made anew for the next scene",
    )
    parser.add_argument(
        "--in-process",
        action="store_true",
        help="call that solver in this process, for a debugger: no time limit, and a crash ends the run",
    )
    parser.add_argument(
        "--scenes-dir", metavar="DIR", help="compare every .toml file below this folder too, sorted by path"
    )
    parser.add_argument(
        "--tolerance-factor",
        type=_factor,
        default=1.0,
        metavar="F",
        help="hold differences to F times the derived tolerance; every result says so",
    )
    parser.add_argument(
        "--fail-fast",
        action="store_true",
        help="stop at the first scene that disagrees, has moved or is refused; what was not run is named",
    )
    parser.add_argument("--json", metavar="FILE", help="write the results as JSON; - for standard output")
    parser.add_argument(
        "--junit", metavar="FILE", help="write JUnit XML, a test case for each scene and quantity; - likewise"
    )
    parser.add_argument("--summary", metavar="FILE", help="write a summary in Markdown; - likewise")
    parser.add_argument(
        "--save-baseline", metavar="FILE", help="keep the solved numbers and what is claimed of them (npz)"
    )
    parser.add_argument(
        "--baseline", metavar="FILE", help="say what moved since a kept baseline, relative to both claims"
    )
    add_timings(parser)
    add_quiet(parser)


def _factor(word: str) -> float:
    return _positive(word, "factor")


def _timeout(word: str) -> float:
    return _positive(word, "time limit in s")


def _positive(word: str, what: str) -> float:
    try:
        value = float(word)
    except ValueError:
        value = math.nan
    if not 0.0 < value < math.inf:
        raise argparse.ArgumentTypeError(f"{shown(word)!r} is no {what}; allowed: a positive, finite number")
    return value


@dataclass
class _Results:
    """What is there so far, as plain data and in counts."""

    record: Record
    baseline: Baseline | None
    scenes: list[dict[str, Any]] = field(default_factory=list)
    agreed: dict[tuple[str, str], int] = field(default_factory=dict)
    uncompared: int = 0
    printed: list[str] = field(default_factory=list)
    findings: list[Finding] = field(default_factory=list)
    unprinted: list[tuple[str, Refusal]] = field(default_factory=list)
    paper: Sequence[PaperRow] = ()

    def add(self, examined: Examined, since: Since | None, explanations: Explained) -> None:
        self.record.add(examined, since)
        self.scenes.append(report.examined_data(examined, explanations))
        self.uncompared += not examined.outcomes
        for outcome in examined.outcomes:
            first, second = (s.formulation for s in outcome.solutions)
            self.agreed[first, second] = self.agreed.get((first, second), 0) + outcome.passed
        if examined.printed is not None:
            self.printed.append(examined.name)
            self.findings += findings([examined.printed])
        if examined.unprinted is not None:
            self.unprinted.append((examined.name, examined.unprinted))

    def data(self) -> dict[str, Any]:
        return {
            "scenes": self.scenes,
            "printed_formulas": [report.finding_data(finding) for finding in self.findings],
            "printed_tables": report.paper_data(self.paper) if self.paper else None,
            "tolerance_factor": self.record.factor,
            "not_run": list(self.record.not_run),
            "baseline": None
            if self.baseline is None
            else baseline_data(self.baseline, self.record.since, self.record.gone),
        }


def run(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Compare the scenes; each is said, and written as JSON, as soon as it is done.

    Raises:
        UsageError: the options do not go together.
        SceneFolderError, BaselineError: a folder of scenes or a baseline cannot be read.
        UnknownFormulation, MissingPackage: a formulation is not there.
        OutputError: the results cannot be written.
    """
    if options.data is not None:
        # Most runs compare no file.
        from validate.commands.data import run as run_data

        return run_data(options, console, page_of(options))
    return compare_scenes(options, console, page_of(options))


def compare_scenes(
    options: argparse.Namespace, console: Console, page: Page | None, brief: bool = False
) -> ExitStatus:
    """Compare scenes, with all that the options ask for.

    Args:
        page: is made of the run, if there is one.
        brief: whether nothing is said but the verdict in a sentence, and where the page is.
    Raises:
        UsageError, SceneFolderError, BaselineError, UnknownFormulation, MissingPackage, OutputError: see
            `run`.
    """
    if options.map is not None:
        raise UsageError("--map is about a file of results; give it with --data FILE")
    all_of_ours = not options.scenes and options.scenes_dir is None
    names = _names(options)
    _require_solver_options(options)
    pairs = _pairs(options)
    if names.count(STANDARD_INPUT) > 1:
        raise UsageError("standard input (-) is given as a scene more than once; it can be read once")
    files = result_files(options, names, console)
    mute, console.mute = console.mute, console.mute or brief
    for name in dict.fromkeys(name for pair in pairs for name in pair if name != shown(options.solver or "")):
        formulation(name)  # found before any scene is read
    baseline = None if options.baseline is None else read_baseline(options.baseline)
    shown_names = [name_of(name) for name in names]
    record = Record(shown_names, options.tolerance_factor, options.baseline)
    if baseline is not None:
        record.gone = baseline.gone(shown_names)
    files.require_writable()
    if page is not None:
        page.require()
    telling = None if page is None else page.telling(len(names))
    head = Head.of("validate", options.command, options.timings)
    journal = Journal(options.json, head, console)
    results = _Results(record, baseline)
    with (
        _solver(options) as own,
        nullcontext() if files.baseline is None else Recorder(program_version()) as recorder,
        journal.closing(results.data, lambda: results.scenes, lambda: _finished(results, names)) as ending,
        files.closing(record, recorder, console),
        console.working("scenes", len(names), lines=brief) as told,
    ):
        for place, (name, scene) in enumerate(_loaded(names, console)):
            since = None
            told(shown_names[place], place)
            if isinstance(scene, Scene):
                printed = name in PAPER_SCENES and not own
                examined = examine(name, scene, pairs, printed, record.factor, own)
                explained = [explain_outcome(scene, outcome) for outcome in examined.outcomes]
                told_why = zip(examined.outcomes, explained, strict=True)
                outcomes = tuple(replace(outcome, explanations=why) for outcome, why in told_why)
                examined = replace(examined, outcomes=outcomes)
                _say(examined, explained, console)
                if recorder is not None:
                    recorder.add(examined.name, scene, examined.outcomes)
                if baseline is not None:
                    since = baseline.since(examined.name, scene, examined.outcomes, record.factor)
                    console.say(since_text(since) + "\n")
            else:
                examined, explained = scene, []
            results.add(examined, since, explained)
            if telling is not None:
                telling.add(examined, scene if isinstance(scene, Scene) else None, explained)
            journal.keep(results.data, _finished(results, names))
            if options.fail_fast and ends_the_run(examined, since) and place + 1 < len(names):
                record.stopped = f"--fail-fast ended the run at {examined.name}"
                break
        if all_of_ours and not own and not record.not_run:
            results.paper = compare_with_paper()
        _say_at_the_end(results, pairs, len(names), console)
        ending.status = record.ended = record.status
        if console.quiet and ending.status is ExitStatus.NO_VERDICT:
            for line in _why_no_verdict(record):
                console.complain(line)
        if page is not None and telling is not None:
            told("the page", len(names))
            whole = page.write(telling.run(head, record, results.paper, results.data()["baseline"]), console)
            ending.status = whole.status
            if brief:
                console.mute = mute
                console.say(f"{whole.sentence}\n{page.place}")
    return ending.status


@contextmanager
def _solver(options: argparse.Namespace) -> Iterator[Mapping[str, PlainSolver]]:
    """The solver of one's own by its name, as long as the run needs it; none if there is none.

    Raises:
        NoSolver: it cannot be found, or its accuracy is none.
    """
    if options.solver is None:
        yield {}
        return
    name = shown(options.solver)
    accuracy = required_accuracy(ACCURACY if options.accuracy is None else options.accuracy)
    if options.in_process:
        yield {name: PlainSolver(name, solver_at(options.solver, options.traceback), accuracy)}
        return
    with Apart(options.solver, options.traceback, options.solver_timeout or LIMIT) as solver:
        solver.found()
        yield {name: PlainSolver(name, solver, accuracy)}


def _require_solver_options(options: argparse.Namespace) -> None:
    if options.solver is not None and options.first is not None:
        raise UsageError("--solver and --first are both given; the solver takes the place of --first")
    for option in ("--accuracy", "--traceback", "--solver-timeout", "--in-process"):
        given = getattr(options, option.strip("-").replace("-", "_"))
        if options.solver is None and given not in (None, False):
            also = ", or about a file: --data FILE" if option == "--accuracy" else ""
            raise UsageError(f"{option} is about a solver of your own: give --solver MODULE:NAME{also}")
    if options.in_process and options.solver_timeout is not None:
        raise UsageError("--in-process has no time limit; leave --solver-timeout out, or --in-process")


def _names(options: argparse.Namespace) -> list[str]:
    """The scenes that are named, then those of a folder; where neither is given, all built-in ones."""
    folder = [] if options.scenes_dir is None else list(scenes_below(options.scenes_dir))
    named = [*options.scenes, *folder] or list(DEFAULT_SCENES)
    # A scene that is named again would say the same again, under the same name; standard input is refused.
    return [name for i, name in enumerate(named) if name == STANDARD_INPUT or name not in named[:i]]


def _pairs(options: argparse.Namespace) -> tuple[tuple[str, str], ...]:
    if options.solver is not None:
        if options.second == "":
            raise UsageError(f"a formulation without a name; there are: {', '.join(NAMES)}")
        return ((shown(options.solver), options.second or FIRST),)
    first, second = options.first or FIRST, options.second or SECOND
    if options.first == "" or options.second == "":
        raise UsageError(f"a formulation without a name; there are: {', '.join(NAMES)}")
    if first == second:
        others = ", ".join(name for name in NAMES if name != first)
        raise UsageError(
            f"{first!r} is to be compared with itself, which tells nothing; "
            f"give another --first or --second: {others}"
        )
    alone = options.first is None and options.second is None
    return ((first, second), FURTHER) if alone else ((first, second),)


def _loaded(names: Sequence[str], console: Console) -> list[tuple[str, Scene | Examined]]:
    """The scenes, all read before any is solved; of those that cannot be, it is said at once why not."""
    scenes: list[tuple[str, Scene | Examined]] = []
    for name in names:
        try:
            scenes.append((name, load_scene(name)))
        except SceneError as error:
            bad = Examined(name=name_of(name), problem=str(error))
            console.complain(bad.complaint)
            scenes.append((name, bad))
    return scenes


def _say(examined: Examined, explained: Explained, console: Console) -> None:
    if examined.complaint:
        console.complain(examined.complaint)
    else:
        for warning in examined.warnings:
            console.warn(f"{examined.name}: {warning}")
    told = list(zip(examined.outcomes, explained, strict=True))
    for outcome, why in told[:1]:
        notes = (f"  note: {note}" for note in examined.defaults)
        console.show((*report.outcome_parts(outcome, why), *notes, ""))
    for outcome, why in told[1:]:
        # The tables of a further pair would say nearly the same.
        same = outcome.agreed
        parts = (report.agreement_line(outcome),) if same else report.outcome_parts(outcome, why)
        console.show((*parts, ""))


def _finished(results: _Results, names: Sequence[str]) -> str:
    return f"{len(results.scenes)} of {report.counted_as(len(names), 'scene')}"


def _say_at_the_end(
    results: _Results, pairs: Sequence[tuple[str, str]], count: int, console: Console
) -> None:
    if results.printed:
        console.show((*report.findings_parts(results.findings, results.printed), ""))
    for name, why in results.unprinted:
        console.say(f"The paper's formulas as printed cannot solve {name}: {why.message}\n")
    if results.paper:
        console.show((*report.paper_parts(results.paper), ""))
    agreed = [results.agreed.get(pair, 0) for pair in pairs]
    counts = [report.agreeing(agreed[0], count), *(f"{more} of {count}" for more in agreed[1:])]
    told = [
        f"{words} between {first} and {second}" for words, (first, second) in zip(counts, pairs, strict=True)
    ]
    # No agreement is no disagreement yet: what was not compared is counted apart.
    record = results.record
    rest = f"; {results.uncompared} of {count} could not be compared at all" if results.uncompared else ""
    if record.not_run:
        rest += f"; {len(record.not_run)} of {count} not run ({record.stopped}): {', '.join(record.not_run)}"
    rest += _how_much(record)
    if record.factor != 1.0:
        rest += f"; {report.held_to(record.factor)}"
    console.say(", ".join(told) + rest + ".")
    if results.baseline is not None:
        _say_what_moved(record, console)


def _how_much(record: Record) -> str:
    """How much of what is asked for was compared, of a solver that may give what it has."""
    counts: Counter[str] = Counter()
    for _, outcome in record.outcomes:
        counts.update(outcome.counts if outcome.stated else {})
    verdicts = get_args(Verdict)
    if not (count := sum(counts[verdict] for verdict in verdicts)):
        return ""
    rest = "".join(f", {counts[v]} {v}" for v in ("not given", "not tested") if counts[v])
    back = f", {counts['given back']} of them data that the solver was given" if counts["given back"] else ""
    return f"; {counts['agrees'] + counts['disagrees']} of {count} numbers compared{back}{rest}"


def _say_what_moved(record: Record, console: Console) -> None:
    held = [since for since in record.since if since.compared]
    moved = [since.scene for since in held if since.moved]
    names = f": {', '.join(moved)}" if moved else ""
    nouns = "scene" if len(held) == 1 else "scenes"
    told = (
        f"Since the baseline {shown(str(record.baseline))} {len(moved)} of {len(held)} {nouns} moved{names}"
    )
    if not held:
        told = f"Since the baseline {shown(str(record.baseline))} no scene could be compared"
    lost = [line for since in record.since for line in lost_lines(since)]
    lacking = f"; given then and not now: {'; '.join(lost)}" if lost else ""
    gone = f"; gone, in the baseline and not in this run: {', '.join(record.gone)}" if record.gone else ""
    nothing = "; nothing of this run could be held to it" if not held else ""
    others = [since.words for since in record.since if since.replaced]
    another = f"; no verdict: {'; '.join(others)}" if others else ""
    console.say(f"{told}{lacking}{another}{gone}{nothing}.")


def _why_no_verdict(record: Record) -> Iterator[str]:
    """Why scenes have no verdict, a line each; not those of which a complaint has said it."""
    for examined in record.examined:
        for outcome in examined.outcomes[: 0 if examined.complaint else None]:
            if not outcome.passed and not outcome.disagreements:
                words = outcome.why_no_verdict or "not every number is tested"
                untested = [row for row in outcome.undecided if row.verdict == "not tested"]
                for row in (*untested, *outcome.undecided)[:1]:
                    words += f"; {report.about(row.quantity, row.name)}: {why_undecided(row, outcome)}"
                yield f"{examined.name}: no verdict: {words}"
    for since in record.since:
        if since.status is ExitStatus.NO_VERDICT:
            words = since.words or f"{since.scene}: not every number is tested"
            yield f"no verdict since the baseline: {words}"
