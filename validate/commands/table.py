"""`pointcoord table`: what an engineer reads of a car, over the way of its inputs or on a grid of them."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pointcoord import Motion, PointcoordError, Scene, SweepError, UnknownName, solve_poses
from pointcoord.effects.conventions import CONVENTIONS
from pointcoord.effects.loads import LOADS
from pointcoord.effects.numbers import READ_FIRST
from pointcoord.effects.registry import EFFECTS, number_called
from pointcoord.wording import meant
from validate.commands.solved import solved
from validate.commands.usage import Command, load_scene, name_of, place_of_result, told_as
from validate.commands.values import values_of
from validate.curves.numbers import COMPONENTS, Number, asking_for, by_path, numbers_of
from validate.errors import UsageError
from validate.exit_status import ExitStatus
from validate.formulations.asked_numbers import is_force, per_second
from validate.output.console import Console
from validate.output.table import Table, csv_of, text_for
from validate.plain_text import shown, some_of
from validate.tables.units import degrees_of

Array = NDArray[np.float64]

ENDINGS = (".csv", ".md")
ROWS = 21
NAMED = 12  # numbers, in a message
FIGURES, DECIMALS = 5, (2, 6)  # significant digits of the largest number of a column, and limits of decimals
EXAMPLES = "INPUT=START:STOP:COUNT or INPUT=A,B,C, finite, in mm or rad as in a scene"


@dataclass(frozen=True)
class Column:
    """A number over the rows of a table, (N,), angles in degrees; with sign -1 it counts the other way."""

    number: Number
    sign: int
    values: Array

    @property
    def name(self) -> str:
        path = self.number.path
        return ".".join(path) if _is_force(self.number) or len(path) > 2 else path[-1]


def run(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Print a table."""
    target = place_of_result(options, ENDINGS, console)
    if options.grid and options.rows:
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
    inputs = {number.path[0]: number for number in every if len(number.path) == 1}
    # A rod may be called as a number of the car is, and has a force: the first by a name is the car's.
    known = by_path(scene) | {number.path[-1]: number for number in reversed(every) if number.of_the_car}
    read = [(known[number], sign) for number, sign in signs.items()]
    if not options.number:
        read += [(one, 1) for one in every if _is_force(one) and one.missing is None]
    if options.grid:
        rates = [number for number in signs if per_second(known[number].path[0])]
        if rates:
            raise UsageError(f"--number {rates[0]}: poses of a grid have no rates; leave it out, or --grid")
        axes = _axes(scene, options.grid)
        grid = {inputs[one]: values for one, values in axes.items()}
        return _on_grid(scene, grid, read, name, target, console)
    driven = [n for n, law in scene.functions.items() if not law.still] or list(scene.inputs)

    def write(motion: Motion) -> str:
        rows = options.rows or min(ROWS, len(motion.times))
        first, last = motion.times[0], motion.times[-1]
        samples = motion.at(np.linspace(first, last, rows)) if len(motion.times) > 1 else motion
        chosen = [*((inputs[one], 1) for one in driven), *read]
        columns = [Column(one, sign, one.shown(motion, samples)) for one, sign in chosen]
        console.put(target, _text(columns, target), "the table")
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
    part, convention = scene.mechanism, CONVENTIONS[scene.convention]
    had = [number for effect in part.effects for number in EFFECTS[effect].names(part.topology)]
    known = {one: called for one in had if (called := number_called(one))}
    if not known:
        raise UsageError(
            f"{name}: there is no number of a wheel: its mechanism names no wheel_axis under [roles]; "
            "pointcoord simulate writes what it gives"
        )
    if named:
        counted = dict(map(convention.number, named))
        chosen = _of_each_wheel([*counted], [*known], scene, name)
        return {number: counted.get(number, counted.get(_own(number), 1)) for number in chosen}
    if first is None:
        return {one: 1 for one, number in known.items() if not per_second(number.quantity.name)}
    usual = [number for own in first for number in known if _own(number) == own]
    return {number: sign for number, sign in map(convention.number, usual) if number in known}


def _own(number: str) -> str:
    """The name of a number without that of its wheel."""
    return number.rpartition(".")[2]


def _of_each_wheel(named: Sequence[str], known: Sequence[str], scene: Scene, name: str) -> list[str]:
    paths, found = by_path(scene), []
    for number in named:
        if number in known or number in paths:
            found.append(number)
        elif each := [one for one in known if _own(one) == number]:
            found += each
        else:
            givers = (effect for effect in EFFECTS.values() if _own(number) in effect.own_names)
            if why := [reason for effect in givers if (reason := scene.mechanism.refusal(effect))]:
                raise UsageError(f"{name}: --number {number}: {why[0]}")
            raise UsageError(
                f"{name}: no number of a car is called {shown(number)}{meant(number, (*known, *paths))}; "
                f"allowed: {some_of(known, NAMED)} (--all shows every one)"
            )
    return list(dict.fromkeys(found))


def _is_force(number: Number) -> bool:
    return len(number.path) > 1 and is_force(number.path[0])


def _on_grid(
    scene: Scene,
    axes: Mapping[Number, Array],
    read: Sequence[tuple[Number, int]],
    name: str,
    target: str | None,
    console: Console,
) -> ExitStatus:
    """A row for each combination of values; status 3 where one of them is out of reach."""
    grid = dict(zip(axes, map(np.ravel, np.meshgrid(*axes.values(), indexing="ij")), strict=True))
    at = {number.path[0]: values for number, values in grid.items()}
    held = {n: law.series(scene.time.start, 0)[0] for n, law in scene.functions.items() if n not in at}
    try:
        with told_as(name):
            poses = solve_poses(scene, held | at)
    except PointcoordError as error:
        console.complain(f"{name}: {error}; nothing is written")
        return ExitStatus.NO_VERDICT
    columns = [(number, 1, values) for number, values in grid.items()]
    for number, sign in read:
        # A pose has no motion: what is read of the car is there by quantity and name.
        there = poses.numbers[number.path[0]][number.path[1]]
        one = there[:, COMPONENTS.index(number.path[2])] if len(number.path) > 2 else there
        columns.append((number, sign, one))
    turned = [Column(number, sign, degrees_of(number.unit)[0] * one) for number, sign, one in columns]
    reasons = {row: str(error) for row, error in poses.failures.items()}
    console.put(target, _text(turned, target, reasons), "the table")
    if not reasons:
        return ExitStatus.AGREE
    first = min(reasons)
    console.complain(
        f"{name}: {len(reasons)} of {len(poses.bound)} poses are out of reach, the first in row {first + 1}: "
        f"{reasons[first]}"
    )
    return ExitStatus.NO_VERDICT


def _axes(scene: Scene, texts: Sequence[str]) -> dict[str, Array]:
    """The values of each input of a grid."""
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


def _text(columns: Sequence[Column], target: str | None, reasons: Mapping[int, str] | None = None) -> str:
    """CSV, or text with what is positive.

    Args:
        reasons: why there are no numbers in a row, of a grid.
    """
    names = [column.name for column in columns]
    # An input may be called as a number is, such as the damper's length.
    whole = [".".join(path if len(path := one.number.path) > 1 else ("input", *path)) for one in columns]
    names = [long if names.count(name) > 1 else name for name, long in zip(names, whole, strict=True)]
    head = tuple(
        f"{'-' if one.sign < 0 else ''}{name} [{one.number.unit_shown()}]"
        for name, one in zip(names, columns, strict=True)
    )
    values = [one.sign * one.values for one in columns]
    if target is not None and Path(target).suffix == ".csv":
        lines = zip(*(each.tolist() for each in values), strict=True)
        if reasons is None:
            return csv_of(head, lines)
        every = ((*line, reasons.get(row, "")) for row, line in enumerate(lines))
        return csv_of((*head, "why there is none"), every)
    numbers = [column.number for column in columns]
    kept = sum(len(one.path) == 1 for one in numbers)
    table = Table(head, tuple(zip(*map(_rounded, values), strict=True)), kept=kept)
    # The wheels of an axle share a line.
    signs = {_own(one.path[-1]): one.sign for one in numbers if one.of_the_car}
    signs |= {".".join(one.path): one.sign for one in numbers if len(one.path) > 2 and not _is_force(one)}
    told = [f"{number}: positive {sign}" for number, sign in signs.items() if sign]
    told += [f"forces: {LOADS.sign}"] * any(map(_is_force, numbers))
    if target is not None:
        return "\n".join([table.markdown, "", *(f"- {sign}" for sign in told), ""])
    return text_for(sys.stdout, [table, "", *told, ""])


def _rounded(values: Array) -> list[str]:
    """Numbers with so many decimals that the largest has five figures; a dash where there is none."""
    largest = np.abs(values[np.isfinite(values)]).max(initial=0.0)
    decimals = FIGURES - 1 - int(np.floor(np.log10(largest))) if largest > 0.0 else 0
    decimals = min(max(decimals, DECIMALS[0]), DECIMALS[1])
    # Adding 0 turns a rounded -0 into 0.
    return [f"{round(one, decimals) + 0.0:.{decimals}f}" if np.isfinite(one) else "-" for one in values]


COMMANDS = {
    "table": Command(run, {"rows": ROWS, "conventions": ", ".join(CONVENTIONS)}),
}
