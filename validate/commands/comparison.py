"""`pointcoord validate`: scenes solved by several formulations, and every quantity compared."""

from __future__ import annotations

import argparse
import os
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from pointcoord import Scene, SceneError
from pointcoord.toml_text import parsed, read_file
from validate.ci import verdict
from validate.ci.baseline import Since, read_baseline
from validate.ci.record import Record, ends_the_run
from validate.commands.comparing import comparing
from validate.commands.pages import Command
from validate.commands.usage import given, load_scene, name_of
from validate.comparison.examined import Examined, examine
from validate.errors import UsageError
from validate.exit_status import ExitStatus
from validate.formulations.registry import NAMES, WORDS, formulation, second_there
from validate.output import report
from validate.output.console import Console
from validate.output.table import Part
from validate.paper.scenes import DEFAULT_SCENES, PAPER_SCENES
from validate.paper.tables import WHY_NOT_EQUAL, compare_with_paper
from validate.plain_text import counted_as, shown
from validate.solvers.apart import LIMIT, Apart
from validate.solvers.check import ACCURACY, required_accuracy
from validate.solvers.load import solver_at
from validate.solvers.plain import PlainSolver

FIRST = "pointcoord"
# Without --first and --second the paper's own algorithm is compared with the second model too.
FURTHER = "pointcoord-newton"

# The kinds of runs, named by the option that selects each, and the kinds that each option is allowed with.
SCENES, A_SOLVER, A_FILE, TABLES = "scenes alone", "--solver", "--data", "--tables"
GOES_WITH: Mapping[str, tuple[str, ...]] = {
    "--first": (SCENES,),
    "--second": (SCENES, A_SOLVER),
    **dict.fromkeys((A_SOLVER, "--traceback", "--solver-timeout", "--in-process"), (A_SOLVER,)),
    **dict.fromkeys((A_FILE, "--map"), (A_FILE,)),
    "--accuracy": (A_SOLVER, A_FILE),
    **dict.fromkeys(("--scenes-dir", "--fail-fast", "--save-baseline", "--baseline"), (SCENES, A_SOLVER)),
    **dict.fromkeys(("--hard", "--cost"), (SCENES, A_SOLVER)),
    **dict.fromkeys(("scenes", "--report", "--tolerance-factor"), (SCENES, A_SOLVER, A_FILE)),
}

_WIDTH = max(map(len, WORDS))
PAGE_WORDS = {
    "formulations": "\n".join(f"  {name.ljust(_WIDTH)}  {words}" for name, words in WORDS.items()),
    "accuracy": f"{ACCURACY:g}",
    "limit": f"{LIMIT:g}",
}


def run(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Compare scenes, a file or tables. Each result is printed and written as JSON as soon as it is known."""
    kind = require_sense(options)
    if options.tolerance_factor is None:
        options.tolerance_factor = 1.0
    if kind in (TABLES, A_FILE):
        # Imported here: most runs compare neither.
        from validate.commands import data

        return data.run_tables(options, console) if kind == TABLES else data.run_data(options, console)
    return _compare_scenes(options, console)


def require_sense(options: argparse.Namespace) -> str:
    """The kind of a run.

    Raises:
        UsageError: an option is given that has no effect in such a run.
    """
    kind = next(iter(given(options, TABLES, A_FILE, A_SOLVER)), SCENES)
    for name in given(options, *GOES_WITH):
        if kind not in GOES_WITH[name]:
            what = "SCENE" if name == "scenes" else name
            with_what = f"goes with {' or '.join(GOES_WITH[name])} only"
            raise UsageError(f"{what} {with_what if kind == SCENES else f'does not go with {kind}'}")
    return kind


def _compare_scenes(options: argparse.Namespace, console: Console) -> ExitStatus:
    names, pairs, verbose = _names(options), _pairs(options, console), options.verbose
    if options.save_baseline == "-":
        raise UsageError("--save-baseline - is not a file; a baseline is binary: give the path of a file")
    for name in dict.fromkeys(name for pair in pairs for name in pair if name != shown(options.solver or "")):
        formulation(name)  # a wrong name is reported before any scene is read
    baseline = None if options.baseline is None else read_baseline(options.baseline)
    record = Record([*map(name_of, names)], options.tolerance_factor, baseline)
    with (
        _solver(options) as own,
        comparing(options, console, record) as compared,
        console.progress("scenes", total=len(names), everywhere="folder" in options) as progress,
    ):
        # All scenes are read before any is solved.
        loaded = [_loaded(name, console) for name in names]
        pair_names = "; ".join(" and ".join(pair) for pair in pairs)
        console.say(f"{pair_names}: {counted_as(len(names), 'scene')}\n")
        width = max(map(len, record.names))
        if not verbose:
            console.say(verdict.scene_line(verdict.HEAD, "time", width))
        for done, (name, scene) in enumerate(zip(names, loaded, strict=True), 1):
            since, began = None, time.monotonic()
            progress(record.names[done - 1], done - 1)
            if isinstance(scene, Scene):
                printed = name in PAPER_SCENES and not own
                examined = _explained(scene, examine(name, scene, pairs, printed, record.factor, own))
                if baseline is not None:
                    since = baseline.since(examined.name, scene, examined.outcomes, record.factor)
                if examined.complaint:
                    console.complain(examined.complaint)
            else:
                examined = scene
            took = time.monotonic() - began
            console.show([*_lines(examined, verbose, took, width), *_moved(since, verbose)])
            compared.add(examined, since, scene if isinstance(scene, Scene) else None)
            if options.fail_fast and ends_the_run(examined, since) and done < len(names):
                record.stopped = f"--fail-fast ended the run at {examined.name}"
                break
        if not own and not record.not_run and not options.scenes and options.scenes_dir is None:
            record.paper = compare_with_paper()
        _say_at_the_end(record, verbose, console)
    return compared.journal.status


def _explained(scene: Scene, examined: Examined) -> Examined:
    """The results of a scene, with possible explanations of its disagreements."""
    if not any(outcome.disagreements for outcome in examined.outcomes):
        return examined
    # Imported here: most runs have no disagreement.
    from validate.diagnosis import explain_outcome

    outcomes = (replace(one, explanations=explain_outcome(scene, one)) for one in examined.outcomes)
    return replace(examined, outcomes=tuple(outcomes))


@contextmanager
def _solver(options: argparse.Namespace) -> Iterator[Mapping[str, PlainSolver]]:
    """The user's solver of --solver by its name, running until the context ends; empty without --solver."""
    if options.solver is None:
        yield {}
        return
    name = shown(options.solver)
    accuracy = required_accuracy(ACCURACY if options.accuracy is None else options.accuracy)
    if options.in_process:
        yield {name: PlainSolver(name, solver_at(options.solver, options.traceback), accuracy)}
        return
    with Apart(options.solver, options.traceback, options.solver_timeout or LIMIT) as solver:
        yield {name: PlainSolver(name, solver, accuracy)}


def _names(options: argparse.Namespace) -> list[str]:
    """The named scenes, then the scenes of --scenes-dir, each once; all built-in scenes if neither is given.

    Scene files below a folder are sorted by their paths; links to folders are not followed.

    Raises:
        UsageError: there is no such folder, or it holds no scene.
    """
    found: list[str] = []
    if (folder := options.scenes_dir) is not None:
        files = sorted(Path(folder).rglob("*.toml")) if os.path.isdir(folder) else []
        found = [str(path) for path in files if path.is_file() and not _is_mechanism(path)]
        if not found:
            problem = "contains no scene" if os.path.isdir(folder) else "is not a folder"
            raise UsageError(
                f"--scenes-dir {folder}: {problem}; allowed: a folder with a .toml file below it"
            )
    return list(dict.fromkeys((*options.scenes, *found))) or list(DEFAULT_SCENES)


def _is_mechanism(path: Path) -> bool:
    """Whether a file holds the tables of a mechanism and no scene; False for a file that cannot be read."""
    try:
        content = parsed(read_file(path, ""), str(path))
    except SceneError:
        return False
    return "mechanism" not in content and ("bodies" in content or "parts" in content)


def _pairs(options: argparse.Namespace, console: Console) -> tuple[tuple[str, str], ...]:
    """The pairs of formulations to compare."""
    if "" in (options.first, options.second):
        raise UsageError(f"--first or --second is empty; there are: {', '.join(NAMES)}")
    if options.solver is not None:
        if options.in_process and options.solver_timeout is not None:
            raise UsageError("--solver-timeout has no effect with --in-process; leave one of them out")
        return ((shown(options.solver), options.second or FIRST),)
    first, second = options.first or FIRST, options.second
    if second is None:
        second, why = second_there()
        if second != "absolute":
            console.warn(f"absolute is not available, {second} is used instead: {why}")
    if options.first is None and options.second is None:
        return (FIRST, second), (FURTHER, second)
    if first == second:
        others = ", ".join(name for name in NAMES if name != first)
        raise UsageError(
            f"--first and --second are both {first!r}; a formulation compared with itself shows nothing; "
            f"give another --first or --second: {others}"
        )
    return ((first, second),)


def _loaded(name: str, console: Console) -> Scene | Examined:
    """Read a scene. If it cannot be read, the reason is printed at once and returned as its result."""
    try:
        return load_scene(name)
    except SceneError as error:
        console.complain(str(error))
        return Examined(name=name_of(name), problem=str(error))


def _lines(examined: Examined, verbose: bool, seconds: float, width: int) -> Iterator[Part]:
    """The line of a scene and the lines below it, or with --verbose its tables."""
    if not verbose:
        yield verdict.scene_line(verdict.scene_row(examined), seconds, width)
        yield from verdict.scene_notes(examined)
        return
    for i, outcome in enumerate(examined.outcomes):
        yield from report.outcome_parts(outcome)
        yield from (f"  note: {note}" for note in examined.defaults if not i)
        yield ""


def _moved(since: Since | None, verbose: bool) -> Iterator[Part]:
    """What has moved since the baseline."""
    if since is not None and (verbose or since.status is not ExitStatus.AGREE):
        yield f"{since.scene}: since the baseline"
        yield from (f"  {line}" for line in verdict.since_lines(since))
        yield ""


def _say_at_the_end(record: Record, verbose: bool, console: Console) -> None:
    """Print the warnings, the verdict of the run, and what to do next."""
    console.warn(*verdict.by_scene(record, lambda one: iter(() if one.complaint else one.warnings)))
    if verbose:
        console.show((*report.printed_parts(record.examined, record.findings), ""))
        if record.paper:
            console.say(f"{WHY_NOT_EQUAL} {report.paper_sentence(record.paper)}\n")
    elif any(one.printed is not None or one.unprinted is not None for one in record.examined):
        wrong = counted_as(len(record.findings), "wrong result")
        console.say(
            f"\nThe paper's formulas as printed give {wrong} in these scenes; -v says which, and why."
        )
    console.say(f"\n{verdict.sentence(record)}.")
    if step := verdict.next_step(record, verbose):
        console.say(step)
    if console.quiet and record.status is ExitStatus.NO_VERDICT:
        for one in record.examined:
            # The complaint of a scene has been printed already.
            if not one.complaint and (why := verdict.silence(one)):
                console.complain(f"{one.name}: {why}")
        for why in verdict.undecided_since(record):
            console.complain(f"no verdict since the baseline: {why}")


COMMANDS = {"validate": Command(run, PAGE_WORDS)}
