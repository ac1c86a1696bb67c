"""`pointcoord sweep` and `sensitivity`: many designs of one suspension, solved together."""

from __future__ import annotations

import argparse
import sys
from collections import Counter, deque
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

import pointcoord as pc
from pointcoord import Scene, Sweep, WrongArgument
from pointcoord.effects.numbers import RANKED_FIRST
from pointcoord.sweeping.designs import coordinates_named
from pointcoord.sweeping.sensitivity import numbers_named
from pointcoord.sweeping.swept import Failure, Noted, merged
from pointcoord.toml_text import read_file
from validate.arrays import Array
from validate.commands.pages import Command
from validate.commands.usage import STOPS, finite, named_scene, values_of
from validate.curves.numbers import asking_for, numbers_asked
from validate.errors import NotSolved, UsageError
from validate.exit_status import ExitStatus
from validate.extras import needed
from validate.output.columns import put_table, rows_of_sweep
from validate.output.console import Console
from validate.output.table import Part, Table, csv_of, text_for
from validate.plain_text import counted_as, shown
from validate.tables.cells import joined, lines_of, text_of
from validate.tables.units import degrees_of

EXAMPLES = "POINT.AXIS=START:STOP:COUNT or =A,B,C, in finite mm from the drawing"
PICTURES = (".svg", ".png")
ROWS = 15
SAMPLES = 11
DESIGNS = 400


@dataclass
class Summary:
    """The results of a sweep so far.

    Attributes:
        tried, instants: numbers of designs, and of instants of each.
        failed: failures by reason.
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

    @property
    def failed_lines(self) -> list[str]:
        """The reasons of failed designs, the most frequent first, each with its first design."""
        of, firsts = counted_as(self.tried, "design"), self.first
        return [
            f"{count} of {of} failed: {why}; such as design {firsts[why].design}: {firsts[why].error}"
            for why, count in self.failed.most_common()
        ]

    @property
    def parts(self) -> tuple[Part, ...]:
        """The lines and the table to print."""
        rows = [
            (heading, *(f"{round(end, 4):z.6g} (design {design})" for end, design in (min(ends), max(ends))))
            for (_, heading), ends in self.ends.items()
        ]
        table = [Table(("over designs and instants", "lowest", "highest"), tuple(rows))] if rows else []
        designs, instants = counted_as(self.tried, "design"), counted_as(self.instants, "instant")
        total = f"solved: {self.tried - self.failed.total()} of {designs}, at {instants} each"
        return (total, *self.failed_lines, *table)


def run_sweep(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Solve the designs, write each block as it is solved, and print a summary."""
    with named_scene(options.scene) as (scene, name):
        scene = _sampled(scene, options.instants or scene.time.samples)
    designs, summary = _designs(scene, options), Summary()
    with console.progress("designs", total=designs.count) as progress:

        def solved() -> Iterator[Sweep]:
            for block in pc.sweep_blocks(designs):
                summary.add(block)
                progress("designs", summary.tried)
                yield block

        try:
            if options.output is not None:
                put_table(options.output, rows_of_sweep(solved()), "the designs", console)
            else:
                deque(solved(), maxlen=0)
        except STOPS as error:
            raise NotSolved(f"{name}: {error}") from error
    console.show(summary.parts)
    for note in summary.notes:
        (console.warn if note.warns else console.note)(f"{name}: {note.told(summary.tried)}")
    for line in summary.failed_lines if console.mute else ():
        console.complain(f"{name}: {line}")
    return ExitStatus.NO_VERDICT if summary.failed else ExitStatus.AGREE


def _sampled(scene: Scene, samples: int) -> Scene:
    """The scene with another number of instants."""
    return scene.model_copy(update={"time": {**scene.time.model_dump(), "samples": samples}})


def _designs(scene: Scene, options: argparse.Namespace) -> pc.Designs:
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
    return pc.grid_of(scene, offsets=varied)


def _designs_of_file(scene: Scene, path: str) -> pc.Designs:
    """A design for each row of a table."""
    name, text = shown(path), text_of(read_file(path, "a CSV file"))
    rows = lines_of(text or "").rows
    if len(rows) < 2:
        raise WrongArgument(name, "has no designs", "a line of names, then a line of numbers for each design")
    (first, head), *lines = rows
    header = [cell.removesuffix(" [mm]") for cell in joined(head)]
    for column in header:
        try:
            point = len(coordinates_named(column, scene.mechanism.topology.points)) > 1
            problem = ", which is a point" if point else " twice" if header.count(column) > 1 else ""
        except pc.UnknownName as error:
            problem = f": {error}"
        if problem:
            where = f"has the column {shown(column)!r}{problem}"
            raise WrongArgument(f"{name}: line {first}", where, "columns such as strut_top.z, each once")
    for line, row in lines:
        if len(row) != len(header):
            found = f"has {counted_as(len(row), 'number')}"
            raise WrongArgument(f"{name}: line {line}", found, f"{len(header)}, as names")
    values = np.array([finite(f"{name}: line {line}", row, "finite numbers, mm") for line, row in lines])
    return pc.designs_of(scene, {column: values[:, i] for i, column in enumerate(header)})


def run_sensitivity(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Print or write the derivatives of the numbers by hardpoints, and the spreads of the numbers."""
    target, ending = options.output, Path(options.output).suffix
    if ending in PICTURES:
        needed("sensitivity", "matplotlib")
    random = np.random.default_rng(options.seed)
    with named_scene(options.scene) as (scene, name), console.progress(f"solving {name}"):
        scene = _sampled(scene, min(SAMPLES, scene.time.samples)).model_copy(update={"effects": ()})
        numbers = numbers_asked(scene, name, options.number, RANKED_FIRST)
        numbers = numbers or numbers_asked(scene, name, None, None)
        called = [number.called for number in numbers]
        scene = asking_for(scene, numbers)
        pc.simulate(scene)  # a car that cannot move has one error, not one for each coordinate
        found = pc.sensitivity(scene, called, options.point)
        offsets = {one: random.normal(0.0, options.tolerance, DESIGNS) for one in found.coordinates}
        designs = pc.sweep(scene, offsets=offsets)
    console.warn(*(f"{one} has no derivative: {why}" for one, why in found.failures.items()), of=name)
    order = np.argsort(-np.abs(found.largest(called[0])), kind="stable")
    coordinates = [found.coordinates[place] for place in order]
    changes, spreads = {}, []
    for number, array in zip(numbers, numbers_named(designs.numbers, called).values(), strict=True):
        changes[number.headed("/mm")] = number.factor * found.largest(number.called)[order]
        deviation, worst = found.spread(number.called, options.tolerance)
        solved = array[designs.solved]
        known = solved[:, np.isfinite(solved).any(axis=0)]
        # At the instant where it is largest.
        drawn = float(np.nanstd(known, axis=0).max()) if known.size else np.nan
        spread = (_shown(abs(number.factor) * one, ".4f") for one in (deviation, drawn, worst))
        spreads.append((number.headed(), *spread))
    if ending in PICTURES:
        console.put(target, _picture(coordinates, changes, name, ending), "the picture")
    elif target != "-":
        rows = zip(coordinates, *(each.tolist() for each in changes.values()), strict=True)
        console.put(target, csv_of(("hardpoint", *changes), rows), "the table")
    else:
        texts = ([_shown(change, "z.5f") for change in each[:ROWS]] for each in changes.values())
        first = Table(("hardpoint", *changes), tuple(zip(coordinates[:ROWS], *texts, strict=True)))
        rest = len(coordinates) - ROWS
        more = [f"{rest} more coordinates: -o FILE.csv has all"] if rest > 0 else []
        moved = f"by {options.tolerance:g} mm of each"
        head = (moved, "standard deviation", f"of {DESIGNS} designs", "worst case")
        parts: list[Part] = [first, *more, "", Table(head, tuple(spreads)), ""]
        console.put(target, text_for(sys.stdout, parts), "the table")
    return ExitStatus.NO_VERDICT if found.failures else ExitStatus.AGREE


def _shown(number: float, form: str) -> str:
    return "none" if np.isnan(number) else format(number, form)


def _picture(coordinates: Sequence[str], changes: Mapping[str, Array], name: str, ending: str) -> bytes:
    """A panel for each number, with a bar for each of the first coordinates."""
    # Imported here: matplotlib takes a second.
    from matplotlib import rc_context

    from validate.output.figure import BLUE, SETTINGS, drawn, panels

    first = coordinates[:ROWS][::-1]
    with rc_context(SETTINGS):
        size = (2.2 * len(changes) + 1.4, 0.18 * len(first) + 1.0)
        title = f"{name}: change by each hardpoint, per mm"
        page, grid = panels(size, title, 1, len(changes), sharey=True)
        for axes, (number, each) in zip(grid, changes.items(), strict=True):
            axes.barh(first, each[:ROWS][::-1], color=BLUE)
            axes.set_xlabel(number)
        return drawn(page, ending)


WORDS = {"samples": SAMPLES, "designs": DESIGNS, "rows": ROWS, "ranked": ", ".join(RANKED_FIRST)}
COMMANDS = {"sweep": Command(run_sweep), "sensitivity": Command(run_sensitivity, WORDS)}
