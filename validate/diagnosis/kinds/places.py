"""Numbers in another's place: under another's name, of another quantity or side, or of another instant."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects.registry import QUANTITIES
from validate.diagnosis.evidence import Evidence, Row
from validate.diagnosis.hypothesis import Hypothesis, WouldBe

Array = NDArray[np.float64]


def _of_others(evidence: Evidence, others: Mapping[Row, Row]) -> dict[Row, WouldBe]:
    """Rows with the numbers of others, where these are there and have as many components."""
    held = evidence.held
    return {
        row: (held[other], evidence.allowed[other])
        for row, other in others.items()
        if other in held and held[other].shape == held[row].shape
    }


def swapped(evidence: Evidence) -> Iterator[Hypothesis]:
    """Two quantities in each other's place, such as velocities and accelerations."""
    for one, two in combinations(sorted(evidence.wrong_quantities), 2):
        partner = {one: two, two: one}
        rows = _of_others(evidence, {r: (partner[r[0]], r[1]) for r in evidence.wrong if r[0] in partner})
        words = f"{QUANTITIES[one].words} is swapped with {QUANTITIES[two].words}"
        yield Hypothesis((one, two), words, rows, cost=1.1)


def sides_exchanged(evidence: Evidence) -> Iterator[Hypothesis]:
    """What two parts of a car have, each under the other's names."""
    for one, two in combinations(evidence.scene.mechanism.topology.sides, 2):
        other = {one: two, two: one}
        parts = {row: row[1].partition(".") for row in evidence.held}
        others = {
            row: (row[0], f"{other[part]}.{name}") if dot and part in other else row
            for row, (part, dot, name) in parts.items()
        }
        words = f"what is of {one} stands under {two}, and the other way"
        yield Hypothesis((one, two), words, _of_others(evidence, others), whole=True)


def anothers(evidence: Evidence) -> Iterator[Hypothesis]:
    """A row with the numbers of another one of its quantity, such as the wheel centre's for the contact's.

    Of several that have these numbers, as toe and steer angle of a right wheel, one is enough: of its own
    name on another side, if there is one, or one that is given.
    """
    numbers = {**evidence.held, **evidence.not_given}
    for row in evidence.wrong:
        name = row[1].rpartition(".")[2]
        for other in sorted(numbers, key=lambda other: other[1].rpartition(".")[2] != name):
            if other[0] != row[0] or other == row:
                continue
            allowed = np.maximum(evidence.allowed[row], evidence.allowed.get(other, 0.0))
            if evidence.left(row, numbers[other], allowed) <= 1.0:
                rows = {row: (numbers[other], allowed)}
                yield Hypothesis((row, other), f"the numbers of {other[1]}", rows, cost=1.3)
                break


REVERSED = "its rows in the reverse order"
SAMPLES: Mapping[str, Callable[[Array], Array]] = {
    "one sample late, the first one twice": lambda x: np.concatenate([x[:1], x[:-1]]),
    "one sample early, the last one twice": lambda x: np.concatenate([x[1:], x[-1:]]),
    "one sample late, the last one first": lambda x: np.concatenate([x[-1:], x[:-1]]),
    "one sample early, the first one last": lambda x: np.concatenate([x[1:], x[:1]]),
    REVERSED: lambda x: x[::-1],
}
"""In words, and what is then given of numbers."""


def of_another_instant(evidence: Evidence) -> Iterator[Hypothesis]:
    """Every number is in the row after or before its own, or as far from the other end; or two are exchanged.

    What two wheels have in the reverse order, but for numbers that agree, each has of the other one.
    """
    two_wheels = bool(evidence.scene.mechanism.topology.sides)
    for words, moved in (*SAMPLES.items(), *_exchanged(evidence)):
        # Rows that agree as well, so that it is known whether they would under the fault.
        looked = (*evidence.wrong, *evidence.beside)
        rows = {row: (moved(evidence.held[row]), moved(evidence.allowed[row])) for row in looked}
        yield Hypothesis(words, words, rows, cost=1.2, whole=two_wheels and words == REVERSED)


def _exchanged(evidence: Evidence) -> Iterator[tuple[str, Callable[[Array], Array]]]:
    """Two rows that stand in each other's place, where no other row is wrong."""
    off = np.zeros(len(evidence.times), bool)
    for row in evidence.wrong:
        near = np.abs(evidence.given[row] - evidence.held[row]) <= evidence.off_by(row)
        off |= ~near.reshape(len(off), -1).all(axis=1)
    if np.count_nonzero(off) == 2:
        order = np.arange(len(off))
        order[off] = order[off][::-1]
        one, two = np.flatnonzero(off) + 1
        yield f"its rows {one} and {two} in each other's place", lambda numbers: numbers[order]
