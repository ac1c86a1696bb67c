"""`pointcoord draw`: a picture of a scene's drawing, to see what its numbers say."""

from __future__ import annotations

import argparse
from typing import BinaryIO

from pointcoord import SceneError
from validate.commands.usage import (
    SCENE_HELP,
    STANDARD_INPUT,
    STANDARD_INPUT_NAME,
    load_scene,
    require_target,
)
from validate.exit_status import ExitStatus
from validate.output.closing import closing_of, warnings_of
from validate.output.console import Console, shown
from validate.output.files import require_known_ending, require_writable, write_whole
from validate.output.picture import svg


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command with its options."""
    parser = commands.add_parser("draw", help="draw a scene's hardpoints, as drawn and as closed (SVG)")
    parser.add_argument("scene", metavar="SCENE", help=SCENE_HELP)
    parser.add_argument("-o", "--output", metavar="FILE.svg", help="none, or -: standard output")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Draw a scene's hardpoints.

    Raises:
        UsageError, UnknownEnding: the file has no name, or another ending than .svg.
        SceneError: the scene is wrong.
        OutputError: the picture cannot be written.
    """
    target: str | None = None if options.output == "-" else options.output
    require_target(target, "-o", (options.scene,))
    if target is None:
        console.require("use -o FILE")
    else:
        require_known_ending(target, (".svg",))
        require_writable(target)
    scene = load_scene(options.scene)
    name = STANDARD_INPUT_NAME if options.scene == STANDARD_INPUT else shown(options.scene)
    try:
        picture = svg(scene)
    except SceneError as error:
        raise SceneError(name, error.key, error.problem, error.allowed) from error
    for warning in (*warnings_of(closing_of(scene)), *scene.mechanism.doubts):
        console.warn(f"{name}: {warning}")
    if target is None:
        console.write(picture)
        console.flush()
    else:
        write_whole(target, lambda stream: _put(stream, picture))
        console.written = [f"{target} holds the picture"]
    return ExitStatus.AGREE


def _put(stream: BinaryIO, picture: str) -> None:
    stream.write(picture.encode())
