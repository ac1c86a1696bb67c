"""`pointcoord validate --data`: a file of results held to the car of a scene."""

from __future__ import annotations

import argparse
import math
from typing import Any

from pointcoord import Scene
from validate.ci.record import Record
from validate.closed_drawing import closing_data, closing_of, warnings_of
from validate.commands.reporting import Page
from validate.commands.usage import (
    STANDARD_INPUT,
    UsageError,
    load_scene,
    name_of,
    result_files,
    told_as,
)
from validate.comparison.examined import Examined
from validate.exit_status import ExitStatus
from validate.measured.comparing import OURS, DataOutcome, compare_results
from validate.measured.mapping import read_results
from validate.output import results_text
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
        ResultsError: the file, or the map of its columns, is wrong.
        SceneError: the scene is wrong; PointcoordError: it cannot be solved.
        MissingPackage: Parquet needs pyarrow, a page its own packages.
        OutputError: the results or the page cannot be written.
    """
    _require(options)
    (given,) = options.scenes
    files = tuple(file for file in (options.data, options.map) if file is not None)
    targets = result_files(options, (given, *files), console)
    mute, console.mute = console.mute, console.mute or brief
    targets.require_writable()
    if page is not None:
        page.require()
    head = Head.of("validate", options.command, options.timings)
    journal = Journal(options.json, head, console)
    done: list[dict[str, Any]] = []
    results = {
        "scenes": done,
        "printed_formulas": [],
        "printed_tables": None,
        "tolerance_factor": options.tolerance_factor,
        "not_run": [],
        "baseline": None,
    }
    name = name_of(given)
    record = Record([name], options.tolerance_factor)
    with (
        journal.closing(lambda: results, lambda: done, lambda: f"{len(done)} of 1 scenes") as ending,
        targets.closing(record, None, console),
    ):
        scene = load_scene(given)
        with told_as(name):
            measured = read_results(options.data, options.map, scene)
            found = compare_results(measured, scene, name, options.accuracy, options.tolerance_factor)
        examined = _examined(found, scene, name)
        record.add(examined, None)
        done.append(results_text.examined_data_of(examined, found))
        for warning in examined.warnings:
            console.warn(f"{name}: {warning}")
        console.say(results_text.text_of(found))
        ending.status = record.ended = examined.status
        if page is not None:
            telling = page.telling(1)
            telling.add_file(examined, scene, found)
            whole = page.write(telling.run(head, record, (), None), console)
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
    if accuracy is not None and not (math.isfinite(accuracy) and accuracy >= 0.0):
        raise UsageError(f"--accuracy is {accuracy}; allowed: a finite number from 0 up")


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
