"""Numbers under another's name: of another point or angle, of the other side, of another quantity."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

import numpy as np

from pointcoord.effects.registry import QUANTITIES
from validate.diagnosis.evidence import Evidence, Row
from validate.diagnosis.hypothesis import Hypothesis, WouldBe


def swapped(evidence: Evidence) -> Iterator[Hypothesis]:
    """Two quantities in each other's place, such as velocities and accelerations."""
    for one, two in combinations(sorted(evidence.wrong_quantities), 2):
        partner = {one: two, two: one}
        others = {r: (partner[r[0]], r[1]) for r in evidence.wrong if r[0] in partner}
        # A joint may have a vector and a number of the car under its name.
        rows = {
            r: (evidence.held[o], evidence.allowed[o])
            for r, o in others.items()
            if o in evidence.held and evidence.held[o].shape == evidence.held[r].shape
        }
        words = f"{QUANTITIES[one].words} is swapped with {QUANTITIES[two].words}"
        yield Hypothesis((one, two), words, rows, cost=1.1)


def sides_exchanged(evidence: Evidence) -> Iterator[Hypothesis]:
    """What two parts of a car have, each under the other's names."""
    for one, two in combinations(evidence.scene.mechanism.topology.sides, 2):
        other = {one: two, two: one}
        rows: dict[Row, WouldBe] = {}
        for row in evidence.held:
            part, dot, name = row[1].partition(".")
            theirs = (row[0], f"{other[part]}.{name}") if dot and part in other else row
            if theirs in evidence.held:
                rows[row] = evidence.held[theirs], evidence.allowed[theirs]
        yield Hypothesis(
            (one, two), f"what is of {one} stands under {two}, and the other way", rows, whole=True
        )


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
