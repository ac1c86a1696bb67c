"""A possible fault of given numbers, with its effect on the trusted numbers, and a kind of such faults."""

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
        words: the fault in words.
        rows: the numbers that each row would have with the fault.
        fitted: number of fitted parameters.
        cost: how far-fetched it is, from the fitted parameters and the choices made.
        key: identifies the fault within its kind; faults with equal keys are merged. The words, if None.
        decimals: number of decimals of its amount; of equally far-fetched faults the rounder one is
            preferred.
        looser: whether the fault only widens the tolerance, such as rounding to printed digits.
        whole: whether it concerns the whole car, so that rows that agree must also agree with the fault.
        rests: whether it concerns points at rest, for which a single number is enough.
        undo: removes the fault from given numbers of a row, if all numbers may have this fault in addition to
            another one.
        kind: the kind of fault; two kinds are joined by "and".
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
        name: name of the kind. suppose: yields possible faults of this kind for some evidence.
        stage: "numbers" needs only arithmetic; "motion" solves the same car with another motion or closure;
            "drawing" solves cars with another drawing; "last" explains little. Each is tried on rows that
            earlier stages do not explain.
        opens, closes: whether it may be the first or the second of two faults in the same numbers.
    """

    name: str
    suppose: Callable[[Evidence], Iterator[Hypothesis]]
    stage: Stage = "numbers"
    opens: bool = False
    closes: bool = False
