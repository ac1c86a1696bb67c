"""Printed digits: numbers that agree once ours are rounded as theirs are."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.rounding import EPS
from validate.diagnosis.evidence import Evidence, Row, kind_of
from validate.diagnosis.hypothesis import Hypothesis, Kind

Array = NDArray[np.float64]

MOST = 10
SOME = 500  # numbers
SINGLE = float(np.finfo(np.float32).eps)


def decimal_step(numbers: Array, places: int) -> Array:
    """The last place of numbers of so many decimals."""
    return np.full(numbers.shape, 10.0**-places)


def significant_step(numbers: Array, digits: int) -> Array:
    """The last place of numbers of so many significant digits."""
    size = np.floor(np.log10(np.maximum(np.abs(numbers), 1e-300)))
    return np.asarray(10.0 ** (size - digits + 1.0))


class Digits(Kind):
    """As few digits as the given numbers have; the half of the last place is what they may be off."""

    name, closes = "digits", True

    def hypotheses(self, evidence: Evidence) -> Iterator[Hypothesis]:
        """The fewest decimals and the fewest significant digits of each quantity, and single precision."""
        for quantity in evidence.wrong_quantities:
            rows = evidence.wrong_of(quantity)
            for some in [(row,) for row in rows] if kind_of(rows[0]) == "car" else [rows]:
                yield from self._of(evidence, some)

    def _of(self, evidence: Evidence, rows: tuple[Row, ...]) -> Iterator[Hypothesis]:
        theirs = np.concatenate([evidence.given[row].ravel() for row in rows])
        if not np.isfinite(theirs).all():
            return
        steps: tuple[tuple[str, Callable[[Array, int], Array]], ...] = (
            ("decimals", decimal_step),
            ("significant digits", significant_step),
        )
        # What not even some numbers have is not looked for in all.
        few = theirs[:: -(-len(theirs) // SOME)]
        for what, step in steps:
            for count in range(what != "decimals", MOST + 1):
                if self._has(few, step(few, count)) and self._has(theirs, step(theirs, count)):
                    halves = {row: 0.5 * step(evidence.given[row], count) for row in rows}
                    yield self._rounded(evidence, halves, f"{count} {what}")
                    break
        if all((some == some.astype(np.float32)).all() for some in (few, theirs)):
            found = {
                row: (evidence.held[row], evidence.allowed[row] + self._single(evidence, row)) for row in rows
            }
            yield Hypothesis(self.name, "single", "printed or kept in single precision", found, looser=True)

    @staticmethod
    def _single(evidence: Evidence, row: Row) -> Array:
        return np.asarray(0.5 * SINGLE * np.abs(evidence.held[row]))

    @staticmethod
    def _has(numbers: Array, step: Array) -> bool:
        """Whether all numbers are multiples of their steps, as nearly as a double can be."""
        places = numbers / step
        return bool((np.abs(places - np.rint(places)) <= 4.0 * EPS * np.abs(places)).all())

    def _rounded(self, evidence: Evidence, halves: Mapping[Row, Array], words: str) -> Hypothesis:
        found = {
            row: (evidence.held[row], half + evidence.allowed[row] + EPS * np.abs(evidence.held[row]))
            for row, half in halves.items()
        }
        return Hypothesis(self.name, words, f"printed with {words}", found, cost=1.05, looser=True)


KIND = Digits()
