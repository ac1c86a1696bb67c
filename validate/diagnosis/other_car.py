"""Fits one number of a scene, such as a coordinate or an input, to the given numbers by least squares."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cache
from itertools import combinations
from warnings import catch_warnings

import numpy as np
from scipy.optimize import root_scalar

from pointcoord import Motion
from pointcoord.numerics.rounding import EPS
from validate.arrays import Array
from validate.diagnosis.evidence import Evidence, Row, Rows, WouldBe, roundest
from validate.diagnosis.fault import Fault
from validate.diagnosis.solved import Content

# Least number of numbers of the car, if one of them is left out: one or two numbers fit many changes.
ENOUGH_NUMBERS = 3
# A search is made only if the first linear step leaves at most this share of the difference; its result is
# used only if it does so too.
LIKELY = 0.5
# Most steps of the secant method, and a size of its steps below any rounding.
MOST_STEPS, TINY = 12, 1e-300
# A rounder value may leave so many times the difference of the fitted one. A least-squares fit of rounded
# numbers leaves less than the intended value: with 5 numbers, less by a root of 5/4 on average.
KEPT = 1.5


@dataclass(frozen=True, eq=False)
class Change:
    """A number of a scene that may be wrong.

    Attributes:
        put: sets another value in the scene's content.
        words: the fault in words, from the other value.
        ours: its value in the scene.
        step: step of a difference that estimates the derivatives of the numbers by it.
        slopes: these derivatives at a few instants, if they are known.
        farthest: largest change of the value.
        cost: how far-fetched a change is.
        late: whether the value is a time by which the motion is read later.
    """

    put: Callable[[Content, float], None]
    words: Callable[[float], str]
    ours: float = 0.0
    step: float = 1e-3
    slopes: Rows = field(default_factory=dict)
    farthest: float = np.inf
    cost: float = 2.5
    late: bool = False

    def motion(self, evidence: Evidence, value: float) -> Motion | None:
        """The motion of the scene with another value; None if it cannot be solved."""
        if abs(value - self.ours) >= self.farthest:
            return None
        return evidence.solved.other((self, value), lambda content: self.put(content, value))

    def fault(self, evidence: Evidence, value: float) -> Fault:
        """The fault that the whole car has another value."""
        rows = rows_of(evidence, self.motion(evidence, value), value * self.late)
        return Fault(self.words(value), rows, 1, self.cost, whole=True)


def rows_of(evidence: Evidence, motion: Motion | None, later: float = 0.0) -> dict[Row, WouldBe]:
    """The numbers of each row in another motion, read so much later, s; empty without a motion."""
    numbers = {} if motion is None else motion.at(evidence.times + later).numbers
    rows: dict[Row, WouldBe] = {}
    for row in evidence.trusted:
        if row.name in numbers.get(row.quantity, {}):
            value = np.array(numbers[row.quantity][row.name])
            # Twice, for the rounding of numbers in the inputs and for larger error bounds of this motion.
            rows[row] = value, 2.0 * evidence.rounded(row, value)
    return rows


def any_of(evidence: Evidence, changes: Sequence[Change]) -> Iterator[Fault]:
    """Each of some changes alone, fitted to positions or angles; if none explains all, to all but one.

    One number with a fault of its own would hide the change that the others show; positions in another unit
    would hide the change that angles show.
    """

    def fitted(rows: Sequence[Row]) -> dict[Change, Fault]:
        fits = ((change, _fit(change, evidence.few, rows)) for change in changes)
        return {change: change.fault(evidence, value) for change, value in fits if value is not None}

    found: dict[Change, Fault] = {}
    for looked in _telling(evidence):
        faults = fitted(looked)
        found |= faults
        if any(_explains(evidence, fault, looked) for fault in faults.values()):
            break
        if all(row.of == "car" for row in looked) and len(looked) >= ENOUGH_NUMBERS:
            for rows in combinations(looked, len(looked) - 1):
                faults = fitted(rows)
                found |= {one: fault for one, fault in faults.items() if _explains(evidence, fault, rows)}
    yield from found.values()


def _telling(evidence: Evidence) -> tuple[tuple[Row, ...], ...]:
    """Groups of wrong rows to fit: positions and lengths; angles; if there are none, the first quantity."""
    of_a_pose = (
        tuple(row for row in evidence.wrong if row.unit == unit and row.order == 0) for unit in ("mm", "rad")
    )
    first = tuple(row for row in evidence.wrong if row.quantity == evidence.wrong[0].quantity)
    return tuple(filter(None, of_a_pose)) or (first,)


def _explains(evidence: Evidence, fault: Fault, rows: Sequence[Row]) -> bool:
    """Whether a fault explains all of some rows, and rows that agree still agree with it."""
    agree = (row for row in fault.rows if row not in evidence.wrong)
    return evidence.explained({row: fault.rows[row] for row in (*rows, *agree) if row in fault.rows})


def _fit(change: Change, evidence: Evidence, rows: Sequence[Row]) -> float | None:
    """The value that fits the numbers of rows best, by the secant method, rounded as far as they allow.

    None if it leaves much of the difference.
    """
    ours, theirs, off = evidence.joined(rows)
    start, first = change.ours, ours - theirs

    @cache
    def gap(value: float) -> Array:
        """Numbers with a value less the given ones; infinite if it cannot be solved."""
        if value == start:
            return first
        motion = change.motion(evidence, value)
        if motion is None:
            return np.full(len(ours), np.inf)
        numbers = motion.at(evidence.times + value * change.late).numbers
        found = np.concatenate([numbers[quantity][name].ravel() for quantity, name in rows])
        return np.where(np.isnan(found - theirs), np.inf, found - theirs)

    def left(value: float) -> float:
        return float(np.linalg.norm(gap(value)))

    if change.slopes:
        slope = np.concatenate([change.slopes[row].ravel() for row in rows])
    else:
        slope = (gap(start + change.step) - first) / change.step
    square = float(slope @ slope)
    if not (np.isfinite(first).all() and 0.0 < square < np.inf):
        return None
    step = -float(slope @ first) / square
    likely = LIKELY * left(start)
    if np.linalg.norm(first + step * slope) > likely:
        return None

    def along(value: float) -> float:
        # A missing number stops the search.
        return float(slope @ gap(value)) if np.isfinite(gap(value)).all() else 0.0

    # To the last digit, as the numbers may be given in full; scipy warns where the steps are only rounding.
    with catch_warnings(action="ignore", category=RuntimeWarning):
        ends = {"x0": start, "x1": start + step}
        found = root_scalar(along, method="secant", **ends, xtol=TINY, rtol=4.0 * EPS, maxiter=MOST_STEPS)
    least = left(found.root)

    def fits(near: Array) -> bool:
        return left(float(near)) <= KEPT * least and bool((np.abs(gap(float(near))) <= off).all())

    value = float(roundest(found.root, fits))
    return value if least <= likely and value != start else None
