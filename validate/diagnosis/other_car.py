"""Fits one number of a scene, such as a coordinate or a length, to the given numbers by least squares."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import combinations
from warnings import catch_warnings

import numpy as np
from scipy.optimize import root_scalar

from pointcoord import Motion, Scene, simulate
from pointcoord.numerics.rounding import EPS
from validate.arrays import Array
from validate.diagnosis.evidence import (
    DECIMALS,
    Content,
    Evidence,
    Hypothesis,
    Row,
    WouldBe,
    numbers_in,
    roundest,
)

# Least number of numbers of the car, if one of them is left out: one or two numbers fit many changes.
ENOUGH_NUMBERS = 3
# A search is made only if the first linear step leaves at most this share of the difference.
LIKELY = 0.5
# A fit is accepted if it leaves at most this share of the difference, or if every number is within so many
# times its tolerance; then a rounder amount, such as the intended one, may fit better.
PROMISING, NEARLY = 0.1, 2.0
# Most steps of the secant method, and a size of its steps below any rounding.
MOST_STEPS, TINY = 12, 1e-300
# A rounder amount may leave so many times the difference of the fitted one. A least-squares fit of
# rounded numbers leaves less than the intended amount: with 5 numbers, less by a root of 5/4 on average.
KEPT = 1.5
# A change is reported if it leaves at most so many times the difference that the best change leaves.
POORER = 30.0


@dataclass(frozen=True)
class Change:
    """A number of a scene that may be wrong.

    Attributes:
        key: identifies the number.
        put: sets another value in the scene's content.
        words: the fault in words, from the other value.
        slope: derivatives of the numbers of rows by it, at a few instants, concatenated; or a step.
        ours: its value in the scene.
        farthest: largest change of the value.
        cost: how far-fetched a change is.
        silent: points whose numbers do not depend on it.
        late: whether the value is a time by which the motion is read later.
    """

    key: Hashable
    put: Callable[[Content, float], None]
    words: Callable[[float], str]
    slope: Callable[[Sequence[Row]], Array] | float
    ours: float = 0.0
    farthest: float = np.inf
    cost: float = 2.5
    silent: frozenset[str] = frozenset()
    late: bool = False

    def motion(self, evidence: Evidence, amount: float) -> Motion | None:
        """The motion of the scene with another value; None if it cannot be solved."""
        return evidence.solved.other((self.key, amount), lambda content: self.put(content, amount))

    def read(self, evidence: Evidence, looked: Sequence[Row], amount: float) -> Array | None:
        """The numbers of rows with another value, concatenated; None if it cannot be solved."""
        there = abs(amount - self.ours) < self.farthest
        motion = self.motion(evidence, amount) if there else None
        if motion is None:
            return None
        return numbers_in(motion.at(evidence.times + amount * self.late).numbers, looked)

    def supposed(self, evidence: Evidence, amount: float) -> Iterator[Hypothesis]:
        """The fault that the whole car has another value."""
        motion = self.motion(evidence, amount)
        if motion is not None and amount != self.ours:
            # Either the value is round, as a drawn hardpoint, or the change, as an error of a link.
            decimals = min(map(_decimals, (amount, round(amount - self.ours, DECIMALS))))
            rows = _rows_of(evidence, motion, amount * self.late)
            rows = {row: would for row, would in rows.items() if row.name not in self.silent}
            words = self.words(amount)
            yield Hypothesis(words, rows, 1, self.cost, key=self.key, decimals=decimals, whole=True)


def _rows_of(evidence: Evidence, motion: Motion, later: float = 0.0) -> dict[Row, WouldBe]:
    """The numbers of each row in another motion, with their tolerances.

    Args:
        later: the motion is read so much after the instants, s.
    """
    samples = motion.at(evidence.times + later)
    proven = motion.proof_of(samples, rates=True).proven
    rows: dict[Row, WouldBe] = {}
    for row in evidence.held:
        quantity, name = row
        if name in samples.numbers[quantity]:
            value = np.array(samples.numbers[quantity][name])
            # The error bound of the motion, doubled for the rounding of numbers in its laws.
            bound = np.nan_to_num(proven[quantity][name], posinf=0.0)
            allowed = 2.0 * (evidence.rounded(row, value) + bound)
            if later:
                # The motion is read at other instants, where bounds may be larger: the largest is used. The
                # rounding of instants is added.
                speed = np.abs(np.gradient(value, evidence.times, axis=0)).max()
                rounding = 8.0 * EPS * speed * (abs(later) + np.abs(evidence.times).max())
                allowed = np.full_like(value, allowed.max(axis=0) + rounding)
            rows[row] = (value, allowed)
    return rows


def _decimals(amount: float) -> int:
    return next((n for n in range(DECIMALS) if round(amount, n) == amount), DECIMALS)


def _fitted(change: Change, evidence: Evidence, looked: Sequence[Row]) -> tuple[float, float] | None:
    """The value that fits the numbers of some rows, by the secant method, and the remaining difference.

    It is rounded as far as the numbers allow. None if much of the difference remains.
    """
    ours, theirs, off = evidence.joined(looked)
    start = change.ours
    if not np.isfinite(ours - theirs).all():
        return None

    @cache
    def gap_at(amount: float) -> Array:
        found = ours if amount == start else change.read(evidence, looked, amount)
        gap = np.full(len(ours), np.nan) if found is None else found - theirs
        # A missing number counts as an infinite difference.
        return np.where(np.isnan(gap), np.inf, gap)

    def left(amount: float) -> float:
        return float(np.linalg.norm(gap_at(amount)))

    def within(amount: float, times: float) -> bool:
        return bool((np.abs(gap_at(amount)) <= times * off).all())

    if callable(change.slope):
        slope = change.slope(looked)
    else:
        beside = change.read(evidence, looked, start - change.slope)
        slope = np.zeros_like(ours) if beside is None else (ours - beside) / change.slope
    square = float(slope @ slope)
    step = -float(slope @ gap_at(start)) / square if square > 0.0 else 0.0
    if not np.linalg.norm(gap_at(start) + step * slope) <= LIKELY * left(start):
        return None

    def along(amount: float) -> float:
        # A missing number stops the search.
        return float(slope @ gap_at(amount)) if np.isfinite(gap_at(amount)).all() else 0.0

    # To the last digit, as the numbers may be given in full; scipy warns where the steps are only rounding.
    with catch_warnings(action="ignore", category=RuntimeWarning):
        ends = {"x0": start, "x1": start + step}
        found = root_scalar(along, method="secant", **ends, xtol=TINY, rtol=4.0 * EPS, maxiter=MOST_STEPS)
    amount = found.root
    least = left(amount)

    def kept(one: Array) -> bool:
        return left(float(one)) <= KEPT * least and within(float(one), 1.0)

    if within(amount, NEARLY):
        amount = float(roundest(amount, kept))
    elif least > PROMISING * left(start):
        return None
    return amount, left(amount)


def otherwise(
    evidence: Evidence,
    words: str,
    put: Callable[[Content], None],
    cost: float = 1.0,
    solve: Callable[[Scene], Motion] = simulate,
) -> Iterator[Hypothesis]:
    """The fault that the whole car has another scene content, if it can be solved."""
    motion = evidence.solved.other(words, put, solve)
    if motion is not None:
        yield Hypothesis(words, _rows_of(evidence, motion), cost=cost, whole=True)


def any_of(evidence: Evidence, changes: Sequence[Change]) -> Iterator[Hypothesis]:
    """Each of some changes alone, fitted to positions or angles; if none explains all, to all but one.

    One number with a fault of its own would hide the change that the others show; positions in another unit
    would hide the change that angles show.
    """

    def suppose(looked: Sequence[Row]) -> list[Hypothesis]:
        fits = [(change, fit) for change in changes if (fit := _fitted(change, evidence.few, looked))]
        best = min((left for _, (_, left) in fits), default=0.0)
        return [
            one
            for change, (amount, left) in fits
            if left <= POORER * best
            for one in change.supposed(evidence, amount)
        ]

    for looked in _telling(evidence):
        found = suppose(looked)
        yield from found
        if any(_gives(evidence, one, looked) for one in found):
            return
        if all(row.of == "car" for row in looked) and len(looked) >= ENOUGH_NUMBERS:
            for others in combinations(looked, len(looked) - 1):
                yield from (one for one in suppose(others) if _gives(evidence, one, others))


def _telling(evidence: Evidence) -> tuple[tuple[Row, ...], ...]:
    """Groups of wrong rows to fit: positions and lengths; angles; if there are none, the first quantity."""
    of_a_pose = (
        tuple(row for row in evidence.wrong if row.unit == unit and row.order == 0) for unit in ("mm", "rad")
    )
    first = tuple(row for row in evidence.wrong if row.quantity == evidence.wrong[0].quantity)
    return tuple(filter(None, of_a_pose)) or (first,)


def _gives(evidence: Evidence, one: Hypothesis, rows: Sequence[Row]) -> bool:
    """Whether a fault explains all of some rows, and rows that agree still agree with it."""
    agree = (row for row in one.rows if row not in evidence.wrong)
    return evidence.explained({row: one.rows[row] for row in (*rows, *agree)})
