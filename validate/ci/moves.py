"""What moved since a baseline, as text for people and as plain data for machines."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict
from typing import Any

from validate.ci.baseline import Baseline, Move, Since
from validate.output.report import about, heading, table

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


def since_text(since: Since) -> str:
    """A scene against the baseline: a row for each formulation and quantity."""
    if since.standing != "compared":
        return f"Since the baseline: {since.words}."
    rows = [
        (
            move.formulation,
            heading(move.quantity, move.name),
            move.name,
            *_numbers(move),
            "MOVED" if move.verdict == "moved" else move.verdict,
        )
        for move in worst_moves(since)
    ]
    head = ("formulation", "quantity", "worst at", "moved", "bound", "at", "moved / bound", "verdict")
    lines = [f"{since.scene}: since the baseline", *([table(head, rows)] if rows else [])]
    notes = (*((since.words,) if since.words else ()), *_alone(since))
    return "\n".join((*lines, *(f"  note: {line}" for line in notes)))


def _numbers(move: Move) -> tuple[str, ...]:
    share = f"{move.share:.1e}" if math.isfinite(move.share) else "not a number"
    moved = f"{move.moved:.1e} {move.unit}" if math.isfinite(move.moved) else "not a number"
    return moved, f"{move.bound:.1e} {move.unit}", f"{move.instant:.4g} s", share


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
