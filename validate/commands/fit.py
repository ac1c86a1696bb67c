"""`pointcoord fit`: the hardpoints that best explain measured curves, and what these leave open."""

from __future__ import annotations

import argparse
import os
import shlex

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
from validate.exit_status import ExitStatus
from validate.fitting.fit import BOUNDS, PRIOR, fit_hardpoints, free_coordinates, require_limits
from validate.fitting.words import corrected_text, data_of, table_of, text_of, warnings_of_fit
from validate.measured.mapping import map_to_fill_in, read_results
from validate.output.console import Console
from validate.output.document import Head, json_text
from validate.plain_text import shown


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
    with told_as(name), console.progress("designs", lines=False) as told:
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
    if options.output is not None:
        console.put(options.output, corrected_text(fit, name, source), "the corrected scene")
    if options.json is not None:
        document = head.document(data_of(fit, name, source), status, True)
        console.put(options.json, json_text(document), "the fit")
    if options.csv is not None:
        console.put(options.csv, table_of(fit), "the corrections")
    if options.output not in (None, "-"):
        given = ["--data", options.data, *(() if options.map is None else ("--map", options.map))]
        given += ["--accuracy", f"{options.accuracy:g}"] if options.accuracy else []
        again = shlex.join(["pointcoord", "validate", *given, options.output])
        console.say(f"{shown(options.output)} is written; try: {shown(again)}")
    return status


COMMANDS = {
    "fit": Command(run, {"bounds": f"{BOUNDS:g}", "prior": f"{PRIOR:g}"}, {"--data": {"required": True}})
}
