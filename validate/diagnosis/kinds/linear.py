"""Faults that multiply numbers by a factor or vectors by a matrix: signs, axes, units, other factors."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from itertools import permutations, product
from math import pi
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from validate.diagnosis.evidence import Evidence, Row, WouldBe, roundest, together
from validate.diagnosis.hypothesis import Hypothesis

Array = NDArray[np.float64]
Times = Callable[[Row], float | Array]
"""The factor or the matrix, (3, 3), by which the numbers of a row are multiplied."""

# Closer to 1 a factor is not reported: least squares gives such a factor for any small difference.
NEAR_ONE = 0.01


class Unit(NamedTuple):
    """A wrong unit.

    Attributes:
        words: the fault in words.
        of: the unit that it replaces: mm, rad or s.
        factor: the number in the wrong unit over the number in the right one; for s, per order of a rate.
    """

    words: str
    of: str
    factor: float

    def has(self, row: Row) -> bool:
        """Whether the numbers of a row may have this fault."""
        return row.order > 0 if self.of == "s" else self.of == row.unit

    def times(self, row: Row) -> float:
        """The factor of the numbers of a row."""
        return self.factor**row.order if self.of == "s" else self.factor


UNITS = (
    Unit("degrees for radians", "rad", 180.0 / pi),
    Unit("degrees taken for radians and converted once more", "rad", pi / 180.0),
    Unit("minutes of arc taken for degrees", "rad", 60.0),
    Unit("m for mm", "mm", 1e-3),
    Unit("inches for mm", "mm", 1.0 / 25.4),
    Unit("mm taken for m and converted once more", "mm", 1e3),
    Unit("per minute for per second", "s", 60.0),
)


def _rows(evidence: Evidence, rows: Iterable[Row], times: Times) -> dict[Row, WouldBe]:
    found: dict[Row, WouldBe] = {}
    for row in rows:
        by = times(row)
        # A sign or a permutation causes no rounding.
        exact = np.isin(np.abs(by), (0.0, 1.0)).all()
        allowed = evidence.allowed[row] if exact else evidence.rounded(row)
        found[row] = _product(by, evidence.held[row]), _product(np.abs(by), allowed)
    return found


def _product(by: float | Array, numbers: Array) -> Array:
    return np.asarray(numbers @ by.T if isinstance(by, np.ndarray) else by * numbers)


def _undone(times: Times, row: Row, numbers: Array) -> Array:
    by = times(row)
    return np.asarray(numbers @ by if isinstance(by, np.ndarray) else numbers / by)


def _turned(matrix: Array, axial: bool, row: Row) -> float | Array:
    """The matrix for the vectors of a row in other axes; 1 for a number of the car.

    Args:
        matrix: orthogonal.
        axial: whether the axes are changed, and not only signs written: then an angular velocity also changes
            its sign if the new axes are left-handed.
    """
    if row.of == "car":
        return 1.0
    return matrix * np.sign(np.linalg.det(matrix)) if axial and row.of == "body" else matrix


def _linear(
    evidence: Evidence, words: str, rows: Iterable[Row], times: Times, cost: float = 1.0, whole: bool = False
) -> Hypothesis:
    there = _rows(evidence, rows, times)
    return Hypothesis(words, there, cost=cost, whole=whole, undo=partial(_undone, times))


def other_signs(evidence: Evidence) -> Iterator[Hypothesis]:
    """Opposite signs of one, two or all components of vectors, or of a number of the car, such as toe."""
    for signs in [*product((1.0, -1.0), repeat=3)][1:]:
        flipped = [axis for axis, sign in zip("xyz", signs, strict=True) if sign < 0.0]
        times = partial(_turned, np.diag(signs), False)
        words, cost = f"the other sign of {' and '.join(flipped)}", 1.0 + 0.1 * len(flipped)
        yield _linear(evidence, words, evidence.vectors, times, cost)
    cars = [row for row in evidence.wrong if row.of == "car"]
    yield _linear(evidence, "the other sign", cars, lambda _: -1.0)


def exchanged_axes(evidence: Evidence) -> Iterator[Hypothesis]:
    """Axes in another order, with or without opposite signs.

    Permutations that do not at least halve a difference at a few instants are skipped.
    """
    few = evidence.few
    before = {row: few.left(row, few.held[row], few.allowed[row]) for row in few.vectors if row in few.wrong}
    for places, signs in product([*permutations(range(3))][1:], product((1.0, -1.0), repeat=3)):
        matrix = np.zeros((3, 3))
        matrix[range(3), places] = signs
        times = partial(_turned, matrix, True)
        there = _rows(few, before, times)
        if any(few.left(row, *there[row]) <= max(1.0, 0.5 * before[row]) for row in before):
            named = ("-" * (s < 0.0) + "xyz"[p] for s, p in zip(signs, places, strict=True))
            words, cost = f"other axes: its x, y, z are our {', '.join(named)}", 1.5
            yield _linear(evidence, words, evidence.vectors, times, cost + 0.01 * sum(s < 0.0 for s in signs))


def mirrored(evidence: Evidence) -> Iterator[Hypothesis]:
    """Left and right exchanged: vectors are mirrored in the car's middle plane; numbers of the car stay."""
    right = evidence.scene.mechanism.axes.right
    times = partial(_turned, np.eye(3) - 2.0 * np.outer(right, right), True)
    yield _linear(evidence, "left for right: the car is mirrored", evidence.held, times, whole=True)


def other_units(evidence: Evidence) -> Iterator[Hypothesis]:
    """Each wrong unit, for all rows that may have it."""
    for unit in UNITS:
        yield _linear(evidence, unit.words, filter(unit.has, evidence.wrong), unit.times)


def factors(evidence: Evidence) -> Iterator[Hypothesis]:
    """A factor by least squares that is not that of a known unit, and not close to 1."""
    for some in together(evidence.wrong):
        factor = _factor(evidence, some)
        if factor is not None:
            words = f"{factor:.7g} times ours"
            yield Hypothesis(words, _times(evidence, some, factor), 1, 2.0)


def _factor(evidence: Evidence, rows: Sequence[Row]) -> float | None:
    ours, theirs, _ = evidence.joined(rows)
    square = float(ours @ ours)
    found = float(ours @ theirs) / square if square > 0.0 else np.nan
    if not np.isfinite(found) or found == 0.0 or abs(found - 1.0) <= NEAR_ONE:
        return None
    # Rounded in units of its own power of ten.
    unit = 10.0 ** np.floor(np.log10(abs(found)))
    return float(roundest(found, lambda near: evidence.explained(_times(evidence, rows, near)), unit))


def _times(evidence: Evidence, rows: Sequence[Row], factor: Array | float) -> dict[Row, WouldBe]:
    return _rows(evidence, rows, lambda _: float(factor))
