"""`pointcoord sweep`: many designs of one suspension, solved together."""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from pointcoord import (
    Designs,
    PointcoordError,
    Scene,
    SceneError,
    Sweep,
    UnknownName,
    WrongArgument,
    designs_of,
    grid_of,
    sweep_blocks,
)
from pointcoord.sweeping.designs import coordinates_named
from pointcoord.sweeping.swept import Failure, Noted, merged
from pointcoord.toml_text import read_file
from validate.arrays import Array
from validate.commands.pages import Command
from validate.commands.usage import named_scene
from validate.commands.values import finite, values_of
from validate.errors import UsageError
from validate.exit_status import ExitStatus
from validate.output.columns import put_table, rows_of_sweep
from validate.output.console import Console
from validate.output.progress import Told
from validate.output.table import Part, Table
from validate.plain_text import counted_as, shown
from validate.tables.cells import joined, lines_of, text_of
from validate.tables.units import degrees_of

EXAMPLES = "POINT.AXIS=START:STOP:COUNT or =A,B,C, in finite mm from the drawing"


@dataclass
class Summary:
    """The results of a sweep so far.

    Attributes:
        tried, instants: numbers of designs, and of instants of each.
        failed: number of failed designs by reason. first: the first failure by reason.
        notes: notes on designs, merged.
        ends: by quantity and heading of a number of the car, its lowest and highest values in each block,
            angles in degrees, with their designs.
    """

    tried: int = 0
    instants: int = 0
    failed: Counter[str] = field(default_factory=Counter)
    first: dict[str, Failure] = field(default_factory=dict)
    notes: tuple[Noted, ...] = ()
    ends: dict[tuple[str, str], list[tuple[float, int]]] = field(default_factory=dict)

    def add(self, block: Sweep) -> None:
        """Add a block of designs."""
        self.tried += len(block)
        self.instants = len(block.times)
        for failure in block.failures.values():
            self.failed[failure.reason] += 1
            self.first.setdefault(failure.reason, failure)
        self.notes = merged((*self.notes, *block.notes))
        for quantity, channel in block.numbers.items():
            factor, unit = degrees_of(channel.quantity.unit)
            for name, array in channel.items() if channel.quantity.of == "car" else ():
                if np.isfinite(array).any():
                    # The array has a row for each design.
                    places = int(np.nanargmin(array)), int(np.nanargmax(array))
                    ends = ((factor * float(array.flat[i]), block.first + i // self.instants) for i in places)
                    self.ends.setdefault((quantity, f"{name} [{unit}]"), []).extend(ends)

    def failed_lines(self) -> list[str]:
        """The reasons of failed designs, the most frequent first."""
        return [
            f"{count} of {counted_as(self.tried, 'design')} failed: {reason}; such as design "
            f"{self.first[reason].design}: {self.first[reason].error}"
            for reason, count in self.failed.most_common()
        ]

    def parts(self) -> tuple[Part, ...]:
        """The lines and the table to print."""
        rows = [
            (heading, *(f"{round(end, 4):z.6g} (design {design})" for end, design in (min(ends), max(ends))))
            for (_, heading), ends in self.ends.items()
        ]
        table = [Table(("over designs and instants", "lowest", "highest"), tuple(rows))] if rows else []
        designs, instants = counted_as(self.tried, "design"), counted_as(self.instants, "instant")
        total = f"solved: {self.tried - self.failed.total()} of {designs}, at {instants} each"
        return (total, *self.failed_lines(), *table)


def run(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Solve the designs, write each block as it is solved, and print a summary."""
    with named_scene(options.scene) as (scene, name):
        if options.instants is not None:
            time = {**scene.time.model_dump(), "samples": options.instants}
            scene = scene.model_copy(update={"time": time})
    designs, summary = _designs(scene, options), Summary()
    try:
        with console.progress("designs", total=designs.count, lines=False) as progress:
            blocks = _seen(sweep_blocks(designs), summary, progress)
            if options.output is not None:
                put_table(options.output, rows_of_sweep(blocks), "the designs", console)
            else:
                for _ in blocks:
                    pass
    except (SceneError, WrongArgument, UnknownName):
        raise
    except PointcoordError as error:
        console.complain(f"{name}: {error}")
        return ExitStatus.NO_VERDICT
    console.show(summary.parts())
    for note in summary.notes:
        (console.warn if note.warns else console.note)(f"{name}: {note.told(summary.tried)}")
    if console.mute:
        for line in summary.failed_lines():
            console.complain(f"{name}: {line}")
    return ExitStatus.NO_VERDICT if summary.failed else ExitStatus.AGREE


def _seen(blocks: Iterator[Sweep], summary: Summary, progress: Told) -> Iterator[Sweep]:
    """Pass the blocks on, and add each to the summary."""
    for block in blocks:
        summary.add(block)
        progress("designs", summary.tried)
        yield block


def _designs(scene: Scene, options: argparse.Namespace) -> Designs:
    """The designs of --vary or --designs."""
    if bool(options.vary) == bool(options.designs):
        problem = "--vary and --designs are both given" if options.vary else "nothing is varied"
        raise UsageError(f"{problem}; give --vary {EXAMPLES}, once or more, or --designs FILE.csv")
    if options.designs:
        return _designs_of_file(scene, options.designs)
    varied: dict[str, Array] = {}
    for text in options.vary:
        what, (coordinate, _, values) = f"--vary {shown(text)}", text.partition("=")
        if len(meant := coordinates_named(coordinate.strip(), scene.mechanism.topology.points)) > 1:
            raise WrongArgument(what, "names a point, not a coordinate", ", ".join(meant))
        if coordinate.strip() in varied:
            raise WrongArgument(f"--vary {shown(coordinate)}", "is given twice", "once")
        varied[coordinate.strip()] = values_of(what, values, EXAMPLES)
    return grid_of(scene, offsets=varied)


def _designs_of_file(scene: Scene, path: str) -> Designs:
    """A design for each row of a table."""
    name, text = shown(path), text_of(read_file(path, "a CSV file"))
    rows = lines_of(text or "").rows
    if len(rows) < 2:
        raise WrongArgument(name, "has no designs", "a line of names, then a line of numbers for each design")
    (first, head), *lines = rows
    header = [cell.removesuffix(" [mm]") for cell in joined(head)]
    for column in header:
        problem = ", which is a point"
        try:
            if len(coordinates_named(column, scene.mechanism.topology.points)) == 1:
                problem = " twice" if header.count(column) > 1 else ""
        except UnknownName as error:
            problem = f": {error}"
        if problem:
            where = f"has the column {shown(column)!r}{problem}"
            raise WrongArgument(f"{name}: line {first}", where, "columns such as strut_top.z, each once")
    for line, row in lines:
        if len(row) != len(header):
            raise WrongArgument(
                f"{name}: line {line}", f"has {counted_as(len(row), 'number')}", f"{len(header)}, as names"
            )
    values = np.array([finite(f"{name}: line {line}", row, "finite numbers, mm") for line, row in lines])
    return designs_of(scene, {column: values[:, i] for i, column in enumerate(header)})


COMMANDS = {"sweep": Command(run)}
