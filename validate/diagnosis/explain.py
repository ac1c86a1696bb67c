"""What would explain a disagreement: faults are supposed one after the other, and the numbers decide.

A fault is claimed for rows whose numbers all come within what they may be off once it is undone, or it is
said by what factor it lowers their difference. Numbers that are all one number decide nothing: whatever is
fitted to them fits. So a claim needs at least two more distinct numbers than were fitted, and numbers that
are off from more than one value.

Of a row that is off by few times what is allowed nothing is claimed: what is allowed of other numbers is
wider, and would explain it by itself.

The kinds that need only arithmetic come first, each alone; then those that solve other cars; then two faults
in the same numbers. Where that leaves rows open, what all numbers may have besides (other axes, signs or
units, a shift, every row one late) is undone, and the car is looked for again.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from pointcoord import PointcoordError, Scene
from pointcoord.effects.registry import QUANTITIES
from validate.comparison.compare import Explanation, Outcome
from validate.diagnosis.evidence import Evidence, Row, kind_of, length_or_angle, order, together
from validate.diagnosis.hypothesis import Hypothesis, Kind
from validate.diagnosis.kinds import KINDS, UNIT
from validate.diagnosis.kinds.motions import without_a_late_sample

# By how many times a fault must lower a difference that it does not explain whole. What is fitted to noise
# lowers it by a small factor only.
WORTH = 20.0
# By how many times, so that no other car is solved for what is left.
ENOUGH = 1e3
# By how many times another factor may leave less than a unit's own does, as one fitted to noise may.
FITTED = 2.0
# Instants that pairs of faults are tried at before all are looked at.
FEW = 8


@dataclass(frozen=True)
class _Found:
    """A fault that the numbers carry.

    Attributes:
        rows: the disagreeing rows that it explains.
        leftover: of these. lowered: by what factor it lowers their difference at least.
    """

    hypothesis: Hypothesis
    rows: tuple[Row, ...]
    leftover: float
    lowered: float

    @property
    def whole(self) -> bool:
        """Whether nothing is left to explain of its rows."""
        return self.leftover <= 1.0


def explain_outcome(scene: Scene, outcome: Outcome) -> tuple[Explanation, ...]:
    """What would explain that one of two solutions disagrees with the other; the best first.

    The trusted one is the one whose accuracy is proven, and the first where neither's is or both are.

    Returns:
        What explains whole quantities first, most rows first, simple before far-fetched; then what lowers a
        difference at least twentyfold. Empty where nothing that is known here explains anything.
    """
    one, two = outcome.solutions
    held, given = (two, one) if two.accuracy.proven and not one.accuracy.proven else (one, two)
    return explain_evidence(Evidence.of(scene, given, held, outcome)) if outcome.disagreements else ()


def explain_evidence(evidence: Evidence) -> tuple[Explanation, ...]:
    """The same of numbers that are beside each other already."""
    if not evidence.wrong or not len(evidence.times):
        return ()
    found = _explained(evidence)
    if _open(evidence, found):
        for kind, words, undone in _undone(evidence, found):
            for one in _ranked(_other_cars(undone)):
                if one.whole and not _open(undone, [one]):
                    told = _in_words(undone, one)
                    return (
                        replace(told, words=f"{told.words}, and {words}", kind=f"{told.kind} and {kind}"),
                    )
    return tuple(_in_words(evidence, one) for one in found)


def _undone(evidence: Evidence, found: Iterable[_Found]) -> Iterator[tuple[str, str, Evidence]]:
    """Without a fault that all numbers may have, and that hides which car it is: its kind and its words.

    Axes and signs are supposed where some numbers show them, rows in their neighbours' places always, another
    unit or definition of all angles where it does not make more of their difference.
    """
    hidden = (
        one for kind in KINDS if kind.hides for one in _merged(kind, evidence) if _may_hide(evidence, one)
    )
    for fault in (*(one.hypothesis for one in found), *hidden):
        if fault.undo is not None:
            yield fault.kind, fault.words, evidence.undone(fault.rows, fault.undo)
    for words, undone in without_a_late_sample(evidence):
        yield "sample", words, undone


def _may_hide(evidence: Evidence, fault: Hypothesis) -> bool:
    """Whether all angles that are wrong, two at least, may have a fault."""
    angles = [row for row in evidence.wrong if kind_of(row) == "car" and length_or_angle(row) == "rad"]
    return len(angles) > 1 and all(
        row in fault.rows
        and evidence.left(row, *fault.rows[row])
        <= evidence.left(row, evidence.held[row], evidence.allowed[row])
        for row in angles
    )


def _explained(evidence: Evidence) -> list[_Found]:
    """What the numbers carry, the best first."""
    found = list(_supposed(evidence, "numbers"))
    if _open(evidence, _but_for_moved_points(found), mostly=True):
        cars = _other_cars(evidence)
        found += cars
        for one in _ranked(cars)[:1]:
            # What other faults the same car has beside it.
            left = tuple(row for row in evidence.wrong if row not in one.rows)
            if left and one.whole:
                found += _supposed(evidence.after(one.hypothesis.rows, left), "numbers")
    # What is found from all numbers, such as a shift, may be another one of those that are left.
    for search in (partial(_supposed, stage="numbers"), _pairs, partial(_supposed, stage="last")):
        if left := _open(evidence, found):
            found += search(replace(evidence, wrong=left))
    return list(_best(_ranked(found)))


def _other_cars(evidence: Evidence) -> list[_Found]:
    """What the numbers carry of other motions and cars, one kind after the other until nothing is left."""
    cars: list[_Found] = []
    if not (evidence.other_cars and _elsewhere(evidence)):
        return cars
    for kind in KINDS:
        others = [one for one in cars if one.hypothesis.kind != kind.beside]
        if kind.stage == "car" and not (evidence.parted and kind.of_time) and _open(evidence, others):
            cars += _of_kind(evidence, kind)
    return cars


def _elsewhere(evidence: Evidence) -> bool:
    """Whether it may be another car or another motion: not where points are given and are in their places."""
    points = [row for row in evidence.given if order(row) == 0 and kind_of(row) == "point"]
    moving = [row for row in points if np.ptp(evidence.held[row], axis=0).any()]
    return not moving or any(row in evidence.wrong for row in moving)


def _but_for_moved_points(found: Sequence[_Found]) -> list[_Found]:
    """Without points that are off by a constant each, as those of another car are that hardly moves."""
    apart = [one for one in found if one.hypothesis.kind == "offset" and kind_of(one.rows[0]) == "point"]
    return [one for one in found if one not in apart] if len(apart) > 1 else list(found)


def _open(evidence: Evidence, found: Iterable[_Found], mostly: bool = False) -> tuple[Row, ...]:
    """The rows that nothing explains yet; or nothing explains mostly."""
    done = {
        row
        for one in found
        if one.whole or (mostly and one.lowered >= ENOUGH and not one.hypothesis.fitted)
        for row in one.rows
    }
    return tuple(
        row for row in evidence.wrong if row not in done and evidence.clear(row, evidence.allowed[row])
    )


def _supposed(evidence: Evidence, stage: str) -> list[_Found]:
    return [one for kind in KINDS if kind.stage == stage for one in _of_kind(evidence, kind)]


def _of_kind(evidence: Evidence, kind: Kind) -> list[_Found]:
    found: list[_Found] = []
    if evidence.over_time or not kind.of_time:
        # A car that cannot be solved, or gives no such numbers, explains nothing.
        with suppress(PointcoordError):
            found += [one for fault in _merged(kind, evidence) if (one := _carried(evidence, fault))]
    return found


def _merged(kind: Kind, evidence: Evidence) -> Iterable[Hypothesis]:
    """The faults of a kind; the same fault of several quantities is one."""
    merged: dict[Hashable, Hypothesis] = {}
    for one in kind.suppose(evidence):
        known = merged.get(one.key)
        rows = one.rows if known is None else {**known.rows, **one.rows}
        merged[one.key] = replace(one, kind=kind.name, rows=rows)
    return merged.values()


def _carried(evidence: Evidence, hypothesis: Hypothesis) -> _Found | None:
    """The rows that a fault explains, whole or in part; None if there are none."""
    left: dict[Row, float] = {}
    # What is wrong by so little tells nothing by itself, but is said where the whole car is another.
    barely: list[Row] = []
    for row, (value, allowed) in hypothesis.rows.items():
        share = evidence.left(row, value, allowed)
        if row in evidence.wrong:
            if hypothesis.looser or evidence.clear(row, allowed):
                left[row] = share
            elif hypothesis.whole and share <= 1.0:
                barely.append(row)
        elif hypothesis.whole and share > 1.0:
            return None
    fitted = hypothesis.fitted
    exact = [row for row, share in left.items() if share <= 1.0]
    if not hypothesis.rests:
        exact = [row for some in together(exact) if evidence.distinct(some) > fitted for row in some]
    if exact:
        return _Found(hypothesis, (*exact, *barely), max(left[row] for row in exact), np.inf)
    lowered = {some: _lowered(evidence, hypothesis, some) for some in together(left)}
    partly = {
        some: factor
        for some, factor in lowered.items()
        if factor >= WORTH and evidence.distinct(some) > fitted
    }
    if not partly:
        return None
    rows = tuple(row for some in partly for row in some)
    return _Found(hypothesis, rows, max(left[row] for row in rows), min(partly.values()))


def _lowered(evidence: Evidence, hypothesis: Hypothesis, rows: Sequence[Row]) -> float:
    """By what factor a fault lowers the difference of rows, both in parts of the largest number there.

    That rewards whatever makes theirs small beside it; so a fault counts for no more than the factor by which
    one number leaves more than it does, and none has another unit whose factor is not the one that fits best.
    """
    ours, theirs = (evidence.stacked(rows, part.__getitem__) for part in (evidence.held, evidence.given))
    then = evidence.stacked(rows, lambda row: hypothesis.rows[row][0])
    largest, most = float(np.abs(ours).max()), float(np.abs(then).max())
    if not np.isfinite(theirs).all() or not largest > 0.0 or not most > 0.0:
        return 0.0
    before, apart = float(np.abs(theirs - ours).max()) / largest, float(np.abs(theirs - then).max())
    if not apart > 0.0:
        return np.inf
    lowered = min(before * most / apart, float(np.abs(theirs - theirs.mean(axis=0)).max()) / apart)
    if UNIT in hypothesis.kind.split(" and "):
        factor = float(np.sum(then * theirs) / np.sum(then * then))
        if apart > FITTED * float(np.abs(theirs - factor * then).max()):
            return 0.0
    return lowered


def _pairs(evidence: Evidence) -> list[_Found]:
    """Two faults in the same numbers: the second in what the first makes of ours."""
    largest = [
        max(rows, key=lambda row: np.abs(evidence.held[row]).max()) for rows in together(evidence.wrong)
    ]
    thin = replace(evidence.thinned(FEW), wrong=tuple(largest))
    found: list[_Found] = []
    for first in KINDS:
        if not first.opens or (first.of_time and not evidence.over_time):
            continue
        promising = {key for key, _ in _seconds(thin, first, _merged(first, thin))}
        if promising or first.neighbours:
            faults = [one for one in _merged(first, evidence) if first.neighbours or one.key in promising]
            found += _seconds(evidence, first, faults).values()
    return found


def _seconds(
    evidence: Evidence, first: Kind, faults: Iterable[Hypothesis]
) -> dict[tuple[Hashable, Hashable], _Found]:
    """What faults of one kind and another one after each explain together, by both faults."""
    found: dict[tuple[Hashable, Hashable], _Found] = {}
    # Of two kinds that may each be the first, in one order.
    seconds = [
        kind
        for kind in KINDS
        if kind.closes and not (kind.opens and first.closes and KINDS.index(kind) <= KINDS.index(first))
    ]
    alone = {(kind.name, two.key): two for kind in seconds for two in _merged(kind, evidence)}
    for one in faults:
        after = evidence.after(one.rows, tuple(row for row in evidence.wrong if row in one.rows))
        after = after.without_units() if first.name == UNIT else after
        for two in (two for kind in seconds for two in _merged(kind, after)):
            both = replace(
                two,
                kind=f"{first.name} and {two.kind}",
                words=f"{one.words}, and {two.words}",
                fitted=one.fitted + two.fitted,
                cost=one.cost + two.cost + 1.0,
                looser=False,
            )
            key = two.kind, two.key
            carried = _carried(evidence, both)
            singly = [one, alone[key]] if key in alone else [one]
            if carried is not None and _needed(evidence, singly, carried):
                found[one.key, key] = carried
    return found


def _needed(evidence: Evidence, singly: Sequence[Hypothesis], both: _Found) -> bool:
    """Whether each of two faults adds to what the other one alone explains of the rows."""
    alone = (
        max(evidence.left(row, *one.rows[row]) for row in both.rows)
        for one in singly
        if set(both.rows) <= one.rows.keys()
    )
    return all(left > 1.0 and (both.whole or left >= WORTH * both.leftover) for left in alone)


def _ranked(found: Iterable[_Found]) -> list[_Found]:
    """Whole before in part; more rows, or more of the difference, before less; simple before far-fetched."""

    def place(one: _Found) -> tuple[float, ...]:
        decades = 0.0 if one.whole else -np.floor(np.log10(min(one.lowered, 1e300)))
        supposed = one.hypothesis
        return (not one.whole, -len(one.rows), decades, supposed.cost, supposed.decimals, one.leftover)

    return sorted(found, key=place)


def _best(ranked: Sequence[_Found]) -> Iterator[_Found]:
    """Those that explain what none before them does; or the same rows as simply and as well.

    Of rows that are all explained whole, by several faults if need be, none is explained in part.
    """
    kept: list[_Found] = []
    for one in ranked:
        whole = {row for other in kept if other.whole for row in other.rows}
        better = (not one.whole and whole >= set(one.rows)) or any(
            set(one.rows) <= set(other.rows)
            and (
                other.hypothesis.words == one.hypothesis.words
                or other.whole != one.whole
                or other.hypothesis.cost < one.hypothesis.cost
                or len(other.rows) > len(one.rows)
                or (not one.whole and other.lowered > 2.0 * one.lowered)
            )
            for other in kept
        )
        if not better and not set(one.rows) <= {
            r for other in kept if len(other.rows) > len(one.rows) for r in other.rows
        }:
            kept.append(one)
            yield one


def _left_out(evidence: Evidence, found: _Found, quantity: str) -> bool:
    """Whether a quantity has rows that a fault does not explain, or that agree and would not under it."""
    for row in evidence.held:
        if row[0] != quantity or row in found.rows:
            continue
        if row in found.hypothesis.rows:
            if evidence.left(row, *found.hypothesis.rows[row]) > 1.0:
                return True
        elif (
            row in evidence.wrong
            or order(row) == 0
            or (np.abs(evidence.held[row]) > evidence.rounded(row)).any()
        ):
            return True
    return False


def _in_words(evidence: Evidence, found: _Found) -> Explanation:
    quantities: list[str] = []
    said: list[str] = []
    for quantity in evidence.wrong_quantities:
        rows = [row for row in found.rows if row[0] == quantity]
        if not rows:
            continue
        every = not _left_out(evidence, found, quantity)
        if kind_of(rows[0]) != "car" and every:
            quantities.append(quantity)
            said.append(QUANTITIES[quantity].words)
        else:
            quantities += [f"{quantity}.{name}" for _, name in rows]
            names = ", ".join(name for _, name in rows)
            said.append(names if kind_of(rows[0]) == "car" else f"{QUANTITIES[quantity].words} of {names}")
    words = f"{', '.join(said)}: {found.hypothesis.words}"
    if not found.whole:
        words += f"; this lowers the difference {found.lowered:.2g} times, and does not explain all of it"
    return Explanation(words, found.hypothesis.kind, tuple(quantities), found.leftover)
