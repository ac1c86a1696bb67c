"""`pointcoord validate --data` and `--tables`: numbers of other programs, compared with cars of scenes."""

from __future__ import annotations

import argparse
import os
from collections.abc import Iterator

from validate.ci.record import Record
from validate.ci.verdict import next_step
from validate.closed_drawing import closing_data, closing_of, warnings_of
from validate.commands.comparing import comparing
from validate.commands.usage import load_scene, name_of, named_scene, to_be_filled_in
from validate.comparison.examined import Examined
from validate.errors import UsageError
from validate.exit_status import ExitStatus
from validate.measured.comparing import OURS, compare_results
from validate.measured.mapping import FARTHEST, map_to_fill_in, read_results
from validate.output import report
from validate.output.console import Console
from validate.output.table import Cell, Part, Table
from validate.plain_text import counted_as, shown
from validate.published.tables import MODELS, NOT_HELD, Column, Published, compare_published, tables


def run_data(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Compare a file with a scene's car."""
    if len(options.scenes) != 1:
        given = f"{len(options.scenes)} scenes are" if options.scenes else "no scene is"
        raise UsageError(f"{given} given with --data; give the one scene that the file is about")
    if options.accuracy is not None and not 0.0 <= options.accuracy <= FARTHEST:
        raise UsageError(f"--accuracy is {options.accuracy}; allowed: a number from 0 to {FARTHEST:g}")
    (given,) = options.scenes
    if options.map is not None and not os.path.exists(options.map):
        return to_be_filled_in(options.map, map_to_fill_in(options.data, load_scene(given)), console)
    name = name_of(given)
    record = Record([name], options.tolerance_factor)
    with comparing(options, console, record) as compared, named_scene(given) as (scene, _):
        measured = read_results(options.data, options.map, scene)
        found = compare_results(measured, scene, name, options.accuracy, options.tolerance_factor)
        moved = closing_of(scene)
        examined = Examined(
            name=name,
            title=shown(scene.title),
            outcomes=(found.outcome,),
            solved=(OURS,),
            warnings=warnings_of(scene, moved),
            closing=closing_data(moved),
            defaults=scene.mechanism.defaults_taken,
        )
        record.files[name] = found
        compared.add(examined)
        console.warn(*examined.warnings, of=name)
        console.show(report.file_parts(found))
        if step := next_step(record):
            console.say(step)
    return compared.journal.status


def run_tables(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Compare every table that other programs printed, with both models."""
    record = Record([table.name for table in tables()])
    with comparing(options, console, record, "table") as compared:
        found = compare_published()
        for one in found:
            compared.add(Examined(one.table.name, one.table.title, one.outcomes, solved=MODELS))
            console.show((*_printed(one), ""))
        columns = [column for one in found for column in one.columns]
        held = [column for column in columns if not column.open]
        wrong = [f"{column.rows[0].first}, {column.name}" for column in held if column.verdict == "disagrees"]
        disagrees = f"disagrees: {'; '.join(wrong)}; " if wrong else ""
        console.say(
            f"{len(held) - len(wrong)} of {counted_as(len(held), 'printed column')} agree to the last digit; "
            f"{disagrees}{NOT_HELD}: {len(columns) - len(held)}."
        )
    return compared.journal.status


def _printed(one: Published) -> Iterator[Part]:
    """The comparison of a table's columns, its source and licence, notes, and columns left out."""
    table = one.table
    yield f"{table.title}: {counted_as(len(one.at), 'row')} over {one.over}"
    head = ("column", *MODELS, "allowed", "at", "verdict")
    yield Table(head, tuple(tuple(_cells(column)) for column in one.columns), indent=2)
    yield f"  source: {table.source}; licence: {table.licence}"
    yield from (f"  note: {note}" for note in one.outcomes[0].notes)
    if table.left_out:
        yield f"  left out: {table.left_out}"


def _cells(column: Column) -> Iterator[str | Cell]:
    """The largest difference of each model from a printed column, in the printed unit."""
    worst = max(column.rows, key=lambda row: row.share)
    yield column.name
    yield from (f"{row.difference / column.per:.2e}" for row in column.rows)
    yield f"{worst.tolerance / column.per:.2e} {column.unit}".rstrip()
    yield worst.place
    word = column.verdict.upper() if column.verdict == "disagrees" else column.verdict
    yield Cell(word, verdict=column.verdict)
