"""What moved since a baseline, as text for people and as plain data for machines."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

from validate.ci.baseline import Baseline, Move, Since
from validate.output.report import about, when, with_unit, worst_of
from validate.output.table import Cell, Part, Table
from validate.plain_text import gathered, some_of

NAMED = 8  # numbers in a sentence: the table's notes have them all
ALONE = {"new": "not in the baseline", "gone": "in the baseline and not given now"}
HEAD = ("scene", "solved by", "quantity", "worst at", "moved", "bound", "at", "moved / bound", "verdict")


def since_parts(since: Since) -> tuple[Part, ...]:
    """A scene against the baseline: a row for each formulation and quantity."""
    if since.standing != "compared":
        return (f"Since the baseline: {since.words}.",)
    table = moves_table([since])
    notes = (*((since.words,) if since.words else ()), *_alone(since))
    lines = (f"  note: {line}" for line in notes)
    return f"{since.scene}: since the baseline", *((table,) if table.rows else ()), *lines


def moves_table(found: Sequence[Since], most: int | None = None) -> Table:
    """What moved by how much: of each scene, formulation and quantity the worst."""
    return Table(HEAD, tuple(row for since in found for row in _rows(since))[:most])


def _rows(since: Since) -> Iterator[tuple[str | Cell, ...]]:
    """A row for each formulation and quantity: what uses most of its bound, or exceeds it the most."""
    compared = [move.row for move in since.moves if move.verdict not in ALONE]
    for formulation in dict.fromkeys(row.first for row in compared):
        for quantity, row in worst_of(row for row in compared if row.first == formulation).items():
            yield (
                since.scene,
                formulation,
                quantity,
                row.name,
                with_unit(row.difference, row.unit),
                with_unit(row.tolerance, row.unit),
                when(row, 4),
                with_unit(row.share, ""),
                Cell("MOVED", verdict="moved") if row.verdict == "disagrees" else row.verdict,
            )


def _by_formulation(moves: Iterable[Move]) -> dict[str, list[str]]:
    """What the numbers of each formulation are, in words."""
    return gathered((move.formulation, about(move.row.quantity, move.row.name)) for move in moves)


def _alone(since: Since) -> Iterator[str]:
    """Which numbers only the baseline or only this run has."""
    shared = {move.formulation for move in since.moves if move.verdict not in ALONE}
    for verdict, words in ALONE.items():
        found = _by_formulation(move for move in since.moves if move.verdict == verdict)
        for formulation, whats in found.items():
            what = ", ".join(whats) if formulation in shared else "every number"
            yield f"{verdict}, {words}: {what} by {formulation}"


def lost_lines(since: Since) -> Iterator[str]:
    """What of a scene was given then and is not now, a line for each formulation."""
    for formulation, whats in _by_formulation(since.lost).items():
        yield f"{since.scene}: {some_of(whats, NAMED)} by {formulation}"


def told_apart(found: Iterable[Since], gone: Sequence[str]) -> Iterator[str]:
    """What could not be held to the baseline, a line each: scenes, and numbers of scenes."""
    for since in found:
        if since.words:
            yield f"scene {since.words}"
        yield from (f"scene {since.scene}: {line}" for line in _alone(since))
    yield from (f"scene {name} is gone: it is in the baseline and not in this run" for name in gone)


def baseline_data(baseline: Baseline, found: Sequence[Since], gone: Sequence[str]) -> dict[str, Any]:
    """A run against its baseline as plain data."""
    return {
        "file": baseline.target,
        "program": baseline.program,
        "scenes": [
            {
                "scene": since.scene,
                "standing": since.standing,
                "words": since.words,
                "exit_status": since.status.value,
                "moves": [*map(_move_data, since.moves)],
            }
            for since in found
        ],
        "gone": list(gone),
    }


def _move_data(move: Move) -> dict[str, Any]:
    row = move.row
    return {
        "formulation": move.formulation,
        "quantity": row.quantity,
        "name": row.name,
        "unit": row.unit,
        "moved": row.difference,
        "bound": row.tolerance,
        "share": row.share,
        "instant": row.instant,
        "verdict": move.verdict,
    }
