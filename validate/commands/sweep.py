"""`pointcoord sweep`: many designs of one suspension, solved together."""

from __future__ import annotations

import argparse
import csv
import io
from collections.abc import Iterator
from dataclasses import dataclass

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
from pointcoord.toml_text import read_file
from validate.commands.usage import (
    add_json,
    add_output,
    add_quiet,
    add_scene,
    add_timings,
    leave_output_to,
    load_scene,
    name_of,
    require_target,
    told_as,
)
from validate.errors import UsageError
from validate.exit_status import ExitStatus
from validate.output.console import Console
from validate.output.document import Head, Journal
from validate.output.files import require_known_ending, require_writable
from validate.output.motion_tables import require_writer
from validate.output.progress import Told, progress
from validate.output.sweep_summary import Summary
from validate.output.sweep_tables import ENDINGS, write_csv, write_sweep
from validate.plain_text import shown

Array = NDArray[np.float64]

DESCRIPTION = """\
Solve many designs of a scene's suspension together by point coordinates: every combination of
what --vary gives, or the designs of a table. A design that cannot be solved is marked with its
reason and disturbs no other. Says how many were solved, why the others were not, and how far
the results range; -o writes every number.

  --vary lower_ball_joint.z=-5:5:11        11 values, 5 mm below to 5 mm above the drawing
  --vary lower_ball_joint.z=-5,0,2.5       these offsets from the drawing, mm
  --vary lower_ball_joint.z==250:260:11    the same by where the point is drawn, mm
  --vary lower_ball_joint.z=normal:0.5     drawn at random about the drawing, standard deviation
  --vary lower_ball_joint.z=uniform:0.5    or evenly to either side; both with --count

A rack_centre that is drawn where tie_rod_inner is goes along with it, unless it is varied
itself. Designs are numbered from 0. Ends with 3 if a design could not be solved."""

EXAMPLES = (
    "POINT.AXIS=START:STOP:COUNT, =A,B,C, =normal:SIGMA or =uniform:HALF; == for places instead of offsets"
)
KINDS = ("normal", "uniform")
MOST_VALUES = 10_000_000


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command with its options."""
    parser = commands.add_parser(
        "sweep",
        help="solve many designs of a suspension together",
        description=DESCRIPTION,
    )
    add_scene(parser)
    parser.add_argument(
        "--vary",
        metavar="POINT.AXIS=VALUES",
        action="append",
        default=[],
        help="vary a coordinate; several make a grid, the last one changing from design to design",
    )
    parser.add_argument(
        "--designs",
        metavar="FILE.csv",
        help="a design for each row instead, with columns such as lower_ball_joint.z: where it is drawn, mm",
    )
    parser.add_argument("--count", metavar="N", type=_whole, help="how many designs at random")
    parser.add_argument(
        "--seed",
        metavar="K",
        type=_whole,
        help="of what is random; 0 if not given: the same designs each time",
    )
    add_output(
        parser,
        "FILE",
        f"every number, by the ending {' or '.join(ENDINGS)}; CSV on standard output for -",
    )
    parser.add_argument(
        "--instants",
        metavar="N",
        type=_whole,
        help="evenly over the scene's time, instead of its own samples",
    )
    parser.add_argument(
        "--memory",
        metavar="MB",
        type=float,
        default=256.0,
        help="what designs that are solved in one block may take; 256 if not given, whatever their number",
    )
    add_json(parser, "the summary")
    add_timings(parser)
    add_quiet(parser)
    parser.set_defaults(run=run)


def _whole(text: str) -> int:
    if not (text.isascii() and text.isdigit()):
        raise argparse.ArgumentTypeError(f"{shown(text)} is no whole number; allowed: 0, 1, 2 and so on")
    return int(text)


def run(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Solve the designs, write them as they come, and say what came of them.

    Raises:
        UsageError: the options do not go together, or a file has no name or ending.
        MissingPackage: Parquet needs pyarrow.
        SceneError, SweepError, UnknownName: the scene is wrong, or makes no designs.
        OutputError: a result cannot be written.
    """
    target = _target(options, console)
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
    journal = Journal(options.json, Head.of("sweep", options.command, options.timings), console)

    def data() -> dict[str, object]:
        return {"scene": name, **summary.data()}

    def finished() -> str:
        return f"{summary.tried} of {designs.count} designs"

    with journal.closing(data, lambda: summary.tried, finished) as ending:
        try:
            with progress(console, "designs", total=designs.count, lines=False) as told:
                blocks = _seen(sweep_blocks(designs, memory=1e6 * options.memory), summary, told)
                if options.output == "-":
                    write_csv(console, blocks)
                elif target is not None:
                    write_sweep(target, blocks, designs.count)
                else:
                    for _ in blocks:
                        pass
        except (SceneError, SweepError, UnknownName):
            raise
        except PointcoordError as error:
            console.complain(f"{name}: {error}")
            ending.status = ExitStatus.NO_VERDICT
            return ending.status
        if target is not None:
            console.written = [f"{target} holds the designs"]
        console.say("\n".join(summary.lines()))
        _comment(scene, name, summary, console)
        if summary.count_failed:
            ending.status = ExitStatus.NO_VERDICT
    return ending.status


def _target(options: argparse.Namespace, console: Console) -> str | None:
    """The file that `-o` names, found to be writable before anything is solved; None if there is none."""
    if options.output == options.json == "-":
        raise UsageError("-o - and --json - both take standard output; give one of them a file")
    advice = "use --quiet, with -o FILE or --json FILE"
    leave_output_to((options.output, options.json), options, console, advice)
    target: str | None = None if options.output == "-" else options.output
    inputs = tuple(file for file in (options.scene, options.designs) if file)
    require_target(target, "-o", inputs)
    require_target(None if options.json == "-" else options.json, "--json", inputs)
    if target is not None:
        require_known_ending(target, ENDINGS)
        require_writer(target)
        require_writable(target)
    return target


def _seen(blocks: Iterator[Sweep], summary: Summary, told: Told) -> Iterator[Sweep]:
    """The blocks, each taken into the summary on its way."""
    for block in blocks:
        summary.add(block)
        told("designs", summary.tried)
        yield block


def _comment(scene: Scene, name: str, summary: Summary, console: Console) -> None:
    """Warn and note what is true of designs, a line for each kind; of failures, where nothing else tells."""
    for note in summary.notes:
        (console.warn if note.warns else console.note)(f"{name}: {note.told(summary.tried)}")
    if console.mute:
        for reason, (count, first) in summary.failures.items():
            many = f"{count} of {summary.tried} designs failed, {reason}"
            console.complain(f"{name}: {many}; design {first.design} for one: {first.error}")


@dataclass(frozen=True)
class _Vary:
    """One `--vary`, read: values, or the kind and the size of what is random."""

    coordinate: str
    offsets: bool
    values: Array
    kind: str = ""


def _designs(scene: Scene, options: argparse.Namespace) -> Designs:
    """What the command line asks for.

    Raises:
        UsageError: it asks for nothing, or for two things at once.
        SweepError, UnknownName: it is not written as it must be.
    """
    if bool(options.vary) == bool(options.designs):
        problem = "both --vary and --designs" if options.vary else "nothing varies"
        raise UsageError(f"{problem}; give --vary {EXAMPLES}, once or more, or --designs FILE.csv")
    varied = [_read(text) for text in options.vary]
    random = [one for one in varied if one.kind]
    if not random and (options.count is not None or options.seed is not None):
        raise UsageError("--count and --seed are for what is random: --vary POINT.AXIS=normal:SIGMA")
    if options.designs:
        return _designs_of_file(scene, options.designs)
    for i, one in enumerate(varied):
        if one.coordinate in (other.coordinate for other in varied[:i]):
            raise SweepError(f"--vary {shown(one.coordinate)}", "is given twice", "once")
        if "." not in one.coordinate:
            allowed = ", ".join(f"{one.coordinate}.{axis}" for axis in "xyz")
            designs_of(scene, {one.coordinate: np.zeros(3)})  # a point that is none says so
            raise SweepError(f"--vary {shown(one.coordinate)}", "names no coordinate", allowed)
    if random:
        if len(random) < len(varied):
            raise UsageError("--vary gives random values and a grid at once; give either")
        return _at_random(scene, varied, options)
    places, offsets = (
        {one.coordinate: one.values for one in varied if one.offsets is relative}
        for relative in (False, True)
    )
    ordered = grid_of(scene, places, offsets)
    # In the order of the command line, whichever are offsets.
    values = {one.coordinate: ordered.columns[one.coordinate].values for one in varied}
    return grid_of(scene, values)


def _at_random(scene: Scene, varied: list[_Vary], options: argparse.Namespace) -> Designs:
    if not options.count:
        raise UsageError("how many designs at random? give --count N, 1 or more")
    if options.count > MOST_VALUES:
        raise UsageError(f"--count is {options.count}; allowed: 1 to {MOST_VALUES}")
    generator = np.random.default_rng(options.seed or 0)
    offsets = {}
    for one in varied:
        size = float(one.values[0])
        drawn = (
            generator.normal(0.0, size, options.count)
            if one.kind == "normal"
            else generator.uniform(-size, size, options.count)
        )
        offsets[one.coordinate] = drawn
    return designs_of(scene, offsets=offsets)


def _read(text: str) -> _Vary:
    """One `--vary`.

    Raises:
        SweepError: it is not written as it must be.
    """
    what = f"--vary {shown(text)}"
    coordinate, equals, values = text.partition("=")
    offsets = not values.startswith("=")
    values = values.removeprefix("=")
    coordinate = coordinate.strip()
    if not coordinate or not equals or not values.strip():
        raise SweepError(what, "has no values", EXAMPLES)
    kind, _, size = values.partition(":")
    if kind.strip() in KINDS:
        if not offsets:
            raise SweepError(what, "is random about a place", "random about the drawing, with one =")
        spread = _numbers(what, [size])
        if not spread[0] >= 0.0:
            raise SweepError(what, f"spreads by {spread[0]:g} mm", "0 or more")
        return _Vary(coordinate, True, spread, kind.strip())
    parts = values.split(":")
    if len(parts) == 1:
        return _Vary(coordinate, offsets, _numbers(what, values.split(",")))
    if len(parts) != 3:
        raise SweepError(what, f"has {len(parts)} parts between colons", "START:STOP:COUNT")
    count = parts[2].strip()
    if not (count.isascii() and count.isdigit() and 1 <= int(count) <= MOST_VALUES):
        raise SweepError(what, f"has the count {shown(count)!r}", f"a whole number, 1 to {MOST_VALUES}")
    start, stop = _numbers(what, parts[:2]).tolist()
    if int(count) == 1 and start != stop:
        raise SweepError(
            what, "has one value from one number to another", "START = STOP, or a count of 2 or more"
        )
    return _Vary(coordinate, offsets, np.linspace(start, stop, int(count)))


def _numbers(what: str, texts: list[str]) -> Array:
    """Finite numbers from their texts."""
    found = []
    for text in texts:
        try:
            number = float(text)
        except ValueError:
            raise SweepError(what, f"has {shown(text)!r} for a number", "numbers, in mm") from None
        if not np.isfinite(number):
            raise SweepError(what, f"has the number {number}", "finite numbers, in mm")
        found.append(number)
    return np.array(found)


def _designs_of_file(scene: Scene, path: str) -> Designs:
    """A design for each row of a table.

    Raises:
        SceneError: the file cannot be read.
        SweepError: it is not written as it must be.
        UnknownName: a column names no coordinate.
    """
    name = shown(path)
    try:
        text = read_file(path, "a CSV file").decode("utf-8-sig")
    except UnicodeDecodeError:
        raise SweepError(name, "is no text in UTF-8", "CSV in UTF-8") from None
    try:
        rows = [(number, row) for number, row in enumerate(csv.reader(io.StringIO(text)), 1) if any(row)]
    except csv.Error as error:
        raise SweepError(name, f"is no CSV: {error}", "CSV in UTF-8") from None
    if len(rows) < 2:
        raise SweepError(name, "has no designs", "a line of names, then a line of numbers for each design")
    header = [cell.strip().removesuffix(" [mm]") for cell in rows[0][1]]
    for i, column in enumerate(header):
        if "." not in column:
            raise SweepError(
                f"{name}: line {rows[0][0]}",
                f"has the column {shown(column)!r}",
                "columns such as strut_top.z",
            )
        if column in header[:i]:
            raise SweepError(f"{name}: line {rows[0][0]}", f"has the column {shown(column)!r} twice", "once")
    values = np.empty((len(rows) - 1, len(header)))
    for place, (line, row) in enumerate(rows[1:]):
        if len(row) != len(header):
            raise SweepError(
                f"{name}: line {line}", f"has {len(row)} numbers", f"as many as names, {len(header)}"
            )
        values[place] = _numbers(f"{name}: line {line}", row)
    return designs_of(scene, {column: values[:, i] for i, column in enumerate(header)})
