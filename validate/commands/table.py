"""`pointcoord table`: what an engineer reads of a car, a row for each place on its way."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pointcoord import Motion, PointcoordError, Scene, SceneError, simulate
from pointcoord.effects.registry import EFFECTS, NUMBERS_OF_THE_CAR, READ_FIRST
from pointcoord.wording import meant
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
from validate.errors import UsageError
from validate.exit_status import ExitStatus
from validate.output.console import Console
from validate.output.progress import progress
from validate.output.table import Table, csv_of
from validate.plain_text import shown

Array = NDArray[np.float64]

ENDINGS = (".csv", ".md")
ROWS = 21
DIGITS = {"deg": 4, "mm": 3, "deg/mm": 6, "mm/mm": 5, "%": 2}

DESCRIPTION = """\
Solve a scene by point coordinates and print the wheel's angles and dimensions over the way of
its inputs, with what they change by per mm of wheel travel and of rack. A sweep such as
wheel_travel = { sweep = [-50.0, 50.0] } makes a plain range; bump steer is toe_by_travel,
the motion ratio damper over wheel minus damper_length_by_travel."""


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command with its options."""
    parser = commands.add_parser(
        "table", help="print a car's angles and dimensions over travel", description=DESCRIPTION
    )
    add_scene(parser)
    add_output(
        parser, "FILE", f"where to, by its ending {' or '.join(ENDINGS)}; a table in text if not given"
    )
    parser.add_argument(
        "--rows",
        metavar="N",
        type=how_many,
        help=f"how many, evenly over the scene's time; its own if these are fewer than {ROWS}, else {ROWS}",
    )
    parser.add_argument(
        "--number", metavar="NAME", action="append", help="a column, by its name; may be given again"
    )
    parser.add_argument("--all", action="store_true", help="every number of the car that there is")
    add_quiet(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Solve the scene and print its table, or the part of it that could be solved.

    Raises:
        UsageError: a number or a file is not named as it must be.
        SceneError: the scene is wrong.
        OutputError: the table cannot be written.
    """
    console.quiet = options.quiet
    target = place_of_result(options, ENDINGS, console)
    scene, name = load_scene(options.scene), name_of(options.scene)
    chosen = _chosen(options, scene, name)
    had = scene.mechanism.effects
    givers = {number: effect for effect in reversed(had) for number in EFFECTS[effect].names or ()}
    effects = tuple(dict.fromkeys((*scene.effects, *(givers[number] for number in chosen))))
    problem: PointcoordError | None = None
    try:
        with told_as(name), progress(console, f"solving {name}", total=None, lines=False):
            motion = simulate(scene.model_copy(update={"effects": effects}))
    except SceneError:
        raise
    except PointcoordError as error:
        if error.partial is None:
            console.complain(f"{name}: {error}; nothing is written")
            return ExitStatus.NO_VERDICT
        motion, problem = error.partial, error
    comment(scene, name, motion, console)
    head, columns = _columns(scene, motion, chosen, options.rows or min(ROWS, len(motion.times)))
    write_result(target, _written(target, head, columns, chosen), "the table", console)
    if problem is not None:
        console.complain(f"{name}: {problem}; the table goes up to t = {motion.times[-1]:.10g} s")
        return ExitStatus.NO_VERDICT
    return ExitStatus.AGREE


def _chosen(options: argparse.Namespace, scene: Scene, name: str) -> list[str]:
    """The numbers of the columns.

    Raises:
        UsageError: there is none of a name, or the car does not have it.
    """
    had = [number for effect in scene.mechanism.effects for number in EFFECTS[effect].names or ()]
    known = [number for number in dict.fromkeys(had) if number in NUMBERS_OF_THE_CAR]
    if not known:
        raise UsageError(
            f"{name}: there is no number of a wheel: its mechanism names no wheel_axis under [roles], or of "
            "its parts only; pointcoord simulate writes what it gives"
        )
    for number in options.number or ():
        if number in known:
            continue
        why = [scene.mechanism.refusal(e) for e in EFFECTS.values() if number in (e.names or ())]
        if why:
            raise UsageError(f"{name}: --number {number}: {why[0]}")
        raise UsageError(
            f"{name}: no number of a car is called {shown(number)}{meant(number, NUMBERS_OF_THE_CAR)}; "
            f"allowed: {', '.join(known)}"
        )
    if options.number:
        return list(dict.fromkeys(options.number))
    return known if options.all else [number for number in READ_FIRST if number in known]


def _columns(
    scene: Scene, motion: Motion, chosen: Sequence[str], rows: int
) -> tuple[list[tuple[str, str]], list[Array]]:
    """Name and unit of each column, and its values: the inputs that move, and the numbers; in degrees."""
    first, last = motion.times[0], motion.times[-1]
    samples = motion.at(np.linspace(first, last, rows)) if len(motion.times) > 1 else motion
    units = scene.mechanism.topology.input_units
    moving = [n for n, law in scene.functions.items() if not law.still] or list(scene.inputs)
    head = [(n, units[n]) for n in moving]
    columns = [scene.functions[n].series(samples.times, 0)[:, 0] for n in moving]
    for number in chosen:
        quantity = NUMBERS_OF_THE_CAR[number].quantity
        head.append((number, quantity.unit))
        columns.append(samples.numbers[quantity.name][number])
    angles = [unit.startswith("rad") for _, unit in head]
    return (
        [(n, unit.replace("rad", "deg", 1)) for n, unit in head],
        [np.degrees(c) if angle else c for c, angle in zip(columns, angles, strict=True)],
    )


def _written(
    target: str | None, head: Sequence[tuple[str, str]], columns: Sequence[Array], chosen: Sequence[str]
) -> str:
    titles = tuple(f"{name} [{unit}]" for name, unit in head)
    if target is not None and Path(target).suffix == ".csv":
        return csv_of(titles, zip(*(column.tolist() for column in columns), strict=True))
    rows = tuple(
        tuple(_number(value, unit) for value, (_, unit) in zip(row, head, strict=True))
        for row in zip(*(column.tolist() for column in columns), strict=True)
    )
    table = Table(titles, rows)
    told = {number: NUMBERS_OF_THE_CAR[number].sign for number in chosen}
    signs = [f"{number}: positive {sign}" for number, sign in told.items() if sign]
    if target is not None:
        return "\n".join([table.markdown, "", *(f"- {sign}" for sign in signs), ""])
    return "\n".join([table.text, "", *signs, ""])


def _number(value: float, unit: str) -> str:
    # Adding 0 turns a rounded -0 into 0.
    return f"{round(value, DIGITS[unit]) + 0.0:.{DIGITS[unit]}f}" if np.isfinite(value) else "-"
