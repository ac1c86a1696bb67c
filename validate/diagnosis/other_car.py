"""Another car or motion: numbers of a scene that may be others, by least squares of the given numbers."""

from __future__ import annotations

import copy
from collections.abc import Callable, Hashable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pointcoord import Motion, Scene, simulate
from validate.diagnosis.evidence import Evidence, Row, kind_of, motion_of, numbers_in
from validate.diagnosis.hypothesis import Hypothesis
from validate.diagnosis.least import decimals_of, fitted

Array = NDArray[np.float64]
Content = dict[str, Any]
"""Of a scene, whose tables and lists are its own."""

FEW = 25  # instants that amounts are found from
ENOUGH_NUMBERS = 3  # of the car, of which one is left out: what one or two alone say fits much


@dataclass(frozen=True)
class Change:
    """A number of a scene that may be another one.

    Attributes:
        key: which it is. ours: what it is in the scene. step: of differences by it.
        put: puts another one into the scene's content.
        words: what is said of another one; empty where it is none that is meant.
    """

    key: Hashable
    ours: float
    step: float
    put: Callable[[Content, float], None]
    words: Callable[[float], str] = str


def other_motion(
    evidence: Evidence,
    key: Hashable,
    put: Callable[[Content], None],
    solve: Callable[[Scene], Motion] = simulate,
) -> Motion | None:
    """The motion of the scene with other content, solved once; None where there is none."""

    def solved() -> Motion | None:
        content = copy.deepcopy(evidence.solved.content)
        put(content)
        return motion_of(lambda: Scene.from_mapping(content, "another car"), solve)

    return evidence.solved.other(key, solved)


def motion_by(evidence: Evidence, changes: Sequence[Change], amounts: Sequence[float]) -> Motion | None:
    """The motion of the scene with some other numbers."""

    def put(content: Content) -> None:
        for change, amount in zip(changes, amounts, strict=True):
            change.put(content, amount)

    return other_motion(evidence, (*(change.key for change in changes), *amounts), put)


def amounts_of(
    evidence: Evidence, looked: Sequence[Row], changes: Sequence[Change], rounded: bool = True
) -> list[float] | None:
    """The numbers by which the motion gives those of some rows; see `fitted`."""
    few, ours = evidence.thinned(FEW), [change.ours for change in changes]
    theirs, off = few.joined(looked)
    if not np.isfinite(theirs).all():
        return None

    def read(sets: Array) -> Array:
        found = np.full((len(sets), len(theirs)), np.nan)
        for i, amounts in enumerate(sets.tolist()):
            if amounts == ours:
                found[i] = np.concatenate([few.held[row].ravel() for row in looked])
            elif motion := motion_by(evidence, changes, amounts):
                found[i] = numbers_in(motion.at(few.times).numbers, looked)
            else:
                break  # where there is no motion, slopes tell nothing
        return found

    found = fitted(read, ours, changes[0].step, theirs, off, rounded)
    return None if found is None else list(found.amounts.tolist())


def supposed(
    evidence: Evidence, changes: Sequence[Change], amounts: Sequence[float] | None
) -> Hypothesis | None:
    """The whole car with some other numbers; None where there are none, or it cannot be solved so."""
    said = [change.words(amount) for change, amount in zip(changes, amounts or (), strict=bool(amounts))]
    motion = motion_by(evidence, changes, amounts) if amounts and all(said) else None
    if motion is None:
        return None
    key, words = tuple(change.key for change in changes), " and ".join(said)
    count, decimals = len(changes), decimals_of(np.array(amounts))
    return Hypothesis(key, words, evidence.by(motion), count, 1.5 + count, decimals, whole=True)


def by_what_tells(
    evidence: Evidence, suppose: Callable[[Sequence[Row], bool], Sequence[Hypothesis]]
) -> Iterator[Hypothesis]:
    """Other cars that the numbers that tell most show; where none gives all of these, all but one of them.

    A number that has a fault of its own hides what the others say, and positions in another unit what angles
    do.

    Args:
        suppose: the likeliest by some numbers, and whether several changes at once are looked for: not where
            another fault is supposed already.
    """
    for looked in evidence.telling:
        found = suppose(looked, not evidence.parted)
        yield from found
        if any(gives(evidence, one, looked) for one in found):
            return
        by_themselves = not evidence.parted and all(kind_of(row) == "car" for row in looked)
        if by_themselves and len(looked) >= ENOUGH_NUMBERS:
            for others in combinations(looked, len(looked) - 1):
                yield from (one for one in suppose(others, False) if gives(evidence, one, others))


def gives(evidence: Evidence, one: Hypothesis, rows: Sequence[Row]) -> bool:
    """Whether a fault explains rows whole, and one of the whole car leaves right what agrees."""
    agree = [row for row in one.rows if row not in evidence.wrong] if one.whole else []
    return all(evidence.left(row, *one.rows[row]) <= 1.0 for row in (*rows, *agree))
