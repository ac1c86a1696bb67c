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
from validate.diagnosis.least import fitted

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


def amounts_of(
    evidence: Evidence,
    looked: Sequence[Row],
    motion_of: Callable[..., Motion | None],
    start: Sequence[float],
    step: float,
    rounded: bool = True,
) -> list[float] | None:
    """The amounts by which the car's motion gives the numbers of some rows; see `fitted`.

    Args:
        motion_of: the motion by some amounts; None where there is none. start: at which it is ours.
    """
    few = evidence.thinned(FEW)
    theirs, off = few.joined(looked)
    if not np.isfinite(theirs).all():
        return None

    def read(sets: Array) -> Array:
        found = np.full((len(sets), len(theirs)), np.nan)
        for i, amounts in enumerate(sets.tolist()):
            if amounts == list(start):
                found[i] = np.concatenate([few.held[row].ravel() for row in looked])
            elif motion := motion_of(*amounts):
                found[i] = numbers_in(motion.at(few.times).numbers, looked)
        return found

    found = fitted(read, start, step, theirs, off, rounded)
    return None if found is None else list(found.tolist())


def gives(evidence: Evidence, one: Hypothesis, rows: Sequence[Row]) -> bool:
    """Whether a fault explains rows whole, and one of the whole car leaves right what agrees."""
    agree = [row for row in one.rows if row not in evidence.wrong] if one.whole else []
    return all(evidence.left(row, *one.rows[row]) <= 1.0 for row in (*rows, *agree))


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
