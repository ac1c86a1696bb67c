"""`pointcoord import` and `export`: hardpoints of other programs as a scene, and a car as a MuJoCo model."""

from __future__ import annotations

import argparse
import os
from collections.abc import Iterator
from dataclasses import fields

from validate.closed_drawing import closed_drawing, closed_mechanism, warnings_of
from validate.commands.pages import Command
from validate.commands.usage import named_scene, to_be_filled_in
from validate.exit_status import ExitStatus
from validate.extras import needed
from validate.hardpoint_files.contents import DIRECTIONS
from validate.hardpoint_files.format import formats
from validate.hardpoint_files.identified import PARTS, SIDES, Choices
from validate.hardpoint_files.importing import Imported, import_hardpoints, names_of
from validate.hardpoint_files.one_wheel import NAMED
from validate.output.console import Console
from validate.plain_text import shown, some_of, typed
from validate.tables.units import LENGTHS


def run_import(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Write a scene from another program's file, and list what each of its points was read as.

    Returns:
        DISAGREE if a static angle printed in the file differs from the angle of its points. The scene is
        written in this case too.
    """
    if options.names is not None and not os.path.exists(options.names):
        text = names_of(options.file, options.format, options.suspension)
        return to_be_filled_in(options.names, text, console)
    choices = {one.name: getattr(options, one.name) for one in fields(Choices)}
    found = import_hardpoints(options.file, **choices)
    name, target = shown(options.file), options.output
    console.put(target, found.text, "the scene")
    console.say("\n".join(_report(name, found)))
    console.say(f"{shown(target)} is written; try: pointcoord validate {typed(target)}")
    console.warn(*warnings_of(found.scene, found.stands.closing), of=name)
    if found.drawing.others:
        others = some_of([*map(shown, found.drawing.others)], NAMED)
        console.note(f"points not recognised: {others}", of=name)
    wrong = [check for check in found.angles if check.verdict == "disagrees"]
    for check in wrong:
        console.complain(
            f"{name}: line {check.line}: {check.words} is printed as {check.printed:g} deg, but its points "
            f"give {check.drawn:.4f} deg; allowed: a difference of {check.tolerance:.2g} deg, by its digits; "
            "check the points, the axes and the side"
        )
    return ExitStatus.DISAGREE if wrong else ExitStatus.AGREE


def _report(name: str, found: Imported) -> Iterator[str]:
    """The lines of the report: the format of the file, its points and its angles."""
    part, points = found.scene.mechanism, found.drawing.points
    width, wide = (max(map(len, texts)) for texts in zip(*((p.name, p.written) for p in points), strict=True))
    kind = f"a {part.type} of the {part.side} wheel" if part.type else "a new mechanism"
    yield f"{name}: {found.format.words}, read as {kind}"
    yield from (f"  {fact}" for fact in found.drawing.facts)
    yield from (f"  {p.name.ljust(width)}  {p.written.ljust(wide)}  {shown(p.source)}" for p in points)
    yield from (f"  point not recognised: {shown(source)}" for source in found.drawing.others)
    for check in found.angles:
        there = f"the file prints {check.printed:g} deg, its points give {check.drawn:z.4f}"
        yield f"  {check.name}: {there}: {check.verdict}"


def run_export(options: argparse.Namespace, console: Console) -> ExitStatus:
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
    target = options.mjcf
    console.put(target, mjcf_of(closed_mechanism(drawing), scene.title or name), "the model")
    console.say(f"{shown(target)} is written; try: python -m mujoco.viewer --mjcf={typed(target)}")
    return ExitStatus.AGREE


WORDS = {
    "formats": "\n".join(f"  {one.name.ljust(8)}  {one.words}" for one in formats().values()),
    "sides": "|".join(SIDES),
    "parts": "|".join(PARTS),
    "directions": ", ".join(DIRECTIONS),
    "units": ", ".join(LENGTHS),
}
COMMANDS = {"import": Command(run_import, WORDS), "export": Command(run_export)}
