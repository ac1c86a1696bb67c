"""Another car or motion: one number of a scene that may be another, by least squares of the given numbers."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from pointcoord import Motion
from validate.diagnosis.evidence import Content, Evidence, Row, kind_of, numbers_in
from validate.diagnosis.hypothesis import Hypothesis
from validate.diagnosis.least import DECIMALS, decimals_of, fitted

Array = NDArray[np.float64]

FEW = 25  # instants that amounts are found from
ENOUGH_NUMBERS = 3  # of the car, of which one is left out: what one or two alone say fits much


@dataclass(frozen=True)
class Change:
    """A number of a scene that may be another one.

    Attributes:
        key: which it is. ours: what it is in the scene. step: of differences by it.
        put: puts another one into the scene's content.
        words: what is said of another one. cost: how far-fetched that is.
    """

    key: Hashable
    ours: float
    step: float
    put: Callable[[Content, float], None]
    words: Callable[[float], str]
    cost: float = 2.5


def motion_by(evidence: Evidence, change: Change, amount: float) -> Motion | None:
    """The motion of the scene with another number."""
    return evidence.solved.other((change.key, amount), lambda content: change.put(content, amount))


def amount_of(
    evidence: Evidence, looked: Sequence[Row], change: Change, slope: Array | None = None
) -> tuple[float, float] | None:
    """The number by which the motion gives those of some rows, and what it leaves; see `fitted`."""

    def read(amount: float) -> Array | None:
        motion = motion_by(evidence, change, amount)
        return None if motion is None else numbers_in(motion.at(evidence.times).numbers, looked)

    return fitted(read, change.ours, change.step, evidence.joined(looked), slope)


def supposed(evidence: Evidence, change: Change, amount: float) -> Hypothesis | None:
    """The whole car with another number; None where it cannot be solved so."""
    motion = motion_by(evidence, change, amount)
    if motion is None or amount == change.ours:
        return None
    # A hardpoint is drawn at a round number, and a link is off by one.
    decimals = min(decimals_of(amount), decimals_of(round(amount - change.ours, DECIMALS)))
    rows = evidence.by(motion)
    return Hypothesis(change.key, change.words(amount), rows, 1, change.cost, decimals, whole=True)


def any_of(evidence: Evidence, changes: Sequence[Change]) -> Iterator[Hypothesis]:
    """Each of some numbers by itself, by what tells most."""
    few = evidence.thinned(FEW)

    def suppose(looked: Sequence[Row]) -> list[Hypothesis]:
        fits = [(change, amount_of(few, looked, change)) for change in changes]
        found = (supposed(evidence, change, fit[0]) for change, fit in fits if fit)
        return [one for one in found if one]

    return by_what_tells(evidence, suppose)


def by_what_tells(
    evidence: Evidence, suppose: Callable[[Sequence[Row]], Sequence[Hypothesis]]
) -> Iterator[Hypothesis]:
    """Other cars that the numbers that tell most show; where none gives all of these, all but one of them.

    A number that has a fault of its own hides what the others say, and positions in another unit what angles
    do.
    """
    for looked in evidence.telling:
        found = suppose(looked)
        yield from found
        if any(gives(evidence, one, looked) for one in found):
            return
        if all(kind_of(row) == "car" for row in looked) and len(looked) >= ENOUGH_NUMBERS:
            for others in combinations(looked, len(looked) - 1):
                yield from (one for one in suppose(others) if gives(evidence, one, others))


def gives(evidence: Evidence, one: Hypothesis, rows: Sequence[Row]) -> bool:
    """Whether another car explains rows whole, and leaves right what agrees."""
    agree = (row for row in one.rows if row not in evidence.wrong)
    return evidence.explained({row: one.rows[row] for row in (*rows, *agree)})
