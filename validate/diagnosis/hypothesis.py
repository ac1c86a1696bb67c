"""A fault that somebody's numbers may have, and what the numbers would be if they had it."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from pointcoord import Motion
from validate.diagnosis.evidence import Evidence, Row, kind_of, numbers_in
from validate.diagnosis.least import decimals_of, fitted

Array = NDArray[np.float64]
WouldBe = tuple[Array, Array]
"""What given numbers would be, and how far from that they may be."""
Undo = Callable[[Row, Array], Array]

FEW = 25  # instants that amounts are found from
ENOUGH_NUMBERS = 3  # of the car, of which one is left out: what one or two alone say fits much


@dataclass(frozen=True)
class Hypothesis:
    """One fault with its parameters.

    Attributes:
        key: which fault of its kind; that of another quantity is the same fault.
        words: what was done to the numbers.
        rows: what each row would be.
        fitted: how many numbers were chosen so that it fits.
        cost: how far-fetched it is; the fitted numbers and the choices made.
        decimals: of its amounts; of what is as far-fetched the rounder one is likelier meant.
        looser: whether it says that the numbers are ours, and may be farther off than is claimed of them.
        whole: whether it is about the whole car, so that rows that agree must agree under it too.
        rests: whether it says where points rest, which one number tells.
        undo: makes ours again of a given row's numbers, where all may have the fault beside another one.
        kind: of fault, two kinds joined by "and".
    """

    key: Hashable
    words: str
    rows: Mapping[Row, WouldBe]
    fitted: int = 0
    cost: float = 1.0
    decimals: int = 0
    looser: bool = False
    whole: bool = False
    rests: bool = False
    undo: Undo | None = None
    kind: str = ""


@dataclass(frozen=True)
class Kind:
    """A kind of fault.

    Attributes:
        name: of the kind. suppose: gives the faults of this kind that may be in the rows that disagree.
        stage: "numbers" needs only arithmetic; "car" solves other motions of the car or other cars, one kind
            after the other until nothing is left; "last" says little, and is tried only on what nothing else
            explains.
        opens, closes: whether it may be the first or the second of two faults in the same numbers. The second
            is sought in what the first would make of the held numbers.
        of_time: whether it makes sense of numbers over time only.
        neighbours: whether it takes numbers from the rows beside, so that some rows alone do not show it.
        beside: a kind whose faults leave it open, as they may be its own said otherwise; empty if none does.
        hides: whether all angles may have it beside another car, so that neither shows by itself.
    """

    name: str
    suppose: Callable[[Evidence], Iterator[Hypothesis]]
    stage: Literal["numbers", "car", "last"] = "numbers"
    opens: bool = False
    closes: bool = False
    of_time: bool = False
    neighbours: bool = False
    beside: str = ""
    hides: bool = False


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


@dataclass(frozen=True)
class Parameters:
    """Numbers of the car, or of how it is driven, that may be others.

    Attributes:
        key: which they are. start: ours. step: of differences by each.
        motion_by: the motion by others; None where there is none.
    """

    key: Hashable
    start: tuple[float, ...]
    step: float
    motion_by: Callable[..., Motion | None]

    def motion(self, evidence: Evidence, amounts: Sequence[float]) -> Motion | None:
        """The motion by some amounts, solved once."""
        return evidence.solved.other((self.key, *amounts), lambda: self.motion_by(*amounts))

    def amounts(self, evidence: Evidence, looked: Sequence[Row], rounded: bool = True) -> list[float] | None:
        """Those by which the motion gives the numbers of some rows; see `fitted`."""
        few = evidence.thinned(FEW)
        theirs, off = few.joined(looked)
        if not np.isfinite(theirs).all():
            return None

        def read(sets: Array) -> Array:
            found = np.full((len(sets), len(theirs)), np.nan)
            for i, amounts in enumerate(map(tuple, sets.tolist())):
                if amounts == self.start:
                    found[i] = np.concatenate([few.held[row].ravel() for row in looked])
                elif motion := self.motion(evidence, amounts):
                    found[i] = numbers_in(motion.at(few.times).numbers, looked)
                else:
                    break  # where there is no motion, slopes tell nothing
            return found

        found = fitted(read, self.start, self.step, theirs, off, rounded)
        return None if found is None else list(found.amounts.tolist())


def other_number(
    evidence: Evidence, looked: Sequence[Row], number: Parameters, words: Callable[[float], str]
) -> Hypothesis | None:
    """One number of the car that gives the numbers of some rows; none where there are no words for it."""
    found = number.amounts(evidence, looked)
    motion = number.motion(evidence, found) if found else None
    if found is None or motion is None or not (said := words(*found)):
        return None
    return Hypothesis(number.key, said, evidence.by(motion), 1, 2.5, decimals_of(np.array(found)), whole=True)
