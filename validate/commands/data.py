"""`pointcoord validate --data`: compares a file of results with the car of a scene."""

from __future__ import annotations

import argparse
import os

from validate.ci.record import Record
from validate.ci.verdict import next_step
from validate.closed_drawing import closing_data, closing_of, warnings_of
from validate.commands.comparing import comparing
from validate.commands.usage import load_scene, name_of, named_scene, to_be_filled_in
from validate.comparison.examined import Examined
from validate.errors import UsageError
from validate.exit_status import ExitStatus
from validate.measured.comparing import OURS, compare_results
from validate.measured.mapping import FARTHEST, map_to_fill_in, read_results
from validate.output import report
from validate.output.console import Console
from validate.plain_text import shown


def run(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Compare a file with a scene's car."""
    if len(options.scenes) != 1:
        given = f"{len(options.scenes)} scenes are" if options.scenes else "no scene is"
        raise UsageError(f"{given} given with --data; give the one scene that the file is about")
    if options.accuracy is not None and not 0.0 <= options.accuracy <= FARTHEST:
        raise UsageError(f"--accuracy is {options.accuracy}; allowed: a number from 0 to {FARTHEST:g}")
    (given,) = options.scenes
    if options.map is not None and not os.path.exists(options.map):
        return to_be_filled_in(options.map, map_to_fill_in(options.data, load_scene(given)), console)
    name = name_of(given)
    record = Record([name], options.tolerance_factor)
    with comparing(options, console, record) as compared, named_scene(given) as (scene, _):
        measured = read_results(options.data, options.map, scene)
        found = compare_results(measured, scene, name, options.accuracy, options.tolerance_factor)
        moved = closing_of(scene)
        examined = Examined(
            name=name,
            title=shown(scene.title),
            outcomes=(found.outcome,),
            solved=(OURS,),
            warnings=warnings_of(scene, moved),
            closing=closing_data(moved),
            defaults=scene.mechanism.defaults_taken,
        )
        record.files[name] = found
        compared.add(examined)
        console.warn(*examined.warnings, of=name)
        console.show(report.file_parts(found))
        if step := next_step(record):
            console.say(step)
    return compared.journal.status
