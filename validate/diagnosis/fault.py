"""A possible fault of given numbers, and a kind of faults."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from validate.diagnosis.evidence import Evidence, Row, WouldBe

# A tolerance of numbers that may be anything; finite, because it is multiplied by zeros of a matrix.
ANY = 1e100
Stage = Literal["numbers", "motion", "drawing", "last"]


@dataclass(frozen=True)
class Fault:
    """One fault with its parameters.

    Attributes:
        words: the fault in words.
        rows: the numbers that each row would have with the fault.
        fitted: number of fitted parameters.
        cost: how far-fetched it is, from the fitted parameters and the choices made.
        looser: whether the fault only widens the tolerance, such as rounding to printed digits.
        whole: whether it concerns the whole car, so that rows that agree must also agree with the fault.
        kind: the kind of fault; two kinds are joined by "and".
        explains: once it is tested, the disagreeing rows that it explains.
        leftover: the largest remaining difference / tolerance of these rows.
    """

    words: str
    rows: Mapping[Row, WouldBe]
    fitted: int = 0
    cost: float = 1.0
    looser: bool = False
    whole: bool = False
    kind: str = ""
    explains: tuple[Row, ...] = ()
    leftover: float = np.nan


@dataclass(frozen=True)
class Kind:
    """A kind of fault.

    Attributes:
        name: name of the kind. suppose: yields possible faults of this kind for some evidence.
        stage: "numbers" needs only arithmetic; "motion" solves the same car with another motion or closure;
            "drawing" looks for another car; "last" explains little. A stage is tried if earlier ones leave
            rows without an explanation.
        opens, closes: whether it may be the first or the second of two faults in the same numbers.
    """

    name: str
    suppose: Callable[[Evidence], Iterator[Fault]]
    stage: Stage = "numbers"
    opens: bool = False
    closes: bool = False
