"""`pointcoord report`: scenes validated, and what came of it as a page with its data."""

from __future__ import annotations

import argparse

from pointcoord import Motion, PointcoordError, Scene, SceneError, simulate
from validate.commands.comparison import FIRST, FURTHER, SECOND
from validate.commands.usage import SCENE_HELP, STANDARD_INPUT, UsageError, add_quiet, load_scene, name_of
from validate.comparison.examined import Examined, examine
from validate.diagnosis import explain_outcome
from validate.exit_status import ExitStatus
from validate.formulations.registry import formulation
from validate.html.folder import NotOurs, require_folder, write_report
from validate.html.page import require_templates
from validate.html.run import Run, Told
from validate.output.console import Console
from validate.output.document import Head
from validate.paper.scenes import DEFAULT_SCENES, PAPER_SCENES
from validate.paper.tables import compare_with_paper

DESCRIPTION = """\
Compare scenes as `pointcoord validate` does, and write a report of it into a folder: index.html,
one page that needs no network and opens from disk, with results.json, which is what validate
--json writes, and comparisons.csv, a line for each number that was compared."""


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command with its options."""
    parser = commands.add_parser(
        "report", help="validate scenes and write a page of HTML about it", description=DESCRIPTION
    )
    parser.add_argument("folder", metavar="DIR", help="the report's folder, made if it is not there")
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=f"{SCENE_HELP}; none: all built-in scenes")
    add_quiet(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Compare the scenes and write the report.

    Raises:
        UsageError: the folder has no name or cannot be a report's, or standard input is a scene twice.
        MissingPackage: a page needs the extra `report`, a formulation its own packages.
        OutputError: the report cannot be written.
    """
    console.quiet = options.quiet
    names = options.scenes or list(DEFAULT_SCENES)
    if not options.folder.strip():
        raise UsageError(f"{options.folder!r} names no folder; give the path of one, which is made if needed")
    if names.count(STANDARD_INPUT) > 1:
        raise UsageError("standard input (-) is given as a scene more than once; it can be read once")
    require_templates()
    for name in dict.fromkeys((FIRST, SECOND, *FURTHER)):
        formulation(name)  # found before any scene is read
    try:
        require_folder(options.folder)
    except NotOurs as error:
        raise UsageError(str(error)) from None
    head = Head.of("validate", options.command)
    told = []
    with console.working("scenes", len(names)) as at:
        for place, name in enumerate(names):
            at(name_of(name), place)
            one = _told(name)
            if one.examined.complaint:
                console.complain(one.examined.complaint)
            told.append(one)
    paper = () if options.scenes else compare_with_paper()
    whole = Run(head, tuple(told), paper=paper)
    page = write_report(options.folder, whole)[-1]
    console.written = [f"{page} holds the report"]
    console.say(f"{whole.sentence}\n{page}")
    return whole.status


def _told(name: str) -> Told:
    try:
        scene: Scene = load_scene(name)
    except SceneError as error:
        return Told(Examined(name=name_of(name), problem=str(error)), None)
    examined = examine(name, scene, ((FIRST, SECOND), FURTHER), name in PAPER_SCENES)
    explained = tuple(explain_outcome(scene, outcome) for outcome in examined.outcomes)
    return Told(examined, scene, _motion(scene), explained)


def _motion(scene: Scene) -> Motion | None:
    try:
        return simulate(scene)
    except PointcoordError as error:
        # Why it is refused is told already.
        partial = error.partial
        return partial if isinstance(partial, Motion) else None
