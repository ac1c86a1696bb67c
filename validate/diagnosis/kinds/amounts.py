"""By what amount numbers are off: offsets, another origin, a factor, and the last printed digit."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from functools import partial

import numpy as np
from numpy.typing import NDArray

from pointcoord import PointcoordError, solve_poses
from pointcoord.drawing_stands import drawn_inputs
from pointcoord.numerics.rounding import EPS
from validate.diagnosis.evidence import Evidence, Row, kind_of, order, together
from validate.diagnosis.hypothesis import Hypothesis, WouldBe
from validate.diagnosis.least import roundest

Array = NDArray[np.float64]

# A factor near 1 is what least squares makes of any small difference, such as that of two cars.
NEAR_ONE = 0.01
MOST_DIGITS = 10
SINGLE = float(np.finfo(np.float32).eps)


def factors(evidence: Evidence) -> Iterator[Hypothesis]:
    """One factor that is no known unit's, by least squares, and far enough from 1 to be meant."""
    for some in together(evidence.wrong):
        ours, theirs = (evidence.stacked(some, part.__getitem__) for part in (evidence.held, evidence.given))
        square = float(np.sum(ours * ours))
        factor = float(np.sum(ours * theirs)) / square if square > 0.0 else np.nan
        if not np.isfinite(factor) or factor == 0.0 or abs(factor - 1.0) <= NEAR_ONE:
            continue
        explains = partial(_is_times, evidence, some)
        # So many decimals of the factor's own power of ten.
        near = float(roundest(factor, 7, explains, 10.0 ** np.floor(np.log10(abs(factor)))))
        if explains(near):
            yield Hypothesis(f"{near:.9g}", f"{near:.7g} times ours", _times(evidence, some, near), 1, 2.0)


def _is_times(evidence: Evidence, rows: Iterable[Row], factor: Array | float) -> bool:
    return _explain(evidence, _times(evidence, rows, factor))


def _times(evidence: Evidence, rows: Iterable[Row], factor: Array | float) -> dict[Row, WouldBe]:
    return {row: (factor * evidence.held[row], np.abs(factor) * evidence.rounded(row)) for row in rows}


def _explain(evidence: Evidence, rows: dict[Row, WouldBe]) -> bool:
    return all(evidence.left(row, *numbers) <= 1.0 for row, numbers in rows.items())


def _more(evidence: Evidence, row: Row, amount: Array | float) -> dict[Row, WouldBe]:
    """A row that is ours and so much more."""
    return {row: (evidence.held[row] + amount, evidence.rounded(row, amount))}


def offsets(evidence: Evidence) -> Iterator[Hypothesis]:
    """What is subtracted: the first value, the drawing's, another origin of all points, a constant.

    A constant of one point beside others that are off as well is said where it is all that is wrong with it.
    """
    placed = [row for row in evidence.wrong if order(row) == 0]
    points = [row for row in placed if kind_of(row) == "point"]
    for row in placed:
        first = _more(evidence, row, -evidence.held[row][0])
        yield Hypothesis("first", "the value at the first instant is subtracted", first)
    for row, value in _as_drawn(evidence, placed).items():
        drawn = _more(evidence, row, -value)
        yield Hypothesis("drawn", "the value of the drawing is subtracted", drawn, cost=1.2)
    yield from _origin(evidence, points)
    for row in placed if len(evidence.times) > 2 else ():
        gap, noise = _constant_of(evidence, row), float(evidence.rounded(row).max())
        if not (np.isfinite(gap).all() and np.abs(gap).max() > 8.0 * noise):
            continue
        _, unit = evidence.theirs.get(row, ("", 1.0))
        gap = roundest(np.where(np.abs(gap) <= noise, 0.0, gap), 7, partial(_is_more, evidence, row), unit)
        if row not in points or len(points) == 1 or _is_more(evidence, row, gap):
            words, count = f"a constant offset of {evidence.in_words(row, gap)}", max(np.size(gap), 1)
            yield Hypothesis((row, "constant"), words, _more(evidence, row, gap), count, 1.0 + count)


def _is_more(evidence: Evidence, row: Row, amount: Array) -> bool:
    return _explain(evidence, _more(evidence, row, amount))


def _constant_of(evidence: Evidence, row: Row) -> Array:
    """By what a row differs from ours: amid what its digits leave open, where the mean may lie beside."""
    apart = evidence.given[row] - evidence.held[row]
    off = evidence.rounded(row) + evidence.own.get(row, 0.0)
    amid = np.asarray(0.5 * ((apart - off).max(axis=0) + (apart + off).min(axis=0)))
    return amid if _is_more(evidence, row, amid) else np.asarray(apart.mean(axis=0))


def _as_drawn(evidence: Evidence, rows: Iterable[Row]) -> dict[Row, float]:
    """Numbers of the car as it is drawn, of those rows that are such."""
    of_the_car = [row for row in rows if kind_of(row) == "car"]
    try:
        scene = evidence.solved.fine
        numbers = solve_poses(scene, drawn_inputs(scene)).numbers if of_the_car else {}
    except PointcoordError:
        return {}
    return {(q, name): float(numbers[q][name]) for q, name in of_the_car if name in numbers[q]}


def _origin(evidence: Evidence, rows: list[Row]) -> Iterator[Hypothesis]:
    """One shift for all points; of another origin only where every given point has it."""
    if len(rows) < 2:
        return  # one point alone tells of no other
    # Not the mean: a few points may be elsewhere by themselves besides.
    shift = np.median(np.concatenate([evidence.given[row] - evidence.held[row] for row in rows]), axis=0)
    shift[np.abs(shift) < max(float(evidence.rounded(row).max()) for row in rows)] = 0.0
    fitted = int(np.count_nonzero(shift))
    if not fitted or not np.isfinite(shift).all():
        return
    moved = {row: numbers for row in rows for numbers in _more(evidence, row, shift).values()}
    # The points that agree say where the origin is: what is off beside them is off by itself.
    every = {row for row in evidence.given if row[0] == rows[0][0]} == {*rows} and _explain(evidence, moved)
    found = evidence.in_words(rows[0], shift)
    words = f"another origin: every point is shifted by {found}" if every else f"shifted by {found}"
    undo = partial(_shifted, -shift)
    yield Hypothesis("origin", words, moved, fitted, 1.0 + 0.5 * fitted, undo=undo)


def _shifted(shift: Array, row: Row, places: Array) -> Array:
    return np.asarray(places + shift)


def _decimal_step(numbers: Array, places: int) -> Array:
    return np.full(numbers.shape, 10.0**-places)


def _significant_step(numbers: Array, digits: int) -> Array:
    size = np.floor(np.log10(np.maximum(np.abs(numbers), 1e-300)))
    return np.asarray(10.0 ** (size - digits + 1.0))


STEPS: tuple[tuple[str, int, Callable[[Array, int], Array]], ...] = (
    ("decimals", 0, _decimal_step),
    ("significant digits", 1, _significant_step),
)
"""In words, the fewest, and the last place of numbers of so many."""


def printed_digits(evidence: Evidence) -> Iterator[Hypothesis]:
    """The fewest decimals and significant digits that the given numbers have, and single precision.

    Half of the last place is what they may be off.
    """
    for rows in together(evidence.wrong):
        theirs, _ = evidence.joined(rows)
        if not np.isfinite(theirs).all():
            continue
        for what, fewest, step in STEPS:
            for count in range(fewest, MOST_DIGITS + 1):
                places = theirs / step(theirs, count)
                if (np.abs(places - np.rint(places)) <= 4.0 * EPS * np.abs(places)).all():
                    found = {row: _looser(evidence, row, step(evidence.given[row], count)) for row in rows}
                    said = f"{count} {what}"
                    yield Hypothesis(said, f"printed with {said}", found, cost=1.05, looser=True)
                    break
        if (np.abs(theirs) < np.finfo(np.float32).max).all() and (theirs == theirs.astype(np.float32)).all():
            found = {row: _looser(evidence, row, SINGLE * np.abs(evidence.held[row])) for row in rows}
            yield Hypothesis("single", "printed or kept in single precision", found, looser=True)


def _looser(evidence: Evidence, row: Row, last_place: Array) -> WouldBe:
    """The numbers as they are held, and half of a last place more that they may be off."""
    held = evidence.held[row]
    return held, evidence.allowed[row] + 0.5 * last_place + EPS * np.abs(held)
