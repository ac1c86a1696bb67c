"""`pointcoord export`: writes a car as another program's model."""

from __future__ import annotations

import argparse

from validate.closed_drawing import closed_drawing, closed_mechanism, warnings_of
from validate.commands.pages import Command
from validate.commands.usage import named_scene
from validate.exit_status import ExitStatus
from validate.extras import needed
from validate.output.console import Console
from validate.plain_text import shown, typed


def run(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Write the model.

    Returns:
        NO_VERDICT if the drawing cannot be closed, since the model then has no home pose.
    """
    needed("export", "mujoco")
    from validate.peers.mjcf import mjcf_of

    with named_scene(options.scene) as (scene, name):
        drawing = closed_drawing(scene)
    if not drawing.places:
        console.complain(f"{name}: {drawing.words}; nothing is written")
        return ExitStatus.NO_VERDICT
    console.warn(*warnings_of(scene, drawing.closing), of=name)
    console.put(options.mjcf, mjcf_of(closed_mechanism(drawing), scene.title or name), "the model")
    console.say(
        f"{shown(options.mjcf)} is written; try: python -m mujoco.viewer --mjcf={typed(options.mjcf)}"
    )
    return ExitStatus.AGREE


COMMANDS = {"export": Command(run)}
