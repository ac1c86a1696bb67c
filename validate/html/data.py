"""The data of a page as files beside it: JSON with everything, CSV with a line for each number."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict, fields

from validate.comparison.compare import Comparison
from validate.html.hard_cases import HardCases
from validate.html.run import Run
from validate.output.document import json_text
from validate.output.table import csv_of
from validate.published.tables import Published

RESULTS, COMPARISONS = "results.json", "comparisons.csv"
PUBLISHED, HARD_JSON, HARD_CSV = "published.csv", "hard.json", "hard.csv"
NUMBERS = "numbers.csv"
COST_JSON, COST_CSV = "cost.json", "cost.csv"
OF_COST = {
    "report.md": "the sentences and full tables",
    "rows.json": "everything that was measured",
    "table.csv": "a line for each way and setting",
}
"""What a study of cost writes itself, and what it holds."""
WORDS = {
    RESULTS: "the run, as --json writes it",
    COMPARISONS: "a line for each point, body or angle that was compared",
    NUMBERS: "a line for each number of the file of results that was compared, beside ours",
    PUBLISHED: "a line for each number of other programs' tables",
    HARD_JSON: "the hard cases, as pointcoord hard --json writes them",
    HARD_CSV: "a line for each answer of a hard case",
    COST_JSON: "what accuracy costs in time, with everything that was measured",
    COST_CSV: "a line for each way and setting",
}
"""Every file that a report may write beside its page, and what it holds."""


def data_files(run: Run) -> Mapping[str, str]:
    """Names and contents of what a run has; a study of cost writes its own beside its pictures."""
    if run.head.kind == "cost":
        return {}
    files = {RESULTS: json_text(run.document)}
    if run.record.examined:
        files[COMPARISONS] = csv_of(_head(Comparison), _comparisons(run))
    if run.record.files:
        names = ("row", "over", "at", "column", "is", "unit", "given", "ours", "difference", "held_to")
        files[NUMBERS] = csv_of(names, _numbers(run))
    if run.published:
        files[PUBLISHED] = csv_of(
            ("table", "over", "at", "quantity", "name", "unit", "printed", "computed"),
            _published(run.published),
        )
    if run.hard is not None:
        if run.head.kind != "hard":
            files[HARD_JSON] = json_text(run.hard.document)
        head = ("case", "value", "formulation", "outcome", "error", "bound", "unit", "reason")
        files[HARD_CSV] = csv_of(head, _hard(run.hard))
    if run.cost is not None:
        files[COST_JSON] = json_text(run.cost.data())
        files[COST_CSV] = run.cost.csv()
    return files


def _head(kind: type) -> tuple[str, ...]:
    return tuple(field.name for field in fields(kind))


def _comparisons(run: Run) -> Iterator[Iterable[object]]:
    return (asdict(row).values() for outcome in run.record.outcomes for row in outcome.rows)


def _numbers(run: Run) -> Iterator[Iterable[object]]:
    """Numbers of a file, and what they were held to in the comparison."""
    for file in run.record.files.values():
        for i, (row, at) in enumerate(zip(file.rows, file.at.tolist(), strict=True)):
            for held in file.columns:
                what, allowed = held.series.meaning, run.record.factor * held.tolerance[i]
                told = (held.series.values[i], held.ours[i], held.gap[i], allowed)
                yield (row, file.over, at, held.series.column, what.words, what.unit, *map(float, told))


def _published(tables: Iterable[Published]) -> Iterator[Iterable[object]]:
    for one in tables:
        outcome = one.found.outcome
        for row in outcome.rows:
            if row.verdict == "not given":
                continue
            sides = [s.numbers[row.quantity][row.name].reshape(len(s.times), -1) for s in outcome.solutions]
            for i, at in enumerate(outcome.solutions[0].times):
                for printed, computed in zip(sides[0][i], sides[1][i], strict=True):
                    what = (one.table.title, one.found.over, float(at), row.quantity, row.name, row.unit)
                    yield (*what, float(printed), float(computed))


def _hard(hard: HardCases) -> Iterator[Iterable[object]]:
    for case in hard.cases:
        for value, a in case.answers:
            yield case.name, value, a.formulation, a.outcome, a.error, a.bound, case.unit, a.reason
