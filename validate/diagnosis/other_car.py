"""Another car or motion: one number of a scene that may be another, by least squares of the given numbers."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from pointcoord import Motion, Scene, simulate
from pointcoord.numerics.rounding import EPS
from validate.diagnosis.evidence import DECIMALS, Content, Evidence, Row, WouldBe, numbers_in, roundest
from validate.diagnosis.hypothesis import Hypothesis

Array = NDArray[np.float64]

ENOUGH_NUMBERS = 3  # of the car, of which one is left out: what one or two alone say fits much
# What a linear step from where the amount is ours must leave of the difference, to be worth a search.
LIKELY = 0.5
# What the search may leave of it at most; or of what each number may be off by, which a rounder amount, as
# it is meant, may leave less of.
PROMISING, NEARLY = 0.1, 2.0
# Of the difference: a step that lessens it by no more than half is the last one, for near the amount that is
# meant a step lessens it manifold, down to what remains.
MANIFOLD = 0.5
PARTS = (1.0, 0.25)  # of a step, of which the first that lessens the difference is gone
# How many times what a found amount leaves a rounder one may. Least squares leave less of rounded numbers
# than what was meant: of 5 that one amount is fitted to by a root of 5/4 on average.
KEPT = 1.5
# How many times what the best change leaves another may leave.
POORER = 30.0


@dataclass(frozen=True)
class Change:
    """A number of a scene that may be another one.

    Attributes:
        key: which it is.
        put: puts another one into the scene's content.
        words: what is said of another one.
        slope: of the numbers of rows by it, at a few instants, one after the other; or a step of differences.
        ours: what it is in the scene. farthest: from ours that it may be.
        cost: how far-fetched another one is.
        silent: points whose numbers say nothing of it.
        late: whether the motion is read so much later.
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
        """That of the scene with another number; None where it has none."""
        return evidence.solved.other((self.key, amount), lambda content: self.put(content, amount))

    def read(self, evidence: Evidence, looked: Sequence[Row], amount: float) -> Array | None:
        """The numbers of rows with another number, one after the other; None where there are none."""
        there = abs(amount - self.ours) < self.farthest
        motion = self.motion(evidence, amount) if there else None
        if motion is None:
            return None
        return numbers_in(motion.at(evidence.times + amount * self.late).numbers, looked)

    def supposed(self, evidence: Evidence, amount: float) -> Iterator[Hypothesis]:
        """The whole car with another number."""
        motion = self.motion(evidence, amount)
        if motion is not None and amount != self.ours:
            # A hardpoint is drawn at a round number, and a link is off by one.
            decimals = min(map(_decimals, (amount, round(amount - self.ours, DECIMALS))))
            rows = _rows_of(evidence, motion, amount * self.late)
            told = {row: would for row, would in rows.items() if row.name not in self.silent}
            words = self.words(amount)
            yield Hypothesis(words, told, 1, self.cost, key=self.key, decimals=decimals, whole=True)


def _rows_of(evidence: Evidence, motion: Motion, later: float = 0.0) -> dict[Row, WouldBe]:
    """What each row would be of another motion, and how far from that it may be.

    Args:
        later: when the motion is read, s after the instants.
    """
    samples = motion.at(evidence.times + later)
    proven = motion.proof_of(samples, rates=True).proven
    rows: dict[Row, WouldBe] = {}
    for row in evidence.held:
        quantity, name = row
        if name in samples.numbers[quantity]:
            value = np.array(samples.numbers[quantity][name])
            # These are off by their own bound, and by as much again for what numbers of its laws, such as a
            # factor that is found, are rounded by.
            bound = np.nan_to_num(proven[quantity][name], posinf=0.0)
            allowed = 2.0 * (evidence.rounded(row, value) + bound)
            if later:
                # What is claimed varies along the motion: the most of it, since it is read elsewhere. And
                # instants are rounded, and so moves what is read there.
                speed = np.abs(np.gradient(value, evidence.times, axis=0)).max()
                rounding = 8.0 * EPS * speed * (abs(later) + np.abs(evidence.times).max())
                allowed = np.full_like(value, allowed.max(axis=0) + rounding)
            rows[row] = (value, allowed)
    return rows


def _decimals(amount: float) -> int:
    return next((n for n in range(DECIMALS) if round(amount, n) == amount), DECIMALS)


def _fitted(change: Change, evidence: Evidence, looked: Sequence[Row]) -> tuple[float, float] | None:
    """The number that gives those of some rows, as round as these tell, and what it leaves of them.

    By the secant method; None where that leaves much of the difference.
    """
    ours, theirs, off = evidence.joined(looked)
    start = change.ours
    if not np.isfinite(ours - theirs).all():
        return None

    @cache
    def gap_at(amount: float) -> Array:
        found = ours if amount == start else change.read(evidence, looked, amount)
        gap = np.full(len(ours), np.nan) if found is None else found - theirs
        # A number that there is none of is as far off as can be.
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
    amount, more = start, _step(slope, gap_at(start))
    if not np.linalg.norm(gap_at(start) + more * slope) <= LIKELY * left(start):
        return None
    while gone := next((part * more for part in PARTS if left(amount + part * more) < left(amount)), 0.0):
        before, amount = amount, amount + gone
        if left(amount) > MANIFOLD * left(before):
            break
        slope = (gap_at(amount) - gap_at(before)) / gone
        more = _step(slope, gap_at(amount))
    least = left(amount)

    def kept(one: Array) -> bool:
        return left(float(one)) <= KEPT * least and within(float(one), 1.0)

    if within(amount, NEARLY):
        amount = float(roundest(amount, kept))
    elif least > PROMISING * left(start):
        return None
    return amount, left(amount)


def _step(slope: Array, gap: Array) -> float:
    """By how much more the gap is least, were it linear."""
    square = float(slope @ slope)
    return -float(slope @ gap) / square if square > 0.0 else 0.0


def otherwise(
    evidence: Evidence,
    words: str,
    put: Callable[[Content], None],
    cost: float = 1.0,
    solve: Callable[[Scene], Motion] = simulate,
) -> Iterator[Hypothesis]:
    """The whole car with another content of its scene, if it can be solved so."""
    motion = evidence.solved.other(words, put, solve)
    if motion is not None:
        yield Hypothesis(words, _rows_of(evidence, motion), cost=cost, whole=True)


def any_of(evidence: Evidence, changes: Sequence[Change]) -> Iterator[Hypothesis]:
    """Each of some numbers by itself, by what tells most; where none gives all of that, by all but one of it.

    A number that has a fault of its own hides what the others say, and positions in another unit what angles
    do.
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
    """Numbers of one unit that disagree: positions, angles, as far as there are any, else the first."""
    of_a_pose = (
        tuple(row for row in evidence.wrong if row.unit == unit and row.order == 0) for unit in ("mm", "rad")
    )
    first = tuple(row for row in evidence.wrong if row.quantity == evidence.wrong[0].quantity)
    return tuple(filter(None, of_a_pose)) or (first,)


def _gives(evidence: Evidence, one: Hypothesis, rows: Sequence[Row]) -> bool:
    """Whether another car explains rows whole, and leaves right what agrees."""
    agree = (row for row in one.rows if row not in evidence.wrong)
    return evidence.explained({row: one.rows[row] for row in (*rows, *agree)})
