"""A fault that numbers may have, and a kind of such faults: what it would make of the held numbers."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from validate.diagnosis.evidence import Evidence, Row, WouldBe

Array = NDArray[np.float64]
Undo = Callable[[Row, Array], Array]
Stage = Literal["numbers", "motion", "drawing", "last"]


@dataclass(frozen=True)
class Hypothesis:
    """One fault with its parameters.

    Attributes:
        words: what was done to the numbers.
        rows: what each row would be.
        fitted: how many numbers were chosen so that it fits.
        cost: how far-fetched it is; the fitted numbers and the choices made.
        key: which fault of its kind, where its words say more: one of other rows is the same.
        decimals: of its amount; of what is as far-fetched the rounder one is likelier meant.
        looser: whether it says that the numbers are ours, and may be farther off than is claimed of them.
        whole: whether it is about the whole car, so that rows that agree must agree under it too.
        rests: whether it says where points rest, which one number tells.
        undo: makes ours again of a given row's numbers, where all may have the fault beside another one.
        kind: of fault, two kinds joined by "and".
    """

    words: str
    rows: Mapping[Row, WouldBe]
    fitted: int = 0
    cost: float = 1.0
    key: Hashable = None
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
        stage: "numbers" needs only arithmetic; "motion" solves the same car moved or closed otherwise,
            "drawing" cars that are drawn otherwise; "last" says little. Each is tried on what those before do
            not explain.
        opens, closes: whether it may be the first or the second of two faults in the same numbers. The second
            is sought in what the first would make of the held numbers.
    """

    name: str
    suppose: Callable[[Evidence], Iterator[Hypothesis]]
    stage: Stage = "numbers"
    opens: bool = False
    closes: bool = False
