"""`pointcoord validate --data`: a file of results held to the car of a scene."""

from __future__ import annotations

import argparse
import os

from pointcoord import Scene
from validate.ci.record import Record
from validate.ci.verdict import next_step
from validate.closed_drawing import closing_data, closing_of, warnings_of
from validate.commands.reporting import Page
from validate.commands.to_fill_in import to_be_filled_in
from validate.commands.usage import (
    STANDARD_INPUT,
    load_scene,
    name_of,
    result_files,
    told_as,
)
from validate.comparison.examined import Examined
from validate.errors import UsageError
from validate.exit_status import ExitStatus
from validate.measured.comparing import DataOutcome, compare_results
from validate.measured.mapping import FARTHEST, map_to_fill_in, read_results
from validate.measured.tolerances import OURS
from validate.output import report
from validate.output.console import Console
from validate.output.document import Head, Journal
from validate.plain_text import shown

# What is not done for files, and why.
NO_BASELINE = (
    "is about what is solved at a scene's own times, and a file brings rows of its own; leave it out with "
    "--data: without --data it is kept of SCENE, and what two files say is in their --json"
)
OF_SCENES = dict.fromkeys(
    ("--scenes-dir", "--fail-fast", "--solver", "--traceback", "--solver-timeout", "--in-process"),
    "is about scenes that are solved; leave it out with --data",
) | dict.fromkeys(("--save-baseline", "--baseline"), NO_BASELINE)


def run(options: argparse.Namespace, console: Console, page: Page | None, brief: bool = False) -> ExitStatus:
    """Compare a file with a scene's car.

    Args:
        page: is made of the run, if there is one.
        brief: whether nothing is said but the verdict in a sentence, and where the page is.
    Raises:
        UsageError: the options do not go together.
        FileError: the file, or the map of its columns, is wrong.
        SceneError: the scene is wrong; PointcoordError: it cannot be solved.
        MissingPackage: Parquet needs pyarrow, a page its own packages.
        OutputError: the results or the page cannot be written.
    """
    _require(options)
    (given,) = options.scenes
    files = tuple(file for file in (options.data, options.map) if file is not None)
    targets = result_files(options, (given, *files), console)
    if options.map is not None and not os.path.exists(options.map):
        return to_be_filled_in(options.map, map_to_fill_in(options.data, load_scene(given)), console)
    mute, console.mute = console.mute, console.mute or brief
    targets.require_writable()
    if page is not None:
        page.require()
    head = Head.of("validate", options.command, options.timings)
    journal = Journal(options.json, head, console)
    name = name_of(given)
    record = Record([name], options.tolerance_factor)
    with (
        journal.closing(
            record.data, lambda: record.examined, lambda: f"{len(record.examined)} of 1 scenes"
        ) as ending,
        targets.closing(record, console),
    ):
        scene = load_scene(given)
        with told_as(name):
            measured = read_results(options.data, options.map, scene)
            found = compare_results(measured, scene, name, options.accuracy, options.tolerance_factor)
        examined = _examined(found, scene, name)
        record.files[name] = found
        record.add(examined, scene=scene)
        for warning in examined.warnings:
            console.warn(f"{name}: {warning}")
        console.show(report.file_parts(found))
        if step := next_step(record):
            console.say(step)
        ending.status = examined.status
        if page is not None:
            # Most files make no page.
            from validate.html.run import Run

            whole = page.write(Run(head, record), console)
            ending.status = whole.status
            if brief:
                console.mute = mute
                console.say(f"{whole.sentence}\n{page.place}")
    return ending.status


def _require(options: argparse.Namespace) -> None:
    if options.first is not None or options.second is not None:
        raise UsageError("--data is compared with pointcoord; leave --first and --second out")
    for option, why in OF_SCENES.items():
        value = getattr(options, option.strip("-").replace("-", "_"))
        if value not in (None, False):
            raise UsageError(f"{option} {why}")
    if len(options.scenes) != 1:
        given = f"{len(options.scenes)} scenes are" if options.scenes else "no scene is"
        raise UsageError(f"{given} given with --data; give the one scene that the file is about")
    if STANDARD_INPUT in (options.data, options.map):
        raise UsageError("--data and --map read files; standard input (-) can be the scene only")
    accuracy = options.accuracy
    if accuracy is not None and not 0.0 <= accuracy <= FARTHEST:
        raise UsageError(f"--accuracy is {accuracy}; allowed: a number from 0 to {FARTHEST:g}")


def _examined(found: DataOutcome, scene: Scene, name: str) -> Examined:
    moved = closing_of(scene)
    return Examined(
        name=name,
        title=shown(scene.title),
        outcomes=(found.outcome,),
        solved=(OURS,),
        warnings=warnings_of(scene, moved),
        closing=closing_data(moved),
        defaults=scene.mechanism.defaults_taken,
    )
