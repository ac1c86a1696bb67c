"""`pointcoord draw`: a picture of a scene's drawing, to see what its numbers say."""

from __future__ import annotations

import argparse

from validate.closed_drawing import closed_drawing, warnings_of
from validate.commands.usage import (
    add_output,
    add_scene,
    load_scene,
    name_of,
    place_of_result,
    told_as,
    write_result,
)
from validate.exit_status import ExitStatus
from validate.output.console import Console
from validate.output.picture import svg

ENDINGS = (".svg",)

DESCRIPTION = """\
Draw a scene's hardpoints from behind, from the left and from above, so that a wrong sign,
axis or side is seen before anything is solved. Where the drawing does not close, it is drawn
a second time as it is solved."""


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command with its options."""
    parser = commands.add_parser(
        "draw",
        help="make a picture of a scene's hardpoints (SVG)",
        description=DESCRIPTION,
    )
    add_scene(parser)
    add_output(parser, "FILE.svg", "where to; standard output if not given, or for -")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Draw a scene's hardpoints.

    Raises:
        UsageError: the file has no name, or another ending than .svg.
        SceneError: the scene is wrong.
        OutputError: the picture cannot be written.
    """
    target = place_of_result(options, ENDINGS, console)
    scene, name = load_scene(options.scene), name_of(options.scene)
    with told_as(name):
        drawing = closed_drawing(scene)
    picture = svg(drawing)
    for warning in warnings_of(scene, drawing.closing):
        console.warn(f"{name}: {warning}")
    write_result(target, picture, "the picture", console)
    return ExitStatus.AGREE
