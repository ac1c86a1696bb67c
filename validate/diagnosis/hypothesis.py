"""A fault that somebody's numbers may have, and what the numbers would be if they had it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Hashable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from validate.diagnosis.evidence import Evidence, Row

Array = NDArray[np.float64]
WouldBe = tuple[Array, Array]
"""What given numbers would be, and how far from that they may be."""


@dataclass(frozen=True)
class Hypothesis:
    """One fault with its parameters.

    Attributes:
        kind: of fault. key: which fault of this kind; that of another quantity is the same fault.
        words: what was done to the numbers.
        rows: what each row would be.
        fitted: how many numbers were chosen so that it fits.
        cost: how far-fetched it is; the fitted numbers and the choices made.
        looser: whether it says that the numbers are ours, and may be farther off than is claimed of them.
        aside: whether it says not what is wrong first, and counts where it explains all, after all others.
        whole: whether it is about the whole car, so that rows that agree must agree under it too.
    """

    kind: str
    key: Hashable
    words: str
    rows: Mapping[Row, WouldBe]
    fitted: int = 0
    cost: float = 1.0
    looser: bool = False
    aside: bool = False
    whole: bool = False


class Kind(ABC):
    """A kind of fault.

    Attributes:
        name: of the kind.
        solves: whether trying it takes solving other cars or motions.
        first: of those that solve, whether it is tried before the others, which are left out if it does.
        in_place: of those that solve, whether it is tried too where points are given and are in their places.
        opens, closes: whether it may be the first or the second of two faults in the same numbers. The second
            is sought in what the first would make of the held numbers.
        follows: kinds of first faults that it may be the second of; all if empty. One that has such is none
            by itself.
        last: whether it is tried only on what nothing else explains, because it says little.
        of_time: whether it makes sense of numbers over time only, or of a car whose inputs are known.
        reach: how many instants to either side a number that it would give depends on; None: on all of them,
            as where something is fitted. Kinds of a reach are looked for at some instants first.
    """

    name: str
    solves = False
    first = False
    in_place = False
    opens = False
    closes = False
    follows: tuple[str, ...] = ()
    last = False
    of_time = False
    reach: int | None = None

    @abstractmethod
    def hypotheses(self, evidence: Evidence) -> Iterator[Hypothesis]:
        """The faults of this kind that may be in the rows that disagree."""
