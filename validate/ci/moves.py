"""What moved since a baseline, as text for people and as plain data for machines."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict
from typing import Any

from validate.ci.baseline import Baseline, Move, Since
from validate.output.report import about, heading, with_unit
from validate.output.table import Cell, Part, Table

NAMED = 8  # numbers in a sentence: the table's notes have them all
ORDER = ("agrees", "not tested", "moved")
ALONE = {"new": "not in the baseline", "gone": "in the baseline and not given now"}


def worst_moves(since: Since) -> list[Move]:
    """For each formulation and quantity the move that uses most of its bound, or exceeds it the most."""
    worst: dict[tuple[str, str], Move] = {}
    for move in since.moves:
        if move.verdict in ALONE:
            continue
        key = (move.formulation, heading(move.quantity, move.name))
        if key not in worst or _severity(move) > _severity(worst[key]):
            worst[key] = move
    return list(worst.values())


def _severity(move: Move) -> tuple[int, float]:
    return ORDER.index(move.verdict), 0.0 if math.isnan(move.share) else move.share


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
    rows = [_row(since.scene, move) for since in found for move in worst_moves(since)]
    head = ("scene", "solved by", "quantity", "worst at", "moved", "bound", "at", "moved / bound", "verdict")
    return Table(head, tuple(rows[:most]))


def _row(scene: str, move: Move) -> tuple[str | Cell, ...]:
    return (
        scene,
        move.formulation,
        heading(move.quantity, move.name),
        move.name,
        with_unit(move.moved, move.unit),
        with_unit(move.bound, move.unit),
        f"{move.instant:.4g} s",
        with_unit(move.share, ""),
        Cell("MOVED", verdict="moved") if move.verdict == "moved" else move.verdict,
    )


def _alone(since: Since) -> Iterator[str]:
    """Which numbers only the baseline or only this run has."""
    shared = {move.formulation for move in since.moves if move.verdict not in ALONE}
    for verdict, words in ALONE.items():
        by_formulation: dict[str, list[str]] = {}
        for move in since.moves:
            if move.verdict == verdict:
                what = about(move.quantity, move.name)
                by_formulation.setdefault(move.formulation, []).append(what)
        for formulation, whats in by_formulation.items():
            what = ", ".join(whats) if formulation in shared else "every number"
            yield f"{verdict}, {words}: {what} by {formulation}"


def lost_lines(since: Since) -> Iterator[str]:
    """What of a scene was given then and is not now, a line for each formulation."""
    by_formulation: dict[str, list[str]] = {}
    for move in since.lost:
        by_formulation.setdefault(move.formulation, []).append(about(move.quantity, move.name))
    for formulation, whats in by_formulation.items():
        more = f" and {len(whats) - NAMED} more" if len(whats) > NAMED else ""
        yield f"{since.scene}: {', '.join(whats[:NAMED])}{more} by {formulation}"


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
                "moves": [asdict(move) for move in since.moves],
            }
            for since in found
        ],
        "gone": list(gone),
    }
