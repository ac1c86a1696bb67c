"""`pointcoord plot`: curves of a scene's motion, one number over another."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from pointcoord import Motion, NotComputed, PointcoordError, Scene, SceneError, simulate
from validate.commands.motion import comment, how_many
from validate.commands.usage import (
    add_output,
    add_quiet,
    add_scene,
    load_scene,
    name_of,
    place_of_result,
    told_as,
    write_result,
)
from validate.curves.numbers import TIME, TRAVEL, Curves, Number, found, numbers_of, usual
from validate.errors import UsageError
from validate.exit_status import ExitStatus
from validate.extras import needed
from validate.output.console import Console
from validate.output.progress import progress

ENDINGS = (".svg", ".png")
# A curve of fewer instants has corners.
SMOOTH = 401

DESCRIPTION = f"""\
Draw curves of a scene's motion: any number that it gives over any other. Without --x and --y
the wheel's angles are drawn against its travel, which goes upward on the paper; against the
one input that moves, or time, where the wheel does not go mostly up and down; and the wheel
centre's place over time where the scene asks for no angle.

A number is named by as many words of QUANTITY.NAME.COMPONENT as tell it apart: an angle or
an input by its name, a place as POINT.z, another quantity of a point as QUANTITY.POINT.z; all
three components are drawn if none is said. {TIME} is the time, {TRAVEL} how far the wheel centre is
above its drawn place, measured on the chassis. What is positive is said at each axis."""


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command with its options."""
    parser = commands.add_parser(
        "plot", help="draw curves of a scene's motion (SVG, PNG)", description=DESCRIPTION
    )
    add_scene(parser)
    add_output(
        parser,
        "FILE",
        f"where to, by its ending {' or '.join(ENDINGS)}; SVG on standard output if not given, or for -",
    )
    parser.add_argument(
        "--y", metavar="NUMBER", action="append", help="what goes upward on the paper; may be given again"
    )
    parser.add_argument(
        "--x",
        metavar="NUMBER",
        action="append",
        help=f"what goes to the right ({TIME} if only --y is given); may be given again if --y is not, whose "
        f"place {TRAVEL} takes",
    )
    parser.add_argument(
        "--degrees",
        action=argparse.BooleanOptionalAction,
        default=True,
        help="angles in degrees, as they are if nothing is said, or in radians",
    )
    parser.add_argument(
        "--instants",
        metavar="N",
        type=how_many,
        help=f"points of a curve, evenly over the time; the scene's own if not given, at least {SMOOTH}",
    )
    add_quiet(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Solve the scene and draw it, or the part of it that could be solved.

    Raises:
        UsageError: a number or a file is not named as it must be.
        NotComputed: the scene does not ask for a number.
        MissingPackage: pictures need matplotlib.
        SceneError: the scene is wrong.
        OutputError: the picture cannot be written.
    """
    console.quiet = options.quiet
    target = place_of_result(options, ENDINGS, console)
    needed("plot", "matplotlib", "plot")
    scene, name = load_scene(options.scene), name_of(options.scene)
    numbers = numbers_of(scene)
    chosen = _chosen(options, numbers, name)
    problem: PointcoordError | None = None
    try:
        with told_as(name), progress(console, f"solving {name}", total=None, lines=False):
            motion = simulate(scene)
    except SceneError:
        raise
    except PointcoordError as error:
        if error.partial is None:
            console.complain(f"{name}: {error}; nothing is drawn")
            return ExitStatus.NO_VERDICT
        motion, problem = error.partial, error
    comment(scene, name, motion, console)
    _draw(target, options, scene, motion, chosen or usual(scene, numbers, motion), console)
    if problem is not None:
        where = "the picture" if target is None else target
        console.complain(f"{name}: {problem}; {where} goes up to t = {motion.times[-1]:.10g} s")
        return ExitStatus.NO_VERDICT
    return ExitStatus.AGREE


def _chosen(options: argparse.Namespace, numbers: Sequence[Number], name: str) -> Curves | None:
    """What the command line asks for; None if it leaves that open."""
    if options.x is None and options.y is None:
        return None
    if len(options.x or ()) > 1 and len(options.y or ()) > 1:
        raise UsageError("--x and --y are both given more than once; allowed: several of one of them")
    across = _named(options.x or [TIME], "--x", numbers, name)
    up = _named(options.y or [TRAVEL], "--y", numbers, name)
    if len(across) > 1 and len(up) > 1:
        raise UsageError(
            f"--x {' --x '.join(options.x)} are {len(across)} numbers, and --y {len(up)}; "
            "allowed: several of one of them; say which component, x, y or z"
        )
    return Curves(across, up)


def _named(words: Sequence[str], option: str, numbers: Sequence[Number], name: str) -> tuple[Number, ...]:
    try:
        named = [number for one in words for number in found(one, numbers)]
    except UsageError as error:
        raise UsageError(f"{name}: {option} {error}") from None
    except NotComputed as error:
        raise UsageError(f"{name}: {option}: {error}") from None
    return tuple({number.path: number for number in named}.values())


def _draw(
    target: str | None,
    options: argparse.Namespace,
    scene: Scene,
    motion: Motion,
    curves: Curves,
    console: Console,
) -> None:
    # Imported here: matplotlib takes a second.
    from validate.curves.picture import figure
    from validate.output.figure import drawn

    count = options.instants or max(len(motion.times), SMOOTH)
    own = options.instants is None and count == len(motion.times)
    samples = motion if own or len(motion.times) == 1 else next(motion.blocks(count, count))
    title = scene.title or name_of(options.scene)
    ending = ".svg" if target is None else Path(target).suffix
    content = drawn(figure(curves, motion, samples, title, options.degrees), ending.removeprefix("."))
    write_result(target, content, "the picture", console)
