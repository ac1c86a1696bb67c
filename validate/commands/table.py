"""`pointcoord table`: a car's angles and dimensions over the motion of its inputs, or on a grid of them."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping, Sequence

import numpy as np

from pointcoord import Motion, Scene, UnknownName, WrongArgument, solve_poses
from pointcoord.effects.loads import LOADS
from pointcoord.effects.numbers import CONVENTIONS, READ_FIRST
from pointcoord.wording import meant
from validate.arrays import Array
from validate.commands.pages import Command
from validate.commands.solved import solved
from validate.commands.usage import named_scene
from validate.commands.values import values_of
from validate.curves.numbers import Number, asking_for, numbers_asked, numbers_of
from validate.errors import UsageError
from validate.exit_status import ExitStatus
from validate.formulations.asked_numbers import per_second
from validate.formulations.protocol import Accuracy, Solution
from validate.output.console import Console
from validate.output.table import Table, csv_of, text_for
from validate.plain_text import shown

Columns = Sequence[tuple[Number, Array]]
"""Numbers over the rows of a table, (N,) each, angles in degrees."""

ROWS = 21
FIGURES, DECIMALS = 5, (2, 6)  # significant digits of the largest number of a column, and limits of decimals
EXAMPLES = "INPUT=START:STOP:COUNT or INPUT=A,B,C, finite, in mm or rad as in a scene"


def run(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Print a table."""
    if options.grid and options.rows:
        raise UsageError("--rows divides the scene's time, and a grid has none; leave --rows or --grid out")
    if options.convention:
        if options.convention not in CONVENTIONS:
            raise UnknownName("convention", options.convention, CONVENTIONS)
        if options.all and CONVENTIONS[options.convention]:
            raise UsageError(
                "--all prints every number by pointcoord's own definitions; leave --convention out with it"
            )
    with named_scene(options.scene) as (scene, name):
        if options.convention:
            scene = scene.model_copy(update={"convention": options.convention})
        return _of_scene(scene, name, options, console)


def _of_scene(scene: Scene, name: str, options: argparse.Namespace, console: Console) -> ExitStatus:
    """Print the table of a scene's motion, or of a grid of its inputs."""
    target = options.output
    axes = _axes(scene, options.grid)
    read = numbers_asked(scene, name, options.number, None if options.all else READ_FIRST)
    if not options.number:
        read += tuple(one for one in numbers_of(scene) if one.is_force and not one.effect)
    scene = asking_for(scene, read)
    inputs = {number.path[0]: number for number in numbers_of(scene) if number.path[0] in scene.functions}
    if axes:
        if moving := [n.called for n in read if len(n.path) == 1 or per_second(n.path[0])]:
            raise UsageError(
                f"--number {moving[0]}: a grid has poses and no rates; leave out this number or --grid"
            )
        grid = {inputs[one]: values for one, values in axes.items()}
        return _on_grid(scene, grid, read, name, target, console)
    driven = [n for n, law in scene.functions.items() if not law.still] or list(scene.inputs)

    def write(motion: Motion) -> str:
        rows = options.rows or min(ROWS, len(motion.times))
        first, last = motion.times[0], motion.times[-1]
        samples = motion.at(np.linspace(first, last, rows)) if len(motion.times) > 1 else motion
        numbers = dict.fromkeys((*(inputs[one] for one in driven), *read))
        columns = [(number, number.shown(motion, samples)) for number in numbers]
        console.put(target, _text(columns, target), "the table")
        return "the table"

    return solved(scene, name, target, console, write)


def _on_grid(
    scene: Scene,
    axes: Mapping[Number, Array],
    read: Sequence[Number],
    name: str,
    target: str,
    console: Console,
) -> ExitStatus:
    """Print a row for each combination of values; status 3 if any of them is out of reach."""
    grid = dict(zip(axes, map(np.ravel, np.meshgrid(*axes.values(), indexing="ij")), strict=True))
    at = {number.path[0]: values for number, values in grid.items()}
    held = {n: law.series(scene.time.start, 0)[0] for n, law in scene.functions.items() if n not in at}
    poses = solve_poses(scene, held | at)
    columns = [(number, number.factor * values) for number, values in grid.items()]
    rows = np.arange(float(len(poses.bound)))
    there = Solution("pointcoord", rows, poses.numbers, Accuracy(np.ones(len(rows))))
    columns += [(number, number.shown(None, there)) for number in read]
    reasons = {row: str(error) for row, error in poses.failures.items()}
    console.put(target, _text(columns, target, reasons), "the table")
    if not reasons:
        return ExitStatus.AGREE
    first = min(reasons)
    console.complain(
        f"{name}: {len(reasons)} of {len(poses.bound)} poses are out of reach, the first in row {first + 1}: "
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


def _text(columns: Columns, target: str, reasons: Mapping[int, str] | None = None) -> str:
    """The table as CSV, or as Markdown or text with the positive directions below it.

    Args:
        reasons: by row of a grid, why the row has no numbers.
    """
    numbers, values = [number for number, _ in columns], [array for _, array in columns]
    names = [number.called for number in numbers]
    # An input and a number may have the same name, such as the damper's length.
    whole = [".".join(path if len(path := one.path) > 1 else ("input", *path)) for one in numbers]
    names = [long if names.count(name) > 1 else name for name, long in zip(names, whole, strict=True)]
    head = tuple(one.headed(name=name) for name, one in zip(names, numbers, strict=True))
    if target.endswith(".csv"):
        lines = zip(*(each.tolist() for each in values), strict=True)
        if reasons is None:
            return csv_of(head, lines)
        every = ((*line, reasons.get(row, "")) for row, line in enumerate(lines))
        return csv_of((*head, "why there is none"), every)
    kept = sum(len(one.path) == 1 for one in numbers)
    table = Table(head, tuple(zip(*map(_rounded, values), strict=True)), kept=kept)
    # The wheels of an axle share a line.
    signs = {"-" * one.minus + one.called.rpartition(".")[2]: one for one in numbers if one.of_the_car}
    signs |= {one.called: one for one in numbers if len(one.path) > 2 and not one.is_force}
    named = {"+": "positive", "-": "negative"}
    directions = [f"{number}: {named[one.mark]} {one.sign}" for number, one in signs.items() if one.sign]
    if any(one.is_force for one in numbers):
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


COMMANDS = {"table": Command(run, {"rows": ROWS, "conventions": ", ".join(CONVENTIONS)})}
