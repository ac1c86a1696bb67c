"""By what amount numbers are off: another zero, a factor, and the last printed digit."""

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
        times = partial(_times, evidence, some)
        # So many decimals of the factor's own power of ten.
        unit = 10.0 ** np.floor(np.log10(abs(factor)))
        near = float(_rounder(evidence, times, factor, unit))
        yield Hypothesis(f"{near:.9g}", f"{near:.7g} times ours", times(near), 1, 2.0)


def _rounder(
    evidence: Evidence, of: Callable[[Array], dict[Row, WouldBe]], amount: Array | float, unit: float = 1.0
) -> Array:
    """The roundest amount near a found one by which rows are explained."""
    return roundest(amount, 7, lambda near: evidence.explained(of(near)), unit)


def _times(evidence: Evidence, rows: Iterable[Row], factor: Array | float) -> dict[Row, WouldBe]:
    return {row: (factor * evidence.held[row], np.abs(factor) * evidence.rounded(row)) for row in rows}


def offsets(evidence: Evidence) -> Iterator[Hypothesis]:
    """What is subtracted of places and angles: the first value, the drawing's, or a constant."""
    placed = [row for row in evidence.wrong if order(row) == 0]
    for row in placed:
        first = _more(evidence, row, -evidence.held[row][0])
        yield Hypothesis("first", "the value at the first instant is subtracted", first)
    for row, value in _as_drawn(evidence, placed).items():
        drawn = _more(evidence, row, np.asarray(-value))
        yield Hypothesis("drawn", "the value of the drawing is subtracted", drawn, cost=1.2)
    for row in placed if len(evidence.times) > 2 else ():
        apart, off = evidence.given[row] - evidence.held[row], evidence.rounded(row)
        noise = float(off.max())
        off = off + evidence.own.get(row, 0.0)
        # Amid what its digits leave open.
        gap = np.asarray(0.5 * ((apart - off).max(axis=0) + (apart + off).min(axis=0)))
        if not (np.isfinite(gap).all() and np.abs(gap).max() > 8.0 * noise):
            continue
        more = partial(_more, evidence, row)
        gap = _rounder(evidence, more, np.where(np.abs(gap) <= noise, 0.0, gap))
        # Every point has that of another origin.
        words, count = f"a constant offset of {evidence.in_words(row, gap)}", int(np.count_nonzero(gap))
        undo = partial(_shifted, -gap) if kind_of(row) == "point" else None
        yield Hypothesis((row[0], words), words, more(gap), count, 1.0 + count, undo=undo)


def _more(evidence: Evidence, row: Row, amount: Array) -> dict[Row, WouldBe]:
    """A row that is ours and so much more."""
    return {row: (evidence.held[row] + amount, evidence.rounded(row, amount))}


def _shifted(shift: Array, row: Row, places: Array) -> Array:
    return np.asarray(places + shift)


def _as_drawn(evidence: Evidence, rows: Iterable[Row]) -> dict[Row, float]:
    """Numbers of the car as it is drawn, of those rows that are such."""
    of_the_car = [row for row in rows if kind_of(row) == "car"]
    try:
        scene = evidence.solved.fine
        numbers = solve_poses(scene, drawn_inputs(scene)).numbers if of_the_car else {}
    except PointcoordError:
        return {}
    return {(q, name): float(numbers[q][name]) for q, name in of_the_car if name in numbers[q]}


def printed_digits(evidence: Evidence) -> Iterator[Hypothesis]:
    """The fewest decimals that the given numbers have, and single precision.

    Half of the last place is what they may be off.
    """
    for rows in together(evidence.wrong):
        _, theirs, _ = evidence.joined(rows)
        if not np.isfinite(theirs).all():
            continue
        for count in range(MOST_DIGITS + 1):
            places = theirs * 10.0**count
            if (np.abs(places - np.rint(places)) <= 4.0 * EPS * np.abs(places)).all():
                found = {row: _looser(evidence, row, np.asarray(10.0**-count)) for row in rows}
                yield Hypothesis(count, f"printed with {count} decimals", found, cost=1.05, looser=True)
                break
        if (np.abs(theirs) < np.finfo(np.float32).max).all() and (theirs == theirs.astype(np.float32)).all():
            found = {row: _looser(evidence, row, SINGLE * np.abs(evidence.held[row])) for row in rows}
            yield Hypothesis("single", "printed or kept in single precision", found, looser=True)


def _looser(evidence: Evidence, row: Row, last_place: Array) -> WouldBe:
    """The numbers as they are held, and half of a last place more that they may be off."""
    held = evidence.held[row]
    return held, evidence.allowed[row] + 0.5 * last_place + EPS * np.abs(held)
