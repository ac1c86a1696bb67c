"""`pointcoord sensitivity`: which hardpoints the numbers of a car hang on, and what their tolerances make."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene, Sensitivity, sensitivity, sweep
from pointcoord.effects.registry import RANKED_FIRST, number_called
from pointcoord.sweeping.sensitivity import numbers_named
from validate.commands.table import meant_numbers
from validate.commands.usage import QUIET, SCENE, Command, load_scene, name_of, place_of_result, told_as
from validate.curves.numbers import Number, asking_for, by_path
from validate.exit_status import ExitStatus
from validate.extras import needed
from validate.output.console import Console
from validate.output.table import Table, csv_of
from validate.tables.units import degrees_of

Array = NDArray[np.float64]
Shown = tuple[str, str, float]
"""A number for people: its name, its unit, and how many of them its own is."""

ENDINGS = (".csv", ".md", ".svg", ".png")
PICTURES = (".svg", ".png")
ROWS = 15
SAMPLES = 11
DESIGNS = 400

DESCRIPTION = f"""\
Say how much the numbers of a car change for each mm by which a coordinate of a hardpoint moves, at
the one of {SAMPLES} instants of the motion where they change most. The coordinate that changes the
first number most comes first. Below, it says what a tolerance of all coordinates makes of each
number: the standard deviation if coordinates are independent, to first order and by {DESIGNS}
designs drawn at random, and the worst case. Without --number these are
{", ".join(RANKED_FIRST)},
as far as the car has them. A picture (SVG, PNG) has a bar for each coordinate."""

OPTIONS = f"""\
{SCENE}
-o --output FILE  where to, by its ending {", ".join(ENDINGS)}; the first {ROWS} rows in text if not given
--number NAME  a number of the car, or another as QUANTITY.NAME, such as rod_force.tie_rod; may be given again
--point NAME  a hardpoint or one of its coordinates, such as tie_rod_outer.z; may be given again
--tolerance MM  standard deviation of every coordinate, and its limit for the worst case; 1 if not given
--seed K  of the random designs; 0 if not given
{QUIET}"""
MORE: Mapping[str, Mapping[str, Any]] = {
    "--number": {"action": "append"},
    "--point": {"action": "append", "default": []},
    "--tolerance": {"default": 1.0},
    "--seed": {"default": 0},
}


def run(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Print or write the derivatives and the spreads."""
    target = place_of_result(options, ENDINGS, console)
    ending = "" if target is None else Path(target).suffix
    if ending in PICTURES:
        needed("sensitivity", "matplotlib", "plot")
    scene, name = load_scene(options.scene), name_of(options.scene)
    signs = meant_numbers(options.number, scene, name, RANKED_FIRST) or meant_numbers(None, scene, name, None)
    chosen, paths = [*signs], by_path(scene)
    shown_as = {number: _shown(number, sign, paths) for number, sign in signs.items()}
    time = {
        "start": scene.time.start,
        "stop": scene.time.stop,
        "samples": min(SAMPLES, scene.time.samples),
    }
    scene = asking_for(scene.model_copy(update={"effects": (), "time": time}), chosen)
    with told_as(name), console.progress(f"solving {name}", total=None, lines=False):
        found = sensitivity(scene, chosen, options.point)
        random = _by_designs(scene, found, options.tolerance, options.seed)
    for coordinate, why in found.failures.items():
        console.warn(f"{name}: {coordinate} has no derivative: {why}")
    order = np.argsort(-np.abs(found.largest(chosen[0])), kind="stable")
    if ending in PICTURES:
        console.put(target, _picture(found, shown_as, order, name, ending), "the picture")
    else:
        linear = {n: found.spread(n, options.tolerance) for n in chosen}
        spreads = {n: (deviation, random[n], worst) for n, (deviation, worst) in linear.items()}
        text = _text(found, shown_as, order, ending, options.tolerance, spreads)
        console.put(target, text, "the table")
    return ExitStatus.NO_VERDICT if found.failures else ExitStatus.AGREE


def _by_designs(scene: Scene, found: Sensitivity, tolerance: float, seed: int) -> dict[str, float]:
    """The standard deviation of each number over designs at random, where it is largest."""
    random = np.random.default_rng(seed)
    offsets = {one: random.normal(0.0, tolerance, DESIGNS) for one in found.coordinates}
    designs = sweep(scene, offsets=offsets)
    arrays = numbers_named(designs.numbers, [*found.derivatives])
    return {n: float(np.nanstd(array[designs.solved], axis=0).max()) for n, array in arrays.items()}


def _shown(number: str, sign: int, paths: Mapping[str, Number]) -> Shown:
    """A number, with a minus where it is to count the other way."""
    called = number_called(number)
    unit = paths[number].unit if called is None else called.quantity.unit
    factor, unit = degrees_of(unit)
    return f"{'-' if sign < 0 else ''}{number}", unit, sign * factor


def _text(
    found: Sensitivity,
    shown_as: Mapping[str, Shown],
    order: NDArray[np.intp],
    ending: str,
    tolerance: float,
    spreads: Mapping[str, tuple[float, float, float]],
) -> str:
    """A row for each coordinate, and what a tolerance makes."""
    head = ("hardpoint", *(f"{called} [{unit}/mm]" for called, unit, _ in shown_as.values()))
    columns = [found.largest(n)[order] * factor for n, (*_, factor) in shown_as.items()]
    names = [found.coordinates[place] for place in order]
    if ending == ".csv":
        return csv_of(head, zip(names, *(column.tolist() for column in columns), strict=True))
    shown = len(names) if ending else min(ROWS, len(names))
    rows = [(names[i], *(f"{round(column[i], 5) + 0.0:.5f}" for column in columns)) for i in range(shown)]
    made = Table(
        (f"by {tolerance:g} mm of each", "standard deviation", f"of {DESIGNS} designs", "worst case"),
        tuple(
            (
                f"{called} [{unit}]",
                *(f"{abs(factor) * spread:.4f}" for spread in spreads[n]),
            )
            for n, (called, unit, factor) in shown_as.items()
        ),
    )
    table = Table(head, tuple(rows))
    if ending:
        return "\n".join([table.markdown, "", made.markdown, ""])
    rest = [f"{len(names) - shown} more coordinates: -o FILE.csv has all", ""] if shown < len(names) else [""]
    return "\n".join([table.text, *rest, made.text, ""])


def _picture(
    found: Sensitivity, shown_as: Mapping[str, Shown], order: NDArray[np.intp], name: str, ending: str
) -> bytes:
    """A panel of bars for each number, a bar for each of the first coordinates."""
    # Imported here: matplotlib takes a second.
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    from validate.output.figure import BLUE, SETTINGS, drawn, plain

    first = order[:ROWS][::-1]
    with rc_context(SETTINGS):
        page = Figure(figsize=(2.2 * len(shown_as) + 1.4, 0.18 * len(first) + 1.0), layout="constrained")
        page.suptitle(f"{name}: change by each hardpoint, per mm", x=0.02, ha="left", fontsize=9.0)
        panels = page.subplots(1, len(shown_as), sharey=True, squeeze=False)[0]
        for axes, (number, (called, unit, factor)) in zip(panels, shown_as.items(), strict=True):
            axes.barh(
                [found.coordinates[i] for i in first], factor * found.largest(number)[first], color=BLUE
            )
            axes.set_xlabel(f"{called}, {unit}/mm")
            plain(axes)
        return drawn(page, ending.removeprefix("."))


COMMANDS = {"sensitivity": Command(DESCRIPTION, OPTIONS, run, MORE)}
