"""The data files of a page: JSON with everything, CSV with a line for each number."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict, fields

from validate.comparison.compare import Comparison
from validate.html.run import Run
from validate.output.document import json_text
from validate.output.table import csv_of
from validate.published.tables import MODELS, Published

WORDS = {
    "results.json": "the run, as --json writes it",
    "comparisons.csv": "a line for each point, body or angle that was compared",
    "numbers.csv": "a line for each compared number of the file of results, with the computed number",
    "published.csv": "a line for each number of other programs' tables",
    "hard.json": "the hard cases, as pointcoord hard --json writes them",
    "cost.json": "run time against accuracy, with all measurements",
}
"""Every data file that a report may have, and what it contains."""
# Headers of the CSV files; those of comparisons.csv are the fields of `Comparison`.
NUMBERS = ("row", "over", "at", "column", "is", "unit", "given", "ours", "difference", "held_to")
PUBLISHED = ("table", "over", "at", "quantity", "name", "unit", "printed", *MODELS)


def data_files(run: Run) -> Mapping[str, str]:
    """Names and contents of the data files of a run."""
    files = {"results.json": json_text(run.document)}
    if run.record.examined:
        rows = (asdict(row).values() for outcome in run.record.outcomes for row in outcome.rows)
        files["comparisons.csv"] = csv_of((field.name for field in fields(Comparison)), rows)
    if run.record.files:
        files["numbers.csv"] = csv_of(NUMBERS, _numbers(run))
    if run.published:
        files["published.csv"] = csv_of(PUBLISHED, _published(run.published))
    if run.hard is not None and run.head.kind != "hard":
        files["hard.json"] = json_text(run.hard.document)
    if run.cost is not None:
        files["cost.json"] = json_text(run.cost.data())
    return files


def _numbers(run: Run) -> Iterator[Iterable[object]]:
    """Numbers of a file of results, with the computed numbers and the tolerances."""
    for file in run.record.files.values():
        for i, (row, at) in enumerate(zip(file.rows, file.at.tolist(), strict=True)):
            for held in file.columns:
                what, allowed = held.series.meaning, run.record.factor * held.tolerance[i]
                values = (held.series.values[i], held.ours[i], held.gap[i], allowed)
                yield (row, file.over, at, held.series.column, what.words, what.unit, *map(float, values))


def _published(tables: Iterable[Published]) -> Iterator[Iterable[object]]:
    """Numbers of printed tables in the units of pointcoord, also of columns whose definition is not known."""
    for one in tables:
        for column in one.columns:
            row = column.rows[0]
            for at, printed, *ours in zip(one.at, column.printed, *column.ours, strict=True):
                what = (one.table.title, one.over, float(at), row.quantity, row.name, row.unit)
                yield (*what, float(printed), *map(float, ours))
