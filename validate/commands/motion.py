"""`pointcoord simulate`: a scene solved by point coordinates alone."""

from __future__ import annotations

import argparse

from pointcoord import (
    Motion,
    MotionTooLong,
    MotionTooRough,
    PointcoordError,
    SceneError,
    simulate,
)
from pointcoord.effects.registry import EFFECTS
from pointcoord.method import METHODS, Method
from validate.commands.usage import (
    SCENE_HELP,
    STANDARD_INPUT,
    STANDARD_INPUT_NAME,
    load_scene,
    require_target,
)
from validate.exit_status import ExitStatus
from validate.output.closing import warnings_of
from validate.output.console import STANDARD_OUTPUT, Console, shown
from validate.output.files import require_known_ending, require_writable
from validate.output.motion_tables import ENDINGS, write_csv, write_motion
from validate.paper.printed import PRINTED

BY_NAME: dict[str, Method] = {method.name: method for method in (*METHODS.values(), PRINTED)}


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command with its options."""
    parser = commands.add_parser("simulate", help="solve a scene by point coordinates only")
    parser.add_argument("scene", metavar="SCENE", help=SCENE_HELP)
    parser.add_argument(
        "-o", "--output", metavar="FILE", help=f"{' or '.join(ENDINGS)}; none, or -: CSV on standard output"
    )
    parser.add_argument(
        "--method",
        choices=tuple(BY_NAME),
        default="series",
        help="a chain of power series; Newton's method at every instant; or that with the paper's formulas "
        "as printed, which are wrong in places",
    )
    parser.add_argument("-q", "--quiet", action="store_true", help="say nothing but errors")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Solve the scene and write its motion, or the part of it that could be solved.

    Raises:
        UsageError, UnknownEnding: the file has no name, or none that says how to write it.
        SceneError: the scene is wrong.
        OutputError: the motion cannot be written.
    """
    target: str | None = None if options.output == "-" else options.output
    console.quiet = options.quiet
    require_target(target, "-o", (options.scene,))
    if target is None:
        console.require("use -o FILE")
    else:
        require_known_ending(target, ENDINGS)
        require_writable(target)
    scene = load_scene(options.scene)
    name = STANDARD_INPUT_NAME if options.scene == STANDARD_INPUT else shown(options.scene)
    try:
        motion = simulate(scene, BY_NAME[options.method])
        for warning in (*warnings_of(motion.closing), *scene.mechanism.doubts):
            console.warn(f"{name}: {warning}")
        said = {*warnings_of(motion.closing), *scene.mechanism.doubts}
        for note in motion.notes:
            if note not in said:
                console.note(f"{name}: {note}")
        if motion.closing.moves and not motion.closing.noticeable:
            console.note(f"{name}: {motion.closing.words}")
        if any("wheel_axis" in EFFECTS[effect].lines for effect in scene.effects):
            for taken in scene.mechanism.defaults_taken:
                console.note(f"{name}: {taken}")
        _write(target, motion, console)
    except SceneError as error:
        raise SceneError(name, error.key, error.problem, error.allowed) from error
    except PointcoordError as error:
        console.complain(f"{name}: {error}{_advice(error)}{_kept(target, error, console)}")
        return ExitStatus.NO_VERDICT
    return ExitStatus.AGREE


def _advice(error: PointcoordError) -> str:
    return " (--method newton)" if isinstance(error, MotionTooLong | MotionTooRough) else ""


def _kept(target: str | None, error: PointcoordError, console: Console) -> str:
    """Write what was solved before the motion stopped, and say where it is and how far it goes."""
    partial: Motion | None = error.partial
    if partial is None:
        return "; nothing is written"
    _write(target, partial, console)
    instants = f"{len(partial.times)} instants" if len(partial.times) > 1 else "one instant"
    moved = "".join(f"; {warning}" for warning in warnings_of(partial.closing))
    return (
        f"{moved}; what was solved, {instants} up to t = {partial.times[-1]:.10g} s, is "
        f"{f'on {STANDARD_OUTPUT}' if target is None else f'in {target}'}"
    )


def _write(target: str | None, motion: Motion, console: Console) -> None:
    if target is None:
        write_csv(console, motion)
        console.flush()
    else:
        write_motion(target, motion)
        console.written = [f"{target} holds the motion"]
