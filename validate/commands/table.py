"""`pointcoord table`: what an engineer reads of a car, over the way of its inputs or on a grid of them."""

from __future__ import annotations

import argparse
import shutil
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pointcoord import Motion, PointcoordError, Scene, SweepError, UnknownName, solve_poses
from pointcoord.effects.conventions import CONVENTIONS
from pointcoord.effects.loads import LOADS
from pointcoord.effects.registry import EFFECTS, READ_FIRST, number_called
from pointcoord.wording import meant
from validate.commands.solved import solved
from validate.commands.usage import (
    QUIET,
    SCENE,
    Command,
    given,
    load_scene,
    name_of,
    place_of_result,
    told_as,
)
from validate.commands.values import values_of
from validate.curves.numbers import COMPONENTS, Number, asking_for, by_path, numbers_of
from validate.errors import UsageError
from validate.exit_status import ExitStatus
from validate.formulations.asked_numbers import is_force, per_second
from validate.output.console import Console
from validate.output.table import Table, csv_of, is_terminal
from validate.plain_text import shown, some_of
from validate.tables.units import degrees_of

Array = NDArray[np.float64]

ENDINGS = (".csv", ".md")
ROWS = 21
NAMED = 12  # numbers, in a message
DIGITS = {
    "deg": 4,
    "mm": 3,
    "deg/mm": 6,
    "mm/mm": 5,
    "deg/rad": 4,
    "deg/s": 3,
    "mm/s": 2,
    "%": 2,
    "mm/deg": 5,
    "N": 2,
    "N/mm": 4,
}
OTHERWISE = 4
EXAMPLES = "INPUT=START:STOP:COUNT or INPUT=A,B,C, finite, in mm or rad as in a scene"

DESCRIPTION = """\
Solve a scene by point coordinates and print the wheel's angles and dimensions over the way of
its inputs, and how much they change per mm of wheel travel and of rack. A sweep such as
wheel_travel = { sweep = [-50.0, 50.0] } makes a plain range. Bump steer is called toe_by_travel,
and the motion ratio damper_per_wheel. With --grid there is a row for every combination of values
of inputs, and the other inputs stay where the scene begins:

  --grid wheel_travel=-50:50:11 --grid rack=-30:30:7

Where the scene has loads and asks for them, there are columns for the forces of rods, joints and
slides.
Other programs mean other numbers by the same names: --convention adams has Adams/Car's camber,
optimumk OptimumK's toe and steer angle, with what is positive there. Columns keep our names,
with a minus before one that counts the other way.

A row out of reach has no numbers and says why; the exit status is then 3."""

OPTIONS = f"""\
{SCENE}
-o --output FILE  where to, by its ending {" or ".join(ENDINGS)}; a table in text if not given
--rows N  how many, evenly over the scene's time; its own if these are fewer than {ROWS}, else {ROWS}
--grid INPUT=VALUES  a row for every combination of values instead, in mm or rad; may be given again
--number NAME  a column, such as toe, rod_force.tie_rod or velocity.wheel_centre.z; may be given again
--all  every number of the car that there is at a pose
--convention NAME  what names mean: {", ".join(CONVENTIONS)}; the scene's if not given, iso if it has none
{QUIET}"""


def run(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Print a table."""
    target = place_of_result(options, ENDINGS, console)
    if options.grid and given(options, "--rows"):
        raise UsageError("--rows is about a way of the inputs; leave it out with --grid")
    scene, name = load_scene(options.scene), name_of(options.scene)
    if options.convention:
        if options.convention not in CONVENTIONS:
            raise UnknownName("convention", options.convention, CONVENTIONS)
        if options.all and CONVENTIONS[options.convention].means:
            raise UsageError("--all is every number by our names; leave --convention out with it")
        scene = scene.model_copy(update={"convention": options.convention})
    signs = meant_numbers(options.number, scene, name, READ_FIRST if not options.all else None)
    with told_as(name):
        scene = asking_for(scene, [*signs])
    every = numbers_of(scene)
    # A rod may be called as a number of the car is, and has a force: the first by a name is the car's.
    numbers = {number.path[-1]: number for number in reversed(every) if number.of_the_car}
    inputs = {number.path[0]: number for number in every if len(number.path) == 1}
    paths = by_path(scene)
    read = [numbers[number] if number in numbers else paths[number] for number in signs]
    if not options.number:
        read += [one for one in every if _is_force(one) and one.missing is None]
    if options.grid:
        rates = [name for name, number in zip(signs, read, strict=False) if per_second(number.path[0])]
        if rates:
            raise UsageError(f"--number {rates[0]}: poses of a grid have no rates; leave it out, or --grid")
        return _on_grid(scene, read, signs, options, target, console)
    driven = [n for n, law in scene.functions.items() if not law.still] or list(scene.inputs)
    columns = [*(inputs[one] for one in driven), *read]

    def write(motion: Motion) -> str:
        rows = options.rows or min(ROWS, len(motion.times))
        first, last = motion.times[0], motion.times[-1]
        samples = motion.at(np.linspace(first, last, rows)) if len(motion.times) > 1 else motion
        values = [one.shown(motion, samples) for one in columns]
        console.put(target, _text(columns, values, signs, target), "the table")
        return "the table"

    return solved(scene, target, options, console, write)


def meant_numbers(
    named: Sequence[str] | None, scene: Scene, name: str, first: Sequence[str] | None
) -> dict[str, int]:
    """Our numbers that are meant by the scene's convention, and -1 of those that it counts the other way.

    What is no number of the car is named by its path, as by `by_path`.

    Args:
        named: names of these. name: of the scene, for messages.
        first: without names, those that are taken of what the car has; of None every number by our names that
            does not hang on how fast the car moves.
    Raises:
        UsageError: the car has no such number, or none at all.
    """
    convention, known = CONVENTIONS[scene.convention], _known_numbers(scene, name)
    if named:
        counted = dict(map(convention.number, named))
        chosen = _chosen_of([*counted], known, scene, name)
        return {number: counted.get(number, counted.get(number.rpartition(".")[2], 1)) for number in chosen}
    if first is None:
        called = {one: number_called(one) for one in known}
        return {one: 1 for one, number in called.items() if number and not per_second(number.quantity.name)}
    usual = [number for own in first for number in known if number.rpartition(".")[2] == own]
    return {number: sign for number, sign in map(convention.number, usual) if number in known}


def _is_force(number: Number) -> bool:
    """Whether it is one of what loads make."""
    return len(number.path) > 1 and is_force(number.path[0])


def _known_numbers(scene: Scene, name: str) -> list[str]:
    """The numbers that the car has."""
    part = scene.mechanism
    had = [number for effect in part.effects for number in EFFECTS[effect].names(part.topology)]
    known = [number for number in dict.fromkeys(had) if number_called(number)]
    if not known:
        raise UsageError(
            f"{name}: there is no number of a wheel: its mechanism names no wheel_axis under [roles]; "
            "pointcoord simulate writes what it gives"
        )
    return known


def _chosen_of(named: Sequence[str], known: Sequence[str], scene: Scene, name: str) -> list[str]:
    """Numbers by names, of each wheel where no part is named."""
    part = scene.mechanism
    asked = [one for number in named for one in _of_each_part(number, known) or [number]]
    paths = by_path(scene)
    for number in asked:
        if number not in known and number not in paths:
            own = number.rpartition(".")[2]
            why = [reason for e in EFFECTS.values() if own in e.own_names and (reason := part.refusal(e))]
            raise UsageError(
                f"{name}: --number {number}: {why[0]}"
                if why
                else f"{name}: no number of a car is called {shown(number)}"
                f"{meant(number, (*known, *paths))}; allowed: {some_of(known, NAMED)} (--all shows every one)"
            )
    return list(dict.fromkeys(asked))


def _of_each_part(number: str, known: Sequence[str]) -> list[str]:
    """A number that the wheels have by a name without their part's; none of one that has it whole."""
    return [] if number in known else [one for one in known if one.rpartition(".")[2] == number]


def _on_grid(
    scene: Scene,
    columns: Sequence[Number],
    signs: Mapping[str, int],
    options: argparse.Namespace,
    target: str | None,
    console: Console,
) -> ExitStatus:
    """A row for each combination of values; status 3 where one of them is out of reach."""
    axes = _axes(scene, options.grid)
    grid = dict(zip(axes, np.meshgrid(*axes.values(), indexing="ij"), strict=True))
    held = {n: law.series(scene.time.start, 0)[0] for n, law in scene.functions.items() if n not in axes}
    name = name_of(options.scene)
    try:
        with told_as(name):
            poses = solve_poses(scene, {**held, **{n: values.ravel() for n, values in grid.items()}})
    except PointcoordError as error:
        console.complain(f"{name}: {error}; nothing is written")
        return ExitStatus.NO_VERDICT
    inputs = {n.path[0]: n for n in numbers_of(scene) if len(n.path) == 1}
    # A pose has no motion: what is read of the car is there by quantity and name.
    values = [grid[n].ravel() for n in axes]
    for one in columns:
        there = poses.numbers[one.path[0]][one.path[1]]
        values.append(there[:, COMPONENTS.index(one.path[2])] if len(one.path) > 2 else there)
    every = [*(inputs[n] for n in axes), *columns]
    turned = [v * degrees_of(c.unit)[0] for c, v in zip(every, values, strict=True)]
    reasons = {row: str(error) for row, error in poses.failures.items()}
    console.put(target, _text(every, turned, signs, target, reasons), "the table")
    if not reasons:
        return ExitStatus.AGREE
    first = min(reasons)
    console.complain(
        f"{name}: {len(reasons)} of {len(poses.bound)} poses are out of reach, the first in row {first + 1}: "
        f"{reasons[first]}"
    )
    return ExitStatus.NO_VERDICT


def _axes(scene: Scene, texts: Sequence[str]) -> dict[str, Array]:
    """The values of each input of a grid.

    Raises:
        UsageError: one is not driven, or is given twice. SweepError: values are no range and no list.
    """
    found: dict[str, Array] = {}
    for text in texts:
        name, equals, values = text.partition("=")
        if name not in scene.inputs or not equals:
            problem = f"names no input that the scene drives{meant(name, scene.inputs)}"
            raise SweepError(f"--grid {shown(text)}", problem, f"{EXAMPLES}; of {', '.join(scene.inputs)}")
        if name in found:
            raise SweepError(f"--grid {shown(name)}", "is given twice", "each input once")
        found[name] = values_of(f"--grid {shown(text)}", values, EXAMPLES)
    moving = [n for n, law in scene.functions.items() if n not in found and not law.still]
    if moving:
        raise UsageError(f"{moving[0]} moves in the scene; give its values too, --grid {moving[0]}=VALUES")
    return found


def _text(
    columns: Sequence[Number],
    values: Sequence[Array],
    signs: Mapping[str, int],
    target: str | None,
    reasons: Mapping[int, str] | None = None,
) -> str:
    """Numbers, angles in degrees: CSV, or text with what is positive.

    Args:
        signs: of numbers by name, -1 of what is to count the other way.
        reasons: why there are none in a row, of a grid.
    """
    names = [".".join(one.path) if _is_force(one) or len(one.path) > 2 else one.path[-1] for one in columns]
    ways = [signs.get(name, 1) for name in names]
    # An input may be called as a number is, such as the damper's length.
    whole = [".".join(one.path if len(one.path) > 1 else ("input", *one.path)) for one in columns]
    names = [long if names.count(name) > 1 else name for name, long in zip(names, whole, strict=True)]
    head = tuple(
        f"{'-' if way < 0 else ''}{name} [{one.unit_shown()}]"
        for name, way, one in zip(names, ways, columns, strict=True)
    )
    counted = (way * each for way, each in zip(ways, values, strict=True))
    lines = [tuple(line) for line in zip(*(each.tolist() for each in counted), strict=True)]
    if target is not None and Path(target).suffix == ".csv":
        if reasons is None:
            return csv_of(head, lines)
        every = ((*line, reasons.get(row, "")) for row, line in enumerate(lines))
        return csv_of((*head, "why there is none"), every)
    digits = [DIGITS.get(one.unit_shown(), OTHERWISE) for one in columns]
    table = Table(head, tuple(tuple(map(_rounded, line, digits)) for line in lines))
    # The wheels of an axle share a line.
    told_signs = {one.path[-1].rpartition(".")[2]: one.sign for one in columns if one.of_the_car and one.sign}
    vectors = (one for one in columns if len(one.path) > 2 and not _is_force(one))
    told_signs |= {".".join(one.path): one.sign for one in vectors if one.sign}
    told = [f"{number}: positive {sign}" for number, sign in told_signs.items()]
    told += [f"forces: {LOADS.sign}"] * any(map(_is_force, columns))
    if target is not None:
        return "\n".join([table.markdown, "", *(f"- {sign}" for sign in told), ""])
    kept = sum(len(one.path) == 1 for one in columns)
    # Lines that a terminal would fold cannot be read down.
    bands = table.bands(shutil.get_terminal_size().columns, kept) if is_terminal(sys.stdout) else [table]
    return "\n".join([*(line for band in bands for line in (band.text, "")), *told, ""])


def _rounded(value: float, digits: int) -> str:
    # Adding 0 turns a rounded -0 into 0.
    return f"{round(value, digits) + 0.0:.{digits}f}" if np.isfinite(value) else "-"


COMMANDS = {
    "table": Command(
        DESCRIPTION,
        OPTIONS,
        run,
        {
            "--number": {"action": "append"},
            "--grid": {"action": "append"},
        },
    )
}
