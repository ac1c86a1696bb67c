"""`pointcoord sweep`: many designs of one suspension, solved together."""

from __future__ import annotations

import argparse
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from pointcoord import (
    Designs,
    PointcoordError,
    Scene,
    SceneError,
    Sweep,
    SweepError,
    UnknownName,
    designs_of,
    grid_of,
    sweep_blocks,
)
from pointcoord.sweeping.designs import coordinates_named
from pointcoord.toml_text import read_file
from validate.commands.usage import (
    Command,
    load_scene,
    name_of,
    require_results,
    told_as,
)
from validate.commands.values import MOST_VALUES, finite, values_of
from validate.errors import UsageError
from validate.exit_status import ExitStatus
from validate.output.columns import ENDINGS, require_table, write_sweep, write_sweep_csv
from validate.output.console import Console
from validate.output.document import Head, Journal
from validate.output.progress import Told
from validate.output.sweep_summary import Summary
from validate.plain_text import shown
from validate.tables.cells import joined, lines_of, text_of

Array = NDArray[np.float64]

EXAMPLES = (
    "POINT.AXIS=START:STOP:COUNT, =A,B,C, =normal:SIGMA or =uniform:HALF, in finite mm; == for places, not "
    "offsets"
)
NORMAL = "normal"
KINDS = (NORMAL, "uniform")


def run(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Solve the designs, write them as they come, and say what came of them."""
    target, results = options.output, {"-o": options.output, "--json": options.json}
    require_results(results, (options.scene, options.designs), options, console, {"-o": ENDINGS})
    if target not in (None, "-"):
        require_table(target)
    name = name_of(options.scene)
    with told_as(name):
        scene = load_scene(options.scene)
        if options.instants is not None:
            time = {"start": scene.time.start, "stop": scene.time.stop, "samples": options.instants}
            scene = scene.model_copy(update={"time": time})
    designs = _designs(scene, options)
    if not options.memory > 0.0:
        raise UsageError(f"--memory is {options.memory:g} MB; allowed: more than 0")
    summary = Summary(designs.count, scene.mechanism.topology.wheel_centre)
    journal = Journal(
        options.json,
        Head.of("sweep", options.command, options.timings),
        console,
        lambda: {"scene": name, **summary.data()},
        lambda: f"{summary.tried} of {designs.count} designs" if summary.tried else "",
    )
    with journal.closing() as ending:
        try:
            with console.progress("designs", total=designs.count, lines=False) as told:
                blocks = _seen(sweep_blocks(designs, memory=1e6 * options.memory), summary, told)
                if target == "-":
                    write_sweep_csv(console, blocks)
                elif target is not None:
                    write_sweep(target, blocks)
                    console.written[target] = "the designs"
                else:
                    for _ in blocks:
                        pass
        except (SceneError, SweepError, UnknownName):
            raise
        except PointcoordError as error:
            console.complain(f"{name}: {error}")
            ending.status = ExitStatus.NO_VERDICT
            return ending.status
        console.show(summary.parts())
        for note in summary.notes:
            (console.warn if note.warns else console.note)(f"{name}: {note.told(summary.tried)}")
        if console.mute:
            for line in summary.failed_lines():
                console.complain(f"{name}: {line}")
        if summary.failures:
            ending.status = ExitStatus.NO_VERDICT
    return ending.status


def _seen(blocks: Iterator[Sweep], summary: Summary, told: Told) -> Iterator[Sweep]:
    """The blocks, each taken into the summary on its way."""
    for block in blocks:
        summary.add(block)
        told("designs", summary.tried)
        yield block


def _designs(scene: Scene, options: argparse.Namespace) -> Designs:
    """What the command line asks for."""
    if bool(options.vary) == bool(options.designs):
        problem = "both --vary and --designs" if options.vary else "nothing varies"
        raise UsageError(f"{problem}; give --vary {EXAMPLES}, once or more, or --designs FILE.csv")
    varied: dict[str, Array | tuple[str, float]] = {}
    for text in options.vary:
        coordinate, values = _read(text, scene)
        if coordinate in varied:
            raise SweepError(f"--vary {shown(coordinate)}", "is given twice", "once")
        varied[coordinate] = values
    random = {name: one for name, one in varied.items() if isinstance(one, tuple)}
    if not random and (options.count is not None or options.seed is not None):
        raise UsageError("--count and --seed are for what is random: --vary POINT.AXIS=normal:SIGMA")
    if options.designs:
        return _designs_of_file(scene, options.designs)
    if not random:
        return grid_of(scene, {name: one for name, one in varied.items() if not isinstance(one, tuple)})
    if len(random) < len(varied):
        raise UsageError("--vary gives random values and a grid at once; give either")
    count = options.count
    if count is None or count > MOST_VALUES:
        raise UsageError(f"how many designs at random? give --count N, 1 to {MOST_VALUES}")
    generator = np.random.default_rng(options.seed or 0)
    drawn = {
        name: generator.normal(0.0, size, count) if kind == NORMAL else generator.uniform(-size, size, count)
        for name, (kind, size) in random.items()
    }
    return designs_of(scene, offsets=drawn)


def _read(text: str, scene: Scene) -> tuple[str, Array | tuple[str, float]]:
    """The coordinate of one `--vary`, and where it is drawn, mm; of what is random its kind and its size."""
    what = f"--vary {shown(text)}"
    coordinate, _, values = text.partition("=")
    coordinate, offsets, values = coordinate.strip(), not values.startswith("="), values.removeprefix("=")
    if len(meant := coordinates_named(coordinate, scene.mechanism.topology.points)) > 1:
        raise SweepError(what, "names no coordinate", ", ".join(meant))
    kind, _, size = values.partition(":")
    if kind.strip() in KINDS:
        spread = float(finite(what, [size], EXAMPLES)[0])
        if not offsets or spread < 0.0:
            raise SweepError(what, "is no spread about the drawing", "0 mm or more, after one =")
        return coordinate, (kind.strip(), spread)
    places = values_of(what, values, EXAMPLES)
    if offsets:
        places = grid_of(scene, offsets={coordinate: places}).columns[coordinate].values
    return coordinate, places


def _designs_of_file(scene: Scene, path: str) -> Designs:
    """A design for each row of a table."""
    name, text = shown(path), text_of(read_file(path, "a CSV file"))
    rows = lines_of(text or "").rows
    if len(rows) < 2:
        raise SweepError(name, "has no designs", "a line of names, then a line of numbers for each design")
    (first, head), *lines = rows
    header = [cell.removesuffix(" [mm]") for cell in joined(head)]
    for column in header:
        if "." not in column or header.count(column) > 1:
            problem = f"has the column {shown(column)!r}{' twice' if '.' in column else ''}"
            raise SweepError(f"{name}: line {first}", problem, "columns such as strut_top.z, each once")
    for line, row in lines:
        if len(row) != len(header):
            raise SweepError(f"{name}: line {line}", f"has {len(row)} numbers", f"{len(header)}, as names")
    values = np.array([finite(f"{name}: line {line}", row, EXAMPLES) for line, row in lines])
    return designs_of(scene, {column: values[:, i] for i, column in enumerate(header)})


COMMANDS = {"sweep": Command(run)}
