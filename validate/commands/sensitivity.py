"""`pointcoord sensitivity`: the derivatives of a car's numbers by its hardpoints, and their tolerances."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pointcoord import sensitivity, sweep
from pointcoord.effects.numbers import RANKED_FIRST
from pointcoord.sweeping.sensitivity import numbers_named
from validate.arrays import Array
from validate.commands.pages import Command
from validate.commands.usage import named_scene, require_results
from validate.curves.numbers import asking_for, numbers_asked
from validate.exit_status import ExitStatus
from validate.extras import needed
from validate.output.console import Console
from validate.output.table import Table, csv_of, text_for

PICTURES = (".svg", ".png")
ENDINGS = (".csv", *PICTURES)
ROWS = 15
SAMPLES = 11
DESIGNS = 400


@dataclass(frozen=True)
class Column:
    """A number of the car, and its derivatives by the coordinates, in the order of the rows.

    Attributes:
        name: as shown, with a minus sign if the scene's convention reverses its sign.
        unit: as shown; angles in degrees.
        changes: derivative by each of the C coordinates, (C,), unit/mm, at the instant where it is largest.
        spreads: spread of the number under the tolerance: standard deviation to first order, standard
            deviation of the random designs, worst case.
    """

    name: str
    unit: str
    changes: Array
    spreads: tuple[float, ...]


def run(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Print or write the derivatives and the spreads."""
    target = require_results(options, console, ("-o",), (options.scene,), ENDINGS, says=False)
    ending = Path(target).suffix
    if ending in PICTURES:
        needed("sensitivity", "matplotlib")
    random = np.random.default_rng(options.seed)
    with named_scene(options.scene) as (scene, name), console.progress(f"solving {name}", lines=False):
        time = {**scene.time.model_dump(), "samples": min(SAMPLES, scene.time.samples)}
        scene = scene.model_copy(update={"effects": (), "time": time})
        numbers = numbers_asked(scene, name, options.number, RANKED_FIRST)
        numbers = numbers or numbers_asked(scene, name, None, None)
        called = [number.called for number in numbers]
        scene = asking_for(scene, numbers)
        found = sensitivity(scene, called, options.point)
        offsets = {one: random.normal(0.0, options.tolerance, DESIGNS) for one in found.coordinates}
        designs = sweep(scene, offsets=offsets)
    console.warn(*(f"{one} has no derivative: {why}" for one, why in found.failures.items()), of=name)
    order = np.argsort(-np.abs(found.largest(called[0])), kind="stable")
    columns = []
    for number, array in zip(numbers, numbers_named(designs.numbers, called).values(), strict=True):
        deviation, worst = found.spread(number.called, options.tolerance)
        drawn = float(np.nanstd(array[designs.solved], axis=0).max())  # at the instant where it is largest
        spreads = tuple(abs(number.factor) * spread for spread in (deviation, drawn, worst))
        changes = number.factor * found.largest(number.called)[order]
        columns.append(
            Column(f"{'-' if number.minus else ''}{number.called}", number.unit_shown, changes, spreads)
        )
    coordinates = [found.coordinates[place] for place in order]
    if ending in PICTURES:
        console.put(target, _picture(coordinates, columns, name, ending), "the picture")
    else:
        console.put(target, _text(coordinates, columns, target, options.tolerance), "the table")
    return ExitStatus.NO_VERDICT if found.failures else ExitStatus.AGREE


def _text(coordinates: Sequence[str], columns: Sequence[Column], target: str, tolerance: float) -> str:
    """CSV with a row for each coordinate; for `-`, text with the first rows and the spreads."""
    head = ("hardpoint", *(f"{one.name} [{one.unit}/mm]" for one in columns))
    if target != "-":
        return csv_of(head, zip(coordinates, *(one.changes.tolist() for one in columns), strict=True))
    texts = ([f"{change:z.5f}" for change in one.changes[:ROWS]] for one in columns)
    table = Table(head, tuple(zip(coordinates[:ROWS], *texts, strict=True)))
    made = Table(
        (f"by {tolerance:g} mm of each", "standard deviation", f"of {DESIGNS} designs", "worst case"),
        tuple((f"{one.name} [{one.unit}]", *(f"{spread:.4f}" for spread in one.spreads)) for one in columns),
    )
    rest = len(coordinates) - ROWS
    more = [f"{rest} more coordinates: -o FILE.csv has all"] if rest > 0 else []
    return text_for(sys.stdout, [table, *more, "", made, ""])


def _picture(coordinates: Sequence[str], columns: Sequence[Column], name: str, ending: str) -> bytes:
    """A panel for each number, with a bar for each of the first coordinates."""
    # Imported here: matplotlib takes a second.
    from matplotlib import rc_context

    from validate.output.figure import BLUE, SETTINGS, drawn, panels

    first = coordinates[:ROWS][::-1]
    with rc_context(SETTINGS):
        size = (2.2 * len(columns) + 1.4, 0.18 * len(first) + 1.0)
        title = f"{name}: change by each hardpoint, per mm"
        page, grid = panels(size, title, 1, len(columns), sharey=True)
        for axes, one in zip(grid, columns, strict=True):
            axes.barh(first, one.changes[:ROWS][::-1], color=BLUE)
            axes.set_xlabel(f"{one.name}, {one.unit}/mm")
        return drawn(page, ending)


WORDS = {"samples": SAMPLES, "designs": DESIGNS, "rows": ROWS, "ranked": ", ".join(RANKED_FIRST)}
COMMANDS = {"sensitivity": Command(run, WORDS)}
