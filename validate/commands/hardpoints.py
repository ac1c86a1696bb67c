"""`pointcoord import`: hardpoints from another program's file, written as a scene."""

from __future__ import annotations

import argparse
import os
from collections.abc import Iterator
from dataclasses import fields

from validate.closed_drawing import warnings_of
from validate.commands.pages import Command
from validate.commands.usage import TOML, place_of_result, to_be_filled_in
from validate.exit_status import ExitStatus
from validate.hardpoint_files.axes import DIRECTIONS
from validate.hardpoint_files.format import formats
from validate.hardpoint_files.importing import Imported, import_hardpoints, names_of
from validate.hardpoint_files.one_wheel import NAMED, PARTS, SIDES, Choices
from validate.output.console import Console
from validate.plain_text import shown, some_of
from validate.tables.units import LENGTHS


def run(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Write a scene from another program's file, and say what became of each of its points.

    Returns:
        DISAGREE if a static angle that the file prints is not that of its points; the scene is written.
    """
    target = place_of_result(options, TOML, console, read="file")
    if options.names is not None and not os.path.exists(options.names):
        text = names_of(options.file, options.format, options.suspension)
        return to_be_filled_in(options.names, text, console)
    said = {one.name: getattr(options, one.name) for one in fields(Choices)}
    found = import_hardpoints(options.file, **said)
    name = shown(options.file)
    told = warnings_of(found.scene, found.stands.closing)
    console.put(target, found.text, "the scene")
    console.say("\n".join(_report(name, found)))
    console.say(f"{shown(target)} is written; try: pointcoord validate {shown(target)}")
    for warning in told:
        console.warn(f"{name}: {warning}")
    if found.others:
        others = some_of([shown(point.source) for point in found.others], NAMED)
        console.note(f"{name}: no points of ours: {others}")
    wrong = [check for check in found.angles if check.verdict == "disagrees"]
    for check in wrong:
        console.complain(
            f"{name}: line {check.line}: {check.words} is printed as {check.printed:g} deg, but the points "
            f"give {check.drawn:.4f}; allowed: within {check.tolerance:.2g} deg, by the printed digits; are "
            "these the points, axes and side of this drawing?"
        )
    return ExitStatus.DISAGREE if wrong else ExitStatus.AGREE


def _report(name: str, found: Imported) -> Iterator[str]:
    """What the file is, and what became of each of its points and angles."""
    part = found.scene.mechanism
    width = max(len(point.name) for point in found.points)
    wide = max(len(point.written) for point in found.points)
    kind = f"a {part.type} of the {part.side} wheel" if part.type else "a mechanism of its own"
    yield f"{name}: {found.format.words}, read as {kind}"
    yield from (f"  {fact}" for fact in found.facts)
    for point in found.points:
        yield f"  {point.name.ljust(width)}  {point.written.ljust(wide)}  {shown(point.source)}"
    yield from (f"  no point of ours: {shown(point.source)}" for point in found.others)
    for check in found.angles:
        there = f"the file prints {check.printed:g} deg, its points give {check.drawn:z.4f}"
        yield f"  {check.name}: {there}: {check.verdict}"


WORDS = {
    "formats": "\n".join(f"  {one.name.ljust(8)}  {one.words}" for one in formats().values()),
    "sides": "|".join(SIDES),
    "parts": "|".join(PARTS),
    "directions": ", ".join(DIRECTIONS),
    "units": ", ".join(LENGTHS),
}
COMMANDS = {"import": Command(run, WORDS)}
