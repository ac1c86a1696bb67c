"""What would explain a disagreement: faults are supposed one after the other, and the numbers decide.

A fault is claimed for rows whose numbers all come within what they may be off once it is undone. Numbers
that are all one number decide nothing: whatever is fitted to them fits. So a claim needs at least two more
distinct numbers than were fitted, and numbers that are off from more than one value.

Of a row that is off by few times what is allowed nothing is claimed: what is allowed of other numbers is
wider, and would explain it by itself.

The kinds that need only arithmetic come first, then those that solve other cars, each on what is not
explained yet. Two faults are found greedily: what else the numbers of another car have; two of the arithmetic
in the same numbers; and another car once what all numbers may have besides (other axes, signs or units, a
shift, every row one late) is undone.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from pointcoord import PointcoordError, Scene
from pointcoord.effects.registry import QUANTITIES
from validate.comparison.compare import Explanation, Outcome
from validate.diagnosis.evidence import Evidence, Row, Solved, kind_of, length_or_angle, order, together
from validate.diagnosis.hypothesis import Hypothesis, Kind, Stage
from validate.diagnosis.kinds import KINDS

# Instants that pairs of faults are tried at before all are looked at.
FEW = 8
# Instants of which one at an end may be left out, and that are looked through twice more in a second or two.
FEWEST_LATE, MOST_LATE = 8, 2000


@dataclass(frozen=True)
class _Found:
    """A fault that the numbers carry.

    Attributes:
        rows: the disagreeing rows that it explains. leftover: of these.
    """

    hypothesis: Hypothesis
    rows: tuple[Row, ...]
    leftover: float


def explain_outcome(scene: Scene, outcome: Outcome) -> tuple[Explanation, ...]:
    """What would explain that one of two solutions disagrees with the other; the best first.

    The trusted one is the one whose accuracy is proven, and the first where neither's is or both are.

    Returns:
        What explains most rows first, simple before far-fetched. Empty where nothing that is known here
        explains anything.
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
            for one in _ranked(_supposed(undone, "drawing")) if undone.wrong else ():
                if not _open(undone, [one]):
                    told = _in_words(undone, one)
                    return (
                        replace(told, words=f"{told.words}, and {words}", kind=f"{told.kind} and {kind}"),
                    )
    return tuple(_in_words(evidence, one) for one in found)


def _explained(evidence: Evidence) -> list[_Found]:
    """What the numbers carry, the best first."""
    found = _supposed(evidence, "numbers")
    cars: list[_Found] = []
    stages: tuple[Stage, ...] = ("motion", "drawing")
    for stage in stages if evidence.other_cars and _elsewhere(evidence) else ():
        if _open(evidence, [*found, *cars]):
            cars += _supposed(evidence, stage)
    for one in _ranked(cars)[:1]:
        # What other faults the same car has beside it.
        if left := tuple(row for row in evidence.wrong if row not in one.rows):
            found += _supposed(evidence.after(one.hypothesis.rows, left), "numbers")
    found += cars
    if left := _open(evidence, found):
        found += _pairs(replace(evidence, wrong=left))
    if left := _open(evidence, found):
        found += _supposed(replace(evidence, wrong=left), "last")
    return list(_best(_ranked(found)))


def _elsewhere(evidence: Evidence) -> bool:
    """Whether it may be another car or another motion: not where points are given and are in their places."""
    points = [row for row in evidence.given if order(row) == 0 and kind_of(row) == "point"]
    moving = [row for row in points if np.ptp(evidence.held[row], axis=0).any()]
    return not moving or any(row in evidence.wrong for row in moving)


def _open(evidence: Evidence, found: Iterable[_Found]) -> tuple[Row, ...]:
    """The rows that nothing explains yet."""
    done = {row for one in found for row in one.rows}
    return tuple(
        row for row in evidence.wrong if row not in done and evidence.clear(row, evidence.allowed[row])
    )


def _supposed(evidence: Evidence, stage: Stage) -> list[_Found]:
    faults = (one for kind in KINDS if kind.stage == stage for one in _merged(kind, evidence))
    return [found for one in faults if (found := _carried(evidence, one))]


def _merged(kind: Kind, evidence: Evidence) -> Iterable[Hypothesis]:
    """The faults of a kind; the same fault of several quantities is one."""
    merged: dict[Hashable, Hypothesis] = {}
    # A car that cannot be solved, or gives no such numbers, explains nothing.
    with suppress(PointcoordError):
        for one in kind.suppose(evidence) if evidence.over_time or not kind.of_time else ():
            known = merged.get(one.key)
            rows = one.rows if known is None else {**known.rows, **one.rows}
            merged[one.key] = replace(one, kind=kind.name, rows=rows)
    return merged.values()


def _carried(evidence: Evidence, hypothesis: Hypothesis) -> _Found | None:
    """The rows that a fault explains; None if there are none."""
    left: dict[Row, float] = {}
    # What is wrong by so little tells nothing by itself, but is said where the whole car is another.
    barely: list[Row] = []
    for row, (value, allowed) in hypothesis.rows.items():
        share = evidence.left(row, value, allowed)
        if share > 1.0:
            if hypothesis.whole and row not in evidence.wrong:
                return None
        elif row in evidence.wrong:
            if hypothesis.looser or evidence.clear(row, allowed):
                left[row] = share
            elif hypothesis.whole:
                barely.append(row)
    exact = [
        row
        for some in together(left)
        if hypothesis.rests or evidence.distinct(some) > hypothesis.fitted
        for row in some
    ]
    return _Found(hypothesis, (*exact, *barely), max(left[row] for row in exact)) if exact else None


def _pairs(evidence: Evidence) -> Iterator[_Found]:
    """Two faults in the same numbers: the second in what the first makes of ours."""
    for first in (kind for kind in KINDS if kind.opens):
        for one in _merged(first, evidence):
            after = evidence.after(one.rows, tuple(row for row in evidence.wrong if row in one.rows))
            if first.name == "unit":
                after = replace(after, units=dict.fromkeys(after.held, "in its own unit"))
            few = after.thinned(FEW)
            for second in KINDS:
                # Of two kinds that may each be the first, in one order.
                after_it = KINDS.index(second) > KINDS.index(first)
                if (
                    second.closes
                    and (after_it or not first.closes)
                    and any(_carried(few, two) for two in _merged(second, few))
                ):
                    yield from _both(evidence, one, _merged(second, after))


def _both(evidence: Evidence, one: Hypothesis, seconds: Iterable[Hypothesis]) -> Iterator[_Found]:
    for two in seconds:
        both = replace(
            two,
            key=(one.key, two.key),
            kind=f"{one.kind} and {two.kind}",
            words=f"{one.words}, and {two.words}",
            fitted=one.fitted + two.fitted,
            cost=one.cost + two.cost + 1.0,
            looser=False,
        )
        if found := _carried(evidence, both):
            yield found


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
    for words, undone in _without_a_late_sample(evidence):
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


def _without_a_late_sample(evidence: Evidence) -> Iterator[tuple[str, Evidence]]:
    """The same without an end, in words, if every number that changes may be one row late or early."""
    moving = {row for row, values in evidence.held.items() if np.ptp(values, axis=0).max(initial=0.0) > 0.0}
    few = FEWEST_LATE < len(evidence.times) <= MOST_LATE
    if not (few and evidence.over_time) or len(evidence.wrong) < 2 or not moving <= {*evidence.wrong}:
        return
    ends = {
        "one sample late": (slice(1, None), slice(None, -1)),
        "one sample early": (slice(None, -1), slice(1, None)),
    }
    for words, (theirs, ours) in ends.items():
        late = evidence.at(ours, theirs)
        limits = {"start": float(late.times[0]), "stop": float(late.times[-1]), "samples": len(late.times)}
        time = evidence.scene.time.model_copy(update=limits)
        scene = evidence.scene.model_copy(update={"time": time})
        yield words, replace(late, scene=scene, solved=Solved(scene))


def _ranked(found: Iterable[_Found]) -> list[_Found]:
    """More rows before fewer; simple before far-fetched, and rounder amounts first."""

    def place(one: _Found) -> tuple[float, ...]:
        return -len(one.rows), one.hypothesis.cost, one.hypothesis.decimals, one.leftover

    return sorted(found, key=place)


def _best(ranked: Iterable[_Found]) -> Iterator[_Found]:
    """Those that explain what none before them does; or the same rows as simply."""
    kept: list[_Found] = []
    for one in ranked:
        more = [other for other in kept if len(other.rows) > len(one.rows)]
        implied = any(
            {*one.rows} <= {*other.rows}
            and (
                other.hypothesis.cost < one.hypothesis.cost or other.hypothesis.words == one.hypothesis.words
            )
            for other in kept
        )
        if not implied and not {*one.rows} <= {row for other in more for row in other.rows}:
            kept.append(one)
            yield one


def _left_out(evidence: Evidence, found: _Found, quantity: str) -> bool:
    """Whether a quantity has rows that a fault does not explain, or that agree and would not under it."""
    others = (row for row in evidence.held if row[0] == quantity and row not in found.rows)
    return any(
        evidence.left(row, *found.hypothesis.rows[row]) > 1.0
        if row in found.hypothesis.rows
        else row in evidence.wrong or order(row) == 0 or evidence.held[row].any()
        for row in others
    )


def _in_words(evidence: Evidence, found: _Found) -> Explanation:
    quantities: list[str] = []
    said: list[str] = []
    for quantity in evidence.wrong_quantities:
        names = [name for of, name in found.rows if of == quantity]
        words = QUANTITIES[quantity].words
        if names and kind_of((quantity, "")) != "car" and not _left_out(evidence, found, quantity):
            quantities.append(quantity)
            said.append(words)
        elif names:
            quantities += [f"{quantity}.{name}" for name in names]
            of = "" if kind_of((quantity, "")) == "car" else f"{words} of "
            said.append(of + ", ".join(names))
    words = f"{', '.join(said)}: {found.hypothesis.words}"
    return Explanation(words, found.hypothesis.kind, tuple(quantities), found.leftover)
