"""A file of results beside our numbers, as text for people and as plain data for machines."""

from __future__ import annotations

import math
from typing import Any

from pointcoord.effects.registry import QUANTITIES
from validate.comparison.compare import Comparison, counted
from validate.comparison.examined import Examined
from validate.measured.comparing import DataOutcome
from validate.output.report import (
    counted_as,
    examined_data,
    explained_lines,
    outcome_data,
    table,
    verdict_lines,
    verdict_of,
    worst_rows,
)
from validate.plain_text import shown

HEAD = ("quantity", "worst at", "difference", "held to", "at", "verdict")


def text_of(found: DataOutcome) -> str:
    """The table of a file: of each quantity the worst, and a row for each that the file does not give."""
    outcome = found.outcome
    file, ours = (solution.formulation for solution in outcome.solutions)
    rows = [(*_name(row), *_measured(row), row.place, verdict_of(row)) for row in worst_rows(outcome)]
    rows += [(words, "", "-", "-", "", "not given") for words in found.absent]
    over, count = shown(found.over), len(outcome.solutions[0].times)
    lines = [
        f"{outcome.scene}: {file} and {ours}, {counted_as(count, 'row')} over {over}",
        table(HEAD, rows),
        *verdict_lines(outcome),
        *(f"  note: {note}" for note in outcome.notes if note not in outcome.faults),
        *explained_lines(found.explanations),
        _sentence(found),
    ]
    return "\n".join(lines)


def _name(row: Comparison) -> tuple[str, str]:
    quantity = QUANTITIES[row.quantity]
    return (row.name, "") if quantity.of == "car" else (quantity.words, row.name)


def _measured(row: Comparison) -> tuple[str, str]:
    if math.isnan(row.difference):
        return "-", "-"
    unit, factor = row.unit, 1.0
    if unit.startswith("rad"):
        # Users read angles in degrees.
        unit, factor = unit.replace("rad", "deg", 1), math.degrees(1.0)
    return f"{factor * row.difference:.1e} {unit}", f"{factor * row.tolerance:.1e} {unit}"


def _sentence(found: DataOutcome) -> str:
    rows = found.outcome.rows
    verdicts = dict.fromkeys(row.verdict for row in rows)
    told = ", ".join(counted(sum(row.verdict == v for row in rows), v) for v in verdicts)
    return f"Of {len(rows)} that the file gives: {told}."


def examined_data_of(examined: Examined, found: DataOutcome) -> dict[str, Any]:
    """What came of a file and the scene that it is about, as plain data."""
    return examined_data(examined) | {"comparisons": [data_of(found)]}


def data_of(found: DataOutcome) -> dict[str, Any]:
    """The comparison as plain data; rows say where in the file they are worst."""
    data = outcome_data(found.outcome, found.explanations)
    return data | {"accuracy": found.accuracy, "over": found.over, "not_given": list(found.absent)}
