"""`pointcoord fit`: the hardpoints that best explain measured curves, or which few of them would."""

from __future__ import annotations

import argparse
import os
import shlex
from dataclasses import replace

from validate.commands.data import require_files
from validate.commands.usage import (
    TOML,
    Command,
    load_scene,
    name_of,
    require_results,
    to_be_filled_in,
    told_as,
)
from validate.errors import UsageError
from validate.exit_status import ExitStatus
from validate.fitting.fit import BOUNDS, PRIOR, fit_hardpoints, free_coordinates, require_limits
from validate.fitting.suspect_words import (
    data_of_suspects,
    table_of_suspects,
    text_of_suspects,
    warnings_of_suspects,
)
from validate.fitting.suspects import Suspects, suspected
from validate.fitting.words import corrected_text, data_of, table_of, text_of, warnings_of_fit
from validate.measured.mapping import Measured, map_to_fill_in, read_results
from validate.output.console import Console
from validate.output.document import Head, json_text
from validate.plain_text import shown


def run(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Fit a scene's hardpoints to a file.

    Returns:
        NO_VERDICT if least squares did not end; of suspects, if nothing explains the file and some did not.
    """
    require_files(options)
    limits = options.bounds, options.prior, options.accuracy
    require_limits(*limits, mark="--")
    if options.suspects and options.output is not None:
        raise UsageError(
            f"-o {shown(options.output)}: --suspects corrects nothing; allowed: -o with --free, which fits "
            "the coordinates that it names"
        )
    targets = {"-o": options.output, "--json": options.json, "--csv": options.csv}
    require_results(targets, (options.scene, options.data, options.map), options, console, {"-o": TOML})
    scene, name = load_scene(options.scene), name_of(options.scene)
    if options.map is not None and not os.path.exists(options.map):
        return to_be_filled_in(options.map, map_to_fill_in(options.data, scene), console)
    head = Head.of("fit", options.command)
    with told_as(name), console.progress("designs", lines=False) as told:
        measured = read_results(options.data, options.map, scene)
        count = len(free_coordinates(scene, options.free))
        numbers = len(measured.numbers) * len(measured.rows)
        told_of = "suspected, of" if options.suspects else "fitted to"
        console.note(f"{name}: {count} coordinates are {told_of} {numbers} numbers; this may take a while")
        if options.suspects:
            suspects = suspected(scene, measured, options.free, *limits, told=told)
        else:
            fit = fit_hardpoints(scene, measured, options.free, *limits, told=told)
    if options.suspects:
        return _said_of_suspects(suspects, name, measured, options, head, console)
    status = ExitStatus.AGREE if fit.converged else ExitStatus.NO_VERDICT
    source = measured.source
    console.say(text_of(fit, name, source))
    for note in (*measured.notes, *fit.notes):
        console.note(f"{name}: {note}")
    for warning in warnings_of_fit(fit):
        console.warn(f"{name}: {warning}")
    if options.output is not None:
        console.put(options.output, corrected_text(fit, name, source), "the corrected scene")
    if options.json is not None:
        document = head.document(data_of(fit, name, source), status, True)
        console.put(options.json, json_text(document), "the fit")
    if options.csv is not None:
        console.put(options.csv, table_of(fit), "the corrections")
    if options.output not in (None, "-"):
        again = shlex.join(["pointcoord", "validate", *_given(options), options.output])
        console.say(f"{shown(options.output)} is written; try: {shown(again)}")
    return status


def _said_of_suspects(
    found: Suspects, name: str, measured: Measured, options: argparse.Namespace, head: Head, console: Console
) -> ExitStatus:
    """Say, and write, which sets of coordinates would explain a file."""
    surely = found.ended or found.explaining or found.drawn
    status = ExitStatus.AGREE if surely else ExitStatus.NO_VERDICT
    console.say(text_of_suspects(found, name, measured.source))
    for note in (*measured.notes, *found.notes):
        console.note(f"{name}: {note}")
    for warning in warnings_of_suspects(found):
        console.warn(f"{name}: {warning}")
    if options.json is not None:
        document = replace(head, kind="fit-suspects").document(
            data_of_suspects(found, name, measured.source), status, True
        )
        console.put(options.json, json_text(document), "the suspects")
    if options.csv is not None:
        console.put(options.csv, table_of_suspects(found), "the suspects")
    if found.explaining:
        first = [*found.explaining[0].coordinates]
        again = shlex.join(["pointcoord", "fit", options.scene, *_given(options), "--free", *first])
        console.say(f"to correct the first: {shown(again)} -o corrected.toml")
    return status


def _given(options: argparse.Namespace) -> list[str]:
    """The file, its map and accuracy, as they were given."""
    given = ["--data", options.data, *(() if options.map is None else ("--map", options.map))]
    return given + (["--accuracy", f"{options.accuracy:g}"] if options.accuracy else [])


COMMANDS = {
    "fit": Command(run, {"bounds": f"{BOUNDS:g}", "prior": f"{PRIOR:g}"}, {"--data": {"required": True}})
}
