"""`pointcoord simulate`: a scene solved by point coordinates alone."""

from __future__ import annotations

import argparse

from pointcoord import Motion, MotionTooLong, MotionTooRough, PointcoordError, Scene, SceneError, simulate
from pointcoord.effects.registry import EFFECTS
from pointcoord.method import METHODS, Method
from validate.closed_drawing import warnings_of
from validate.commands.usage import (
    add_output,
    add_quiet,
    add_scene,
    load_scene,
    name_of,
    place_of_result,
    told_as,
)
from validate.errors import UsageError
from validate.exit_status import ExitStatus
from validate.output.console import STANDARD_OUTPUT, Console
from validate.output.motion_tables import ENDINGS, require_writer, write_csv, write_motion
from validate.output.progress import progress
from validate.paper.printed import PRINTED
from validate.plain_text import shown

BY_NAME: dict[str, Method] = {method.name: method for method in (*METHODS.values(), PRINTED)}

DESCRIPTION = """\
Solve a scene by point coordinates alone and write what it asks for: a row for each instant, a
column for each number with its unit. A motion that stops halfway is written as far as it
goes."""


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command with its options."""
    parser = commands.add_parser(
        "simulate",
        help="solve a scene by point coordinates and write its motion",
        description=DESCRIPTION,
    )
    add_scene(parser)
    add_output(
        parser,
        "FILE",
        f"where to, by its ending {' or '.join(ENDINGS)}; CSV on standard output if not given, or for -",
    )
    parser.add_argument(
        "--instants",
        metavar="N",
        type=how_many,
        help="as many rows as this, evenly over the scene's time, instead of the scene's own samples; any "
        "number of them takes no more memory",
    )
    parser.add_argument(
        "--method",
        choices=tuple(BY_NAME),
        default="auto",
        help="auto (if not given): series, or a map where these are too long or too rough; series: a chain "
        "of power series in time; map: series in the inputs, on patches that cover their way; newton: "
        "Newton's method at each instant; printed: that with the paper's formulas as printed, some of which "
        "are wrong",
    )
    add_quiet(parser)
    parser.set_defaults(run=run)


def how_many(text: str) -> int:
    """A number of instants as a command line has it.

    Raises:
        ArgumentTypeError: it is none.
    """
    if not (text.isascii() and text.isdigit() and int(text) > 0):
        raise argparse.ArgumentTypeError(f"{shown(text)} is no number of instants; allowed: 1 or more")
    return int(text)


def run(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Solve the scene and write its motion, or the part of it that could be solved.

    Raises:
        UsageError: the file has no name, or none that says how to write it.
        MissingPackage: Parquet needs pyarrow.
        SceneError: the scene is wrong.
        OutputError: the motion cannot be written.
    """
    console.quiet = options.quiet
    target = place_of_result(options, ENDINGS, console)
    if target is not None:
        require_writer(target)
    if options.instants is not None and not BY_NAME[options.method].dense:
        raise UsageError(
            f"--instants needs the method auto, series or map; {options.method} solves at the scene's own "
            "samples only"
        )
    scene, name = load_scene(options.scene), name_of(options.scene)
    try:
        with told_as(name), progress(console, f"solving {name}", total=None, lines=False):
            motion = simulate(scene, BY_NAME[options.method])
        comment(scene, name, motion, console)
        _write(target, motion, options.instants, console)
    except SceneError:
        raise
    except PointcoordError as error:
        console.complain(f"{name}: {error}{_advice(error)}{_kept(target, error, options.instants, console)}")
        return ExitStatus.NO_VERDICT
    return ExitStatus.AGREE


def comment(scene: Scene, name: str, motion: Motion, console: Console) -> None:
    """Warn of what looks wrong with the drawing, and note what was taken for granted."""
    warnings = warnings_of(scene, motion.closing)
    for warning in warnings:
        console.warn(f"{name}: {warning}")
    notes = [note for note in motion.notes if note not in warnings]
    if motion.closing.moves and not motion.closing.noticeable:
        notes.append(motion.closing.words)
    if any("wheel_axis" in EFFECTS[effect].lines for effect in scene.effects):
        notes += scene.mechanism.defaults_taken
    for note in notes:
        console.note(f"{name}: {note}")


def _advice(error: PointcoordError) -> str:
    return " (--method newton)" if isinstance(error, MotionTooLong | MotionTooRough) else ""


def _kept(target: str | None, error: PointcoordError, instants: int | None, console: Console) -> str:
    """Write what was solved before the motion stopped, and say where it is and how far it goes."""
    partial: Motion | None = error.partial
    if partial is None:
        return "; nothing is written"
    _write(target, partial, instants, console)
    count = instants or len(partial.times)
    rows = f"{count} instants" if count > 1 else "one instant"
    moved = f"; {partial.closing.words}" if partial.closing.noticeable else ""
    return (
        f"{moved}; what was solved, {rows} up to t = {partial.times[-1]:.10g} s, is "
        f"{f'on {STANDARD_OUTPUT}' if target is None else f'in {target}'}"
    )


def _write(target: str | None, motion: Motion, instants: int | None, console: Console) -> None:
    if target is None:
        write_csv(console, motion, instants)
        console.flush()
    else:
        write_motion(target, motion, instants)
        console.written = [f"{target} holds the motion"]
