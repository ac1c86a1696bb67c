"""`pointcoord simulate` and `plot`: solve a scene by point coordinates, and write or draw its numbers."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path

from pointcoord import Motion, NotFollowed, PointcoordError, Scene, SceneError, simulate
from pointcoord.effects.car_number import WHEEL
from pointcoord.effects.registry import EFFECTS
from pointcoord.method import METHODS, Method
from validate.closed_drawing import warnings_of
from validate.commands.pages import Command
from validate.commands.usage import name_of, named_scene, place_of_picture
from validate.curves.numbers import (
    TIME,
    TRAVEL,
    Curves,
    angles_of,
    asking_for,
    numbers_chosen,
    usual,
)
from validate.errors import UsageError
from validate.exit_status import ExitStatus
from validate.extras import needed
from validate.output.columns import ENDINGS, GROUP, put_table, rows_of_motion
from validate.output.console import STANDARD_OUTPUT, Console
from validate.paper.printed import PRINTED
from validate.plain_text import counted_as

BY_NAME: dict[str, Method] = {method.name: method for method in (*METHODS.values(), PRINTED)}
SMOOTH = 401  # a curve of fewer instants has corners


def run_simulate(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Solve a scene and write its motion."""
    target, method, instants = options.output, BY_NAME[options.method], options.instants
    if instants is not None and not method.dense:
        raise UsageError(
            f"--instants needs the method auto, series or map; {options.method} solves at the scene's own "
            "samples only"
        )

    def write(motion: Motion) -> str:
        put_table(target, rows_of_motion(motion, instants), "the motion", console, GROUP)
        return counted_as(instants or len(motion.times), "instant")

    with named_scene(options.scene) as (scene, name):
        return solved(scene, name, target, console, write, method)


def run_plot(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Draw curves of a scene's motion, or of a file."""
    target = place_of_picture(options, console)
    needed("plot", "matplotlib")
    # Imported here: matplotlib takes a second.
    from validate.curves.picture import figure
    from validate.output.figure import drawn

    if Path(options.scene).suffix in ENDINGS:
        return _plot_sweep(options, target, console)
    with named_scene(options.scene) as (scene, name):
        angles = numbers_chosen([one.path[1] for one in angles_of(scene)], scene, name)
        chosen = _curves(options, scene, name)
        scene = asking_for(scene, (*chosen.across, *chosen.up) if chosen else angles)

        def write(motion: Motion) -> str:
            count = options.instants or max(len(motion.times), SMOOTH)
            own = options.instants is None and count == len(motion.times)
            samples = motion if own or len(motion.times) == 1 else next(motion.blocks(count, count))
            curves = chosen or usual(scene, motion, angles)
            picture = figure(curves, lambda n: n.shown(motion, samples), scene.title or name)
            console.put(target, drawn(picture, target), "the picture")
            return "the picture"

        return solved(scene, name, target, console, write)


def _plot_sweep(options: argparse.Namespace, target: str, console: Console) -> ExitStatus:
    """Draw columns of a file that sweep or simulate wrote, a curve for each design."""
    # Imported here: matplotlib and pandas take a second each.
    from validate.curves.of_sweep import columns_called, read_sweep
    from validate.curves.picture import figure_of
    from validate.output.figure import drawn

    if options.instants is not None:
        raise UsageError("--instants goes with a scene only; the rows of a file are fixed; leave it out")
    table = read_sweep(options.scene)
    across, up = (
        columns_called(table, words) for words in (options.x or (TIME,), options.y or (WHEEL.name,))
    )
    picture = figure_of(table, across[0], up, name_of(options.scene))
    console.put(target, drawn(picture, target), "the picture")
    return ExitStatus.AGREE


def solved(
    scene: Scene,
    name: str,
    target: str,
    console: Console,
    write: Callable[[Motion], str],
    method: Method = BY_NAME["auto"],
) -> ExitStatus:
    """Solve a scene, and write its motion or the part of it that could be solved.

    Args:
        name: name of the scene in messages.
        write: writes a motion; returns what was written, in words.
    Raises:
        SceneError: the scene is wrong. NotFinished: the result cannot be written.
    """
    problem: PointcoordError | None = None
    try:
        with console.progress(f"solving {name}", lines=False):
            motion = simulate(scene, method)
    except SceneError:
        raise
    except PointcoordError as error:
        advice = " (--method newton)" if isinstance(error, NotFollowed) else ""
        if error.partial is None:
            console.complain(f"{name}: {error}{advice}; nothing is written")
            return ExitStatus.NO_VERDICT
        motion, problem = error.partial, error
    _comment(scene, name, motion, console)
    what = write(motion)
    if problem is None:
        return ExitStatus.AGREE
    where = f"on {STANDARD_OUTPUT}" if target == "-" else f"in {target}"
    console.complain(
        f"{name}: {problem}{advice}; the solved part, {what} up to t = {motion.times[-1]:.10g} s, is {where}"
    )
    return ExitStatus.NO_VERDICT


def _comment(scene: Scene, name: str, motion: Motion, console: Console) -> None:
    """Print warnings about the drawing, and notes on defaults that were used."""
    warnings = warnings_of(scene, motion.closing)
    console.warn(*warnings, of=name)
    notes = [note for note in motion.notes if note not in warnings]
    if motion.closing.moves and not motion.closing.noticeable:
        notes.append(motion.closing.words)
    if any("wheel_axis" in EFFECTS[effect].lines for effect in scene.effects):
        notes += scene.mechanism.defaults_taken
    console.note(*notes, of=name)


def _curves(options: argparse.Namespace, scene: Scene, name: str) -> Curves | None:
    """The curves of --x and --y; None if neither is given."""
    if not options.x and not options.y:
        return None
    asked = (("--x", options.x or (TIME,)), ("--y", options.y or (TRAVEL,)))
    across, up = (numbers_chosen(words, scene, f"{name}: {option}") for option, words in asked)
    if len(across) > 1 and len(up) > 1:
        raise UsageError(
            f"--x names {len(across)} numbers and --y {len(up)}; allowed: several for one of the two options "
            "only; name one component, x, y or z"
        )
    return Curves(across, up)


COMMANDS = {
    "simulate": Command(run_simulate, more={"--method": {"choices": tuple(BY_NAME), "metavar": None}}),
    "plot": Command(run_plot, {"smooth": SMOOTH}),
}
