"""`pointcoord sensitivity`: the derivatives of a car's numbers by its hardpoints, and their tolerances."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from pointcoord import sensitivity, simulate, sweep
from pointcoord.effects.numbers import RANKED_FIRST
from pointcoord.sweeping.sensitivity import numbers_named
from validate.arrays import Array
from validate.commands.pages import Command
from validate.commands.usage import named_scene
from validate.curves.numbers import asking_for, numbers_asked
from validate.exit_status import ExitStatus
from validate.extras import needed
from validate.output.console import Console
from validate.output.table import Part, Table, csv_of, text_for

PICTURES = (".svg", ".png")
ROWS = 15
SAMPLES = 11
DESIGNS = 400


def run(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Print or write the derivatives and the spreads."""
    target, ending = options.output, Path(options.output).suffix
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
        simulate(scene)  # a car that cannot move has one error, not one for each coordinate
        found = sensitivity(scene, called, options.point)
        offsets = {one: random.normal(0.0, options.tolerance, DESIGNS) for one in found.coordinates}
        designs = sweep(scene, offsets=offsets)
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
        moved = f"by {options.tolerance:g} mm of each"
        head = (moved, "standard deviation", f"of {DESIGNS} designs", "worst case")
        parts = (*_first_rows(coordinates, changes), "", Table(head, tuple(spreads)), "")
        console.put(target, text_for(sys.stdout, parts), "the table")
    return ExitStatus.NO_VERDICT if found.failures else ExitStatus.AGREE


def _shown(number: float, form: str) -> str:
    return "none" if np.isnan(number) else format(number, form)


def _first_rows(coordinates: Sequence[str], changes: Mapping[str, Array]) -> Iterator[Part]:
    """The table of the first coordinates, and the number of the others."""
    texts = ([_shown(change, "z.5f") for change in each[:ROWS]] for each in changes.values())
    yield Table(("hardpoint", *changes), tuple(zip(coordinates[:ROWS], *texts, strict=True)))
    if (rest := len(coordinates) - ROWS) > 0:
        yield f"{rest} more coordinates: -o FILE.csv has all"


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
COMMANDS = {"sensitivity": Command(run, WORDS)}
