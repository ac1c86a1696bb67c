"""The program `pointcoord`.

Exit status 0: all agree. 1: something disagrees, and the table says what. 2: the input is wrong, and one
line on standard error says where.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pointcoord import (
    AssemblyError,
    Motion,
    MotionTooLong,
    MotionTooRough,
    PointcoordError,
    Scene,
    SceneError,
    built_in_scenes,
    simulate,
)
from pointcoord.effects import EFFECTS, plan_effects
from validate import report
from validate.compare import Outcome, compare
from validate.errata import findings
from validate.formulation import FormulationError
from validate.formulations import NAMES, MissingPackage, UnknownFormulation
from validate.output import OutputError, write_json, write_motion
from validate.paper import compare_with_paper

# The paper's scenes, and the chassis motion that is its third degree of freedom.
DEFAULT_SCENES = ("bounce", "steer", "bounce-and-steer", "bounce-on-a-heaving-chassis")


class UsageError(Exception):
    """The command line is wrong."""


REFUSALS = (
    PointcoordError,
    FormulationError,
    UnknownFormulation,
    MissingPackage,
    OutputError,
    UsageError,
)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the program; returns its exit status."""
    try:
        options = _parser().parse_args(arguments)
        return int(options.run(options))
    except REFUSALS as error:
        _complain(str(error))
        return 2
    except BrokenPipeError:
        # The reader of a pipe has gone, such as `head`: nothing is left to say to it.
        sys.stderr.close()
        return 0


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> Any:
        raise UsageError(f"{message}; see pointcoord --help")


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="pointcoord", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    scene_help = "a built-in scene's name or the path of a scene file"

    validate = commands.add_parser("validate", help="solve scenes by two formulations and compare them")
    validate.add_argument(
        "scenes", nargs="*", metavar="SCENE", help=f"{scene_help}; none: the paper's own scenes"
    )
    validate.add_argument("--first", default="pointcoord", metavar="NAME", help=f"one of {', '.join(NAMES)}")
    validate.add_argument(
        "--second", default="absolute", metavar="NAME", help="the other one; default: absolute"
    )
    validate.add_argument("--json", metavar="FILE", help="write the results as JSON; - for standard output")
    validate.set_defaults(run=_validate)

    solve = commands.add_parser("simulate", help="solve a scene by point coordinates only")
    solve.add_argument("scene", metavar="SCENE", help=scene_help)
    solve.add_argument("-o", "--output", metavar="FILE", help=".csv or .npz; none: CSV on standard output")
    solve.set_defaults(run=_simulate)

    plan = commands.add_parser("plan", help="say what a scene would compute, what not, and why")
    plan.add_argument("scene", metavar="SCENE", help=scene_help)
    plan.set_defaults(run=_plan)

    hard = commands.add_parser(
        "hard", help="try the cases that are known to be hard, and hold them to the truth"
    )
    hard.add_argument("cases", nargs="*", metavar="CASE", help="a hard case's name; none: all cases")
    hard.add_argument("--list", action="store_true", help="name the cases and say why each is hard")
    hard.add_argument(
        "--json", metavar="FILE", help="write every trial, or the list, as JSON; - for standard output"
    )
    hard.set_defaults(run=_hard)

    scenes = commands.add_parser("scenes", help="list the built-in scenes")
    scenes.set_defaults(run=_scenes)
    return parser


def _validate(options: argparse.Namespace) -> int:
    names = options.scenes or list(DEFAULT_SCENES)
    scenes = [(name, Scene.load(name)) for name in names]  # every file is read before anything is solved
    speak = options.json != "-"
    outcomes: list[Outcome] = []
    printed: list[Outcome] = []
    refusals: list[tuple[str, Exception]] = []
    unprinted: list[tuple[str, Exception]] = []
    for name, scene in scenes:
        try:
            outcome = compare(scene, options.first, options.second, name)
        except (FormulationError, SceneError) as error:
            refusals.append((name, error))
            _complain(_reason(name, error))
            continue
        outcomes.append(outcome)
        if speak:
            print(report.outcome_text(outcome), end="\n\n", flush=True)
        try:
            printed.append(compare(scene, options.first, "printed", name))
        except (FormulationError, SceneError) as error:
            # The formulas as printed lose rank where the mended ones do not: that is no fault of the scene.
            unprinted.append((name, error))
    errata = findings(printed)
    paper = compare_with_paper() if not options.scenes else ()
    if speak:
        if printed:
            print(report.findings_text(errata, [o.scene for o in printed]), end="\n\n")
        for name, why in unprinted:
            print(f"The paper's formulas as printed cannot solve {_reason(name, why)}", end="\n\n")
        if paper:
            print(report.paper_text(paper), end="\n\n")
        agreed = sum(o.agreed for o in outcomes)
        print(f"{agreed} of {len(scenes)} scenes agree between {options.first} and {options.second}.")
    if options.json:
        write_json(
            options.json,
            {
                "comparisons": [report.outcome_data(outcome) for outcome in outcomes],
                "refused": [{"scene": name, "reason": _reason(name, why)} for name, why in refusals],
                "refused_by_printed_formulas": [
                    {"scene": name, "reason": _reason(name, why)} for name, why in unprinted
                ],
                "printed_formulas": [report.finding_data(finding) for finding in errata],
                "printed_tables": report.paper_data(paper) if paper else None,
            },
        )
    if refusals:
        return 2
    return 0 if all(outcome.agreed for outcome in outcomes) else 1


def _complain(message: str) -> None:
    """One line on standard error."""
    print(f"pointcoord: {' '.join(message.split())}", file=sys.stderr)


def _reason(name: str, error: Exception) -> str:
    """Why a scene is refused, beginning with the name that the user gave it."""
    if isinstance(error, SceneError):
        return str(SceneError(name, error.key, error.problem, error.allowed))
    return f"{name}: {error}"


def _hard(options: argparse.Namespace) -> int:
    try:
        # The truth needs packages that the solvers do without.
        from validate.hard import catalogue, run
        from validate.hard import report as hard_report
    except ModuleNotFoundError as error:
        raise MissingPackage("truth", error.name or "python-flint") from error
    try:
        cases = catalogue.chosen(options.cases)
    except catalogue.UnknownCase as error:
        raise UsageError(str(error)) from None
    speak = options.json != "-"
    if options.json and speak:
        _require_writable(options.json)
    if options.list:
        if speak:
            print(hard_report.listing(cases))
        if options.json:
            write_json(options.json, hard_report.listing_data(cases))
        return 0
    headings: list[str] = []

    def tell(result: run.Examined) -> None:
        if not speak:
            return
        if result.case.group not in headings:
            headings.append(result.case.group)
            print(f"== {result.case.group}", end="\n\n")
        print(hard_report.case_text(result, bool(options.cases)), end="\n\n", flush=True)

    results = run.run(cases, tell)
    if speak:
        print(hard_report.summary_text(results))
    if options.json:
        write_json(options.json, hard_report.results_data(results))
    return 0 if run.as_expected(results) else 1


def _require_writable(target: str) -> None:
    """Find out whether a file can be written, and leave it as it is.

    Raises:
        OutputError: it cannot be.
    """
    path = Path(target)
    new = not path.exists()
    if not new and not path.is_file() and not path.is_dir():
        return  # a pipe or a device, which closing might end
    try:
        path.open("ab").close()
        if new:
            path.unlink()
    except OSError as error:
        raise OutputError(target, f"cannot be written ({error.strerror})") from None


def _simulate(options: argparse.Namespace) -> int:
    scene = Scene.load(options.scene)
    try:
        write_motion(options.output, simulate(scene))
    except (AssemblyError, MotionTooLong, MotionTooRough) as error:
        # What was solved before the motion stopped is kept, and the status says that it is not all.
        if isinstance(error.partial, Motion):
            write_motion(options.output, error.partial)
        raise
    except SceneError as error:
        raise SceneError(options.scene, error.key, error.problem, error.allowed) from error
    return 0


def _plan(options: argparse.Namespace) -> int:
    scene = Scene.load(options.scene)
    plan = plan_effects(scene.effects)
    print(f"{options.scene}: {scene.title}" if scene.title else options.scene)
    print(
        f"mechanism: {scene.mechanism.type}, {scene.mechanism.side} side; inputs: {', '.join(scene.inputs)}"
    )
    print(f"instants: {scene.time.samples} from {scene.time.start:g} to {scene.time.stop:g} s")
    print("computed: position of every point, mm")
    for name in plan.effects:
        print(f"computed: {EFFECTS[name].gives} ({name})")
    for name in plan.left_out:
        print(f"left out: {EFFECTS[name].gives}; add {name!r} to effects to have it")
    print(
        f"derivatives solved for: {plan.derivative}; evaluated for every point: {plan.derivative_of_points}, "
        f"for the knuckle's points: {plan.derivative_of_knuckle}"
    )
    return 0


def _scenes(options: argparse.Namespace) -> int:
    names = built_in_scenes()
    width = max(len(name) for name in names)
    for name in names:
        print(f"{name.ljust(width)}  {Scene.load(name).title}")
    return 0
