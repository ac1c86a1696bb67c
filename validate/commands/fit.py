"""`pointcoord fit`: the hardpoints that best explain measured curves, and what these leave open."""

from __future__ import annotations

import argparse
import os
import shlex

from validate.commands.to_fill_in import to_be_filled_in
from validate.commands.usage import (
    STANDARD_INPUT,
    add_json,
    add_output,
    add_quiet,
    add_scene,
    leave_output_to,
    load_scene,
    name_of,
    require_target,
    told_as,
    write_result,
)
from validate.errors import UsageError
from validate.exit_status import ExitStatus
from validate.fitting.fit import BOUNDS, PRIOR, fit_hardpoints, free_coordinates, require_limits
from validate.fitting.record import corrected_text, data_of, table_of
from validate.fitting.words import text_of, warnings_of_fit
from validate.measured.mapping import map_to_fill_in, read_results
from validate.output.console import Console
from validate.output.document import Head, json_text
from validate.output.files import require_known_ending, require_writable
from validate.output.progress import progress
from validate.plain_text import shown

ENDINGS = (".toml",)
HOLDS = {"-o": "the corrected scene", "--json": "the fit", "--csv": "the corrections"}

DESCRIPTION = """\
Find the corrections of hardpoints that best explain a file of results, by least squares, each
number weighed by the digits that it is written with. Says what is left, how well each correction
is known, and which combinations of coordinates the data cannot see. Where there are such, the
answer is one of many: the likeliest if every coordinate is off by --prior or so, not the one that
moves the fewest hardpoints. Where you know which points are in doubt, name them by --free."""


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command with its options."""
    parser = commands.add_parser("fit", help="fit hardpoints to measured curves", description=DESCRIPTION)
    add_scene(parser)
    parser.add_argument(
        "--data",
        metavar="FILE",
        required=True,
        help="a file of results (CSV, whitespace table, Parquet), as for validate --data",
    )
    parser.add_argument(
        "--map", metavar="FILE.toml", help="what the columns of --data are; a new one is written"
    )
    parser.add_argument(
        "--free",
        metavar="POINT.AXIS",
        nargs="+",
        default=[],
        help="coordinates to correct, such as lower_ball_joint.z, or points for all three; none: every point",
    )
    parser.add_argument(
        "--bounds",
        metavar="MM",
        type=float,
        default=BOUNDS,
        help=f"how far a coordinate may move at most ({BOUNDS:g} if not given)",
    )
    parser.add_argument(
        "--prior",
        metavar="MM",
        type=float,
        default=PRIOR,
        help="how far off a coordinate is thought to be, a standard deviation: the smaller, the less "
        f"hardpoints move along what the data leave open ({PRIOR:g} if not given, a fifth of the bounds that "
        "are taken then)",
    )
    parser.add_argument(
        "--accuracy",
        metavar="A",
        type=float,
        default=0.0,
        help="how far off the numbers of --data may be beside their digits, each in its column's unit",
    )
    add_output(parser, "SCENE.toml", "the corrected scene; - for the output")
    add_json(parser, "all of it")
    parser.add_argument(
        "--csv", metavar="FILE", help="write the coordinates and their corrections as a table; - likewise"
    )
    add_quiet(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Fit a scene's hardpoints to a file.

    Returns:
        NO_VERDICT if least squares did not end.
    Raises:
        UsageError: the options do not go together, the target has no name for a scene, or a coordinate is
            there twice.
        FileError, UnknownName: the file, its map or an option is wrong.
        SceneError: the scene is wrong; PointcoordError: it cannot be solved.
        OutputError: a result cannot be written.
    """
    if STANDARD_INPUT in (options.data, options.map):
        raise UsageError("--data and --map read files; standard input (-) can be the scene only")
    limits = options.bounds, options.prior, options.accuracy
    require_limits(*limits, mark="--")
    targets = _targets(options, console)
    scene, name = load_scene(options.scene), name_of(options.scene)
    if options.map is not None and not os.path.exists(options.map):
        return to_be_filled_in(options.map, map_to_fill_in(options.data, scene), console)
    head = Head.of("fit", options.command)
    with told_as(name), progress(console, "designs", total=None, lines=False) as told:
        measured = read_results(options.data, options.map, scene)
        count = len(free_coordinates(scene, options.free))
        numbers = len(measured.numbers) * len(measured.rows)
        console.note(f"{name}: {count} coordinates are fitted to {numbers} numbers; this may take a while")
        fit = fit_hardpoints(scene, measured, options.free, *limits, told=told)
    status = ExitStatus.AGREE if fit.converged else ExitStatus.NO_VERDICT
    source = measured.source
    console.say(text_of(fit, name, source))
    for note in (*measured.notes, *fit.notes):
        console.note(f"{name}: {note}")
    for warning in warnings_of_fit(fit):
        console.warn(f"{name}: {warning}")
    texts = {
        "-o": lambda: corrected_text(fit, name, source),
        "--json": lambda: json_text(head.document(data_of(fit, name, source), status, True)),
        "--csv": lambda: table_of(fit),
    }
    for option, target in targets.items():
        write_result(target, texts[option](), HOLDS[option], console)
    if options.output not in (None, "-"):
        console.say(f"{shown(options.output)} is written; try: {_next(options)}")
    return status


def _next(options: argparse.Namespace) -> str:
    """The command that holds the corrected scene to the same file."""
    words = ["pointcoord", "validate", "--data", options.data]
    if options.map is not None:
        words += ["--map", options.map]
    if options.accuracy:
        words += ["--accuracy", f"{options.accuracy:g}"]
    return shown(shlex.join([*words, options.output]))


def _targets(options: argparse.Namespace, console: Console) -> dict[str, str]:
    """Where results go, each to a place of its own; standard output is left to one that is to go there.

    Raises:
        UsageError, OutputError: see `run`.
    """
    given = {"-o": options.output, "--json": options.json, "--csv": options.csv}
    targets = {option: target for option, target in given.items() if target is not None}
    files = tuple(file for file in (options.scene, options.data, options.map) if file is not None)
    by_place: dict[str, str] = {}
    for option, target in targets.items():
        require_target(target, option, files)
        other = by_place.setdefault(target if target == "-" else os.path.realpath(target), option)
        if other != option:
            raise UsageError(f"{other} and {option} are both {shown(target)}; give each a file of its own")
    advice = "use --quiet with -o FILE, --json FILE or --csv FILE"
    leave_output_to(targets.values(), options, console, advice)
    for option, target in targets.items():
        if target != "-":
            if option == "-o":
                require_known_ending(target, ENDINGS)
            require_writable(target)
    return targets
