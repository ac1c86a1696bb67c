"""`pointcoord simulate`, `plot` and `table`: solve a scene, and write its numbers, draw or tabulate them."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np

import pointcoord as pc
from pointcoord import Motion, Scene, WrongArgument, simulate
from pointcoord.effects.car_number import WHEEL
from pointcoord.effects.loads import LOADS
from pointcoord.effects.numbers import CONVENTIONS, READ_FIRST
from pointcoord.effects.registry import EFFECTS
from pointcoord.method import METHODS, Method
from pointcoord.wording import meant
from validate.arrays import Array
from validate.closed_drawing import warnings_of
from validate.commands.pages import Command
from validate.commands.usage import name_of, named_scene, place_of_picture, values_of
from validate.curves import numbers as named
from validate.curves.numbers import TIME, TRAVEL, Curves, Number, numbers_asked, numbers_of
from validate.errors import UsageError
from validate.exit_status import ExitStatus
from validate.extras import needed
from validate.formulations.asked_numbers import per_second
from validate.formulations.protocol import Accuracy, Solution
from validate.output.columns import ENDINGS, GROUP, put_table, rows_of_motion
from validate.output.console import STANDARD_OUTPUT, Console
from validate.output.table import Table, csv_of, text_for
from validate.paper.printed import PRINTED
from validate.plain_text import counted_as, shown

BY_NAME: dict[str, Method] = {method.name: method for method in (*METHODS.values(), PRINTED)}
SMOOTH = 401  # a curve of fewer instants has corners
ROWS = 21
FIGURES, DECIMALS = 5, (2, 6)  # significant digits of the largest number of a column, and limits of decimals
EXAMPLES = "INPUT=START:STOP:COUNT or INPUT=A,B,C, finite, in mm or rad as in a scene"


def solved(
    scene: Scene,
    name: str,
    target: str,
    console: Console,
    write: Callable[[Motion], str],
    method: Method = BY_NAME["auto"],
) -> ExitStatus:
    """Solve a scene, and write its motion or the part of it that could be solved.

    Warnings about the drawing, and notes on defaults that were used, are printed.

    Args:
        name: name of the scene in messages.
        write: writes a motion; returns what was written, in words.
    Raises:
        SceneError: the scene is wrong. NotFinished: the result cannot be written.
    """
    problem = ""
    try:
        with console.progress(f"solving {name}"):
            motion = simulate(scene, method)
    except pc.SceneError:
        raise
    except pc.PointcoordError as error:
        problem = f"{name}: {error}" + (" (--method newton)" if isinstance(error, pc.NotFollowed) else "")
        if error.partial is None:
            console.complain(f"{problem}; nothing is written")
            return ExitStatus.NO_VERDICT
        motion = error.partial
    warnings, closing = warnings_of(scene, motion.closing), motion.closing
    console.warn(*warnings, of=name)
    console.note(*(note for note in motion.notes if note not in warnings), of=name)
    if closing.moves and not closing.noticeable:
        console.note(closing.words, of=name)
    if any("wheel_axis" in EFFECTS[effect].lines for effect in scene.effects):
        console.note(*scene.mechanism.defaults_taken, of=name)
    what = write(motion)
    if not problem:
        return ExitStatus.AGREE
    where = f"on {STANDARD_OUTPUT}" if target == "-" else f"in {target}"
    console.complain(f"{problem}; the solved part, {what} up to t = {motion.times[-1]:.10g} s, is {where}")
    return ExitStatus.NO_VERDICT


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
    """Draw curves of a scene's motion, or of the columns of a file, with a curve for each design."""
    target = place_of_picture(options, console)
    needed("plot", "matplotlib")
    # Imported here: matplotlib and pandas take a second each.
    from validate.curves.picture import figure, figure_of
    from validate.output.figure import drawn

    if Path(options.scene).suffix in ENDINGS:
        from validate.curves.of_sweep import columns_called, read_sweep

        if options.instants is not None:
            raise UsageError("--instants goes with a scene only; the rows of a file are fixed; leave it out")
        table = read_sweep(options.scene)
        (across, *_), up = (
            columns_called(table, w) for w in (options.x or [TIME], options.y or [WHEEL.name])
        )
        picture = figure_of(table, across, up, name_of(options.scene))
        console.put(target, drawn(picture, target), "the picture")
        return ExitStatus.AGREE
    with named_scene(options.scene) as (scene, name):
        angles = named.numbers_chosen([one.path[1] for one in named.angles_of(scene)], scene, name)
        chosen = _curves(options, scene, name)
        scene = named.asking_for(scene, (*chosen.across, *chosen.up) if chosen else angles)

        def write(motion: Motion) -> str:
            count = options.instants or max(len(motion.times), SMOOTH)
            own = options.instants is None and count == len(motion.times)
            samples = motion if own or len(motion.times) == 1 else next(motion.blocks(count, count))
            curves = chosen or named.usual(scene, motion, angles)
            picture = figure(curves, lambda n: n.shown(motion, samples), scene.title or name)
            console.put(target, drawn(picture, target), "the picture")
            return "the picture"

        return solved(scene, name, target, console, write)


def _curves(options: argparse.Namespace, scene: Scene, name: str) -> Curves | None:
    """The curves of --x and --y; None if neither is given."""
    if not options.x and not options.y:
        return None
    asked = (("--x", options.x or (TIME,)), ("--y", options.y or (TRAVEL,)))
    across, up = (named.numbers_chosen(words, scene, f"{name}: {option}") for option, words in asked)
    if len(across) > 1 and len(up) > 1:
        raise UsageError(
            f"--x names {len(across)} numbers and --y {len(up)}; allowed: several for one of the two options "
            "only; name one component, x, y or z"
        )
    return Curves(across, up)


def run_table(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Print a car's numbers over the motion of its inputs, or for each combination of their values."""
    if options.grid and options.rows:
        raise UsageError("--rows divides the scene's time, and a grid has none; leave --rows or --grid out")
    if options.convention and options.convention not in CONVENTIONS:
        raise pc.UnknownName("convention", options.convention, CONVENTIONS)
    if options.all and CONVENTIONS.get(options.convention):
        raise UsageError(
            "--all prints every number by pointcoord's own definitions; leave --convention out with it"
        )
    target = options.output
    with named_scene(options.scene) as (scene, name):
        if options.convention:
            scene = scene.model_copy(update={"convention": options.convention})
        axes = _axes(scene, options.grid)
        read = numbers_asked(scene, name, options.number, None if options.all else READ_FIRST)
        if not options.number:
            read += tuple(one for one in numbers_of(scene) if one.is_force and not one.effect)
        if axes and (rates := [n.called for n in read if len(n.path) == 1 or per_second(n.path[0])]):
            raise UsageError(
                f"--number {rates[0]}: a grid has poses and no rates; leave out this number or --grid"
            )
        scene = named.asking_for(scene, read)
        inputs = {one.path[0]: one for one in numbers_of(scene) if one.path[0] in scene.functions}
        if axes:
            grid = {inputs[one]: values for one, values in axes.items()}
            return _grid(scene, name, grid, read, target, console)
        driven = [n for n, law in scene.functions.items() if not law.still] or list(scene.inputs)

        def write(motion: Motion) -> str:
            rows = options.rows or min(ROWS, len(motion.times))
            first, last = motion.times[0], motion.times[-1]
            samples = motion.at(np.linspace(first, last, rows)) if len(motion.times) > 1 else motion
            numbers = (*(inputs[one] for one in driven), *read)
            columns = {number: number.shown(motion, samples) for number in numbers}
            console.put(target, _text(columns, target), "the table")
            return "the table"

        return solved(scene, name, target, console, write)


def _grid(
    scene: Scene,
    name: str,
    axes: Mapping[Number, Array],
    read: Sequence[Number],
    target: str,
    console: Console,
) -> ExitStatus:
    """Print a row for each combination of values; status 3 if any of them is out of reach."""
    grid = dict(zip(axes, map(np.ravel, np.meshgrid(*axes.values(), indexing="ij")), strict=True))
    at = {number.path[0]: values for number, values in grid.items()}
    held = {n: law.series(scene.time.start, 0)[0] for n, law in scene.functions.items() if n not in at}
    poses = pc.solve_poses(scene, held | at)
    rows = np.arange(float(len(poses.bound)))
    there = Solution("pointcoord", rows, poses.numbers, Accuracy(np.ones(len(rows))))
    columns = {number: number.factor * values for number, values in grid.items()}
    columns |= {number: number.shown(None, there) for number in read}
    reasons = {row: str(error) for row, error in poses.failures.items()}
    console.put(target, _text(columns, target, reasons), "the table")
    if not reasons:
        return ExitStatus.AGREE
    first = min(reasons)
    console.complain(
        f"{name}: {len(reasons)} of {len(rows)} poses are out of reach, the first in row {first + 1}: "
        f"{reasons[first]}"
    )
    return ExitStatus.NO_VERDICT


def _axes(scene: Scene, texts: Sequence[str]) -> dict[str, Array]:
    """The values of each input of a grid; empty if none is asked for."""
    found: dict[str, Array] = {}
    for text in texts:
        name, equals, values = text.partition("=")
        if not equals:
            raise WrongArgument(f"--grid {shown(text)}", "gives no values", EXAMPLES)
        if name not in scene.inputs:
            problem = f"does not name an input that the scene drives{meant(name, scene.inputs)}"
            raise WrongArgument(f"--grid {shown(text)}", problem, f"{EXAMPLES}; of {', '.join(scene.inputs)}")
        if name in found:
            raise WrongArgument(f"--grid {shown(name)}", "is given twice", "each input once")
        found[name] = values_of(f"--grid {shown(text)}", values, EXAMPLES)
    moving = [n for n, law in scene.functions.items() if n not in found and not law.still]
    if found and moving:
        raise UsageError(
            f"--grid leaves out {moving[0]}, which moves in the scene; give --grid {moving[0]}=VALUES too"
        )
    return found


def _text(columns: Mapping[Number, Array], target: str, reasons: Mapping[int, str] | None = None) -> str:
    """The table as CSV, or as Markdown or text with the positive directions below it.

    Args:
        columns: numbers over the rows of the table, (N,) each, angles in degrees.
        reasons: by row of a grid, why the row has no numbers.
    """
    names = [number.called for number in columns]
    # An input and a number may have the same name, such as the damper's length.
    whole = [".".join(one.path if len(one.path) > 1 else ("input", *one.path)) for one in columns]
    names = [long if names.count(name) > 1 else name for name, long in zip(names, whole, strict=True)]
    head = tuple(one.headed(name=name) for name, one in zip(names, columns, strict=True))
    if target.endswith(".csv"):
        lines = zip(*(each.tolist() for each in columns.values()), strict=True)
        if reasons is None:
            return csv_of(head, lines)
        every = ((*line, reasons.get(row, "")) for row, line in enumerate(lines))
        return csv_of((*head, "why there is none"), every)
    kept = sum(len(one.path) == 1 for one in columns)
    table = Table(head, tuple(zip(*map(_rounded, columns.values()), strict=True)), kept=kept)
    # The wheels of an axle share a line.
    signs = {"-" * one.minus + one.called.rpartition(".")[2]: one for one in columns if one.of_the_car}
    signs |= {one.called: one for one in columns if len(one.path) > 2 and not one.is_force}
    marks = {"+": "positive", "-": "negative"}
    directions = [f"{number}: {marks[one.mark]} {one.sign}" for number, one in signs.items() if one.sign]
    if any(one.is_force for one in columns):
        directions += [f"{force.words}: positive {force.sign}" for force in LOADS.quantities]
    if target != "-":
        return "\n".join([table.markdown, "", *(f"- {line}" for line in directions), ""])
    return text_for(sys.stdout, [table, "", *directions, ""])


def _rounded(values: Array) -> list[str]:
    """Numbers with the decimals that give the largest five significant digits; a dash for no number."""
    largest = np.abs(values[np.isfinite(values)]).max(initial=0.0)
    decimals = FIGURES - 1 - int(np.floor(np.log10(largest))) if largest > 0.0 else 0
    decimals = min(max(decimals, DECIMALS[0]), DECIMALS[1])
    return [f"{one:z.{decimals}f}" if np.isfinite(one) else "-" for one in values]


COMMANDS = {
    "simulate": Command(run_simulate, {"methods": ",".join(BY_NAME)}),
    "plot": Command(run_plot, {"smooth": SMOOTH}),
    "table": Command(run_table, {"rows": ROWS, "conventions": ", ".join(CONVENTIONS)}),
}
