"""`pointcoord fit`: corrections of hardpoints that explain measured curves, or the few that may be wrong."""

from __future__ import annotations

import argparse
import os
import shlex

from validate.commands.pages import Command
from validate.commands.usage import named_scene, to_be_filled_in
from validate.errors import UsageError
from validate.exit_status import ExitStatus
from validate.fitting.fit import fit_hardpoints
from validate.fitting.problem import BOUNDS, PRIOR, Problem
from validate.fitting.report import corrected_text, report_of_fit, report_of_suspects
from validate.fitting.suspects import suspected
from validate.measured.mapping import map_to_fill_in, read_results
from validate.output.console import Console
from validate.output.document import Journal
from validate.plain_text import counted_as, shown


def run(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Fit a scene's hardpoints to a file.

    Returns:
        NO_VERDICT if least squares did not converge; with --suspects, if nothing explains the file and some
        fits did not converge.
    """
    target = options.output
    if options.suspects and target is not None:
        raise UsageError(
            f"-o {shown(target)}: --suspects corrects nothing; allowed: -o with --free, which fits "
            "the coordinates that it names"
        )
    with named_scene(options.scene) as (scene, name), console.progress("designs") as progress:
        if options.map is not None and not os.path.exists(options.map):
            return to_be_filled_in(options.map, map_to_fill_in(options.data, scene), console)
        measured = read_results(options.data, options.map, scene)
        problem = Problem.of(scene, measured, options.free, options.bounds, options.prior, options.accuracy)
        coordinates, source = counted_as(len(problem.free), "coordinate"), measured.source
        task = f"testing {coordinates} as suspects with" if options.suspects else f"fitting {coordinates} to"
        console.note(f"{task} {counted_as(len(problem.spread), 'number')}; this may take a while", of=name)
        if options.suspects:
            suspects = suspected(problem, progress)
            report, corrected = report_of_suspects(suspects, name, source), ""
        else:
            fit = fit_hardpoints(problem, told=progress)
            report, corrected = report_of_fit(fit, name, source), corrected_text(fit, name, source)
    console.say(report.text)
    console.note(*measured.notes, *report.notes, of=name)
    console.warn(*report.warnings, of=name)
    if target is not None:
        console.put(target, corrected, "the corrected scene")
    Journal.of(options, console, report.kind, lambda: report.data(name, source), lambda: report.what).write(
        report.status
    )
    if options.csv is not None:
        console.put(options.csv, report.table, report.what)
    again = ["--data", options.data, *(["--map", options.map] if options.map is not None else [])]
    again += ["--accuracy", f"{options.accuracy:g}"] if options.accuracy else []
    if target not in (None, "-"):
        step = shlex.join(["pointcoord", "validate", *again, target])
        console.say(f"{shown(target)} is written; try: {shown(step)}")
    if options.suspects and suspects.explaining:
        first = suspects.explaining[0].coordinates
        step = shlex.join(["pointcoord", "fit", options.scene, *again, "--free", *first])
        console.say(f"to correct the first: {shown(step)} -o corrected.toml")
    return report.status


COMMANDS = {"fit": Command(run, {"bounds": f"{BOUNDS:g}", "prior": f"{PRIOR:g}"})}
