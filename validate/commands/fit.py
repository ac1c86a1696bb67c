"""`pointcoord fit`: the hardpoints that best explain measured curves, and what these leave open."""

from __future__ import annotations

import argparse
import os
import shlex

from validate.commands.data import require_files
from validate.commands.usage import (
    TOML,
    Commands,
    add_json,
    add_output,
    load_scene,
    name_of,
    require_results,
    share,
    to_be_filled_in,
    told_as,
    write_result,
)
from validate.exit_status import ExitStatus
from validate.fitting.fit import BOUNDS, PRIOR, fit_hardpoints, free_coordinates, require_limits
from validate.fitting.record import corrected_text, data_of, table_of
from validate.fitting.words import text_of, warnings_of_fit
from validate.measured.mapping import map_to_fill_in, read_results
from validate.output.console import Console
from validate.output.document import Head, json_text
from validate.output.progress import progress
from validate.plain_text import shown

HOLDS = {"-o": "the corrected scene", "--json": "the fit", "--csv": "the corrections"}

DESCRIPTION = """\
Find the corrections of hardpoints that best explain a file of results, by least squares, each
number weighed by the digits that it is written with. Says what is left, how well each correction
is known, and which combinations of coordinates the data cannot see. Where there are such, the
answer is one of many: the likeliest if every coordinate is off by --prior or so, not the one that
moves the fewest hardpoints. Where you know which points are in doubt, name them by --free."""


def add(commands: Commands) -> None:
    """Add the command with its options."""
    parser = commands.add_parser("fit", help="fit hardpoints to measured curves", description=DESCRIPTION)
    share(parser, "scene")
    share(parser, "--data", required=True, help="a file of results, as for validate --data")
    share(parser, "--map")
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
    share(parser, "--quiet")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Fit a scene's hardpoints to a file.

    Returns:
        NO_VERDICT if least squares did not end.
    """
    require_files(options)
    limits = options.bounds, options.prior, options.accuracy
    require_limits(*limits, mark="--")
    targets = {"-o": options.output, "--json": options.json, "--csv": options.csv}
    require_results(targets, (options.scene, options.data, options.map), options, console, {"-o": TOML})
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
        if target is not None:
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
