"""Finds possible explanations of a disagreement: possible faults are tried one after the other.

A fault explains a row if, with the fault applied to the trusted numbers, all given numbers are within their
tolerances. If all numbers of a row are equal, any fitted parameter matches them. So an explanation needs at
least two more distinct numbers than fitted parameters, and differences from more than one value.

A row whose difference is only a few times its tolerance is not explained: recomputed numbers have wider
tolerances, which alone could explain the difference.

Kinds of faults that need only arithmetic come first, then kinds that solve other cars; each is tried on the
rows that are not yet explained. Pairs of faults are searched greedily: a further fault in the numbers of
another car, and two arithmetic faults in the same numbers.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import replace

import numpy as np

from pointcoord import PointcoordError, Scene
from pointcoord.effects.registry import QUANTITIES
from validate.comparison.compare import Explanation, Outcome
from validate.diagnosis.evidence import Evidence, Row, together
from validate.diagnosis.fault import Fault, Kind, Stage
from validate.diagnosis.kinds import KINDS

# An unexplained row is reported as wrong in part if it agrees at least at this share of the instants.
LEAST_RIGHT = 0.25


def explain_outcome(scene: Scene, outcome: Outcome) -> tuple[Explanation, ...]:
    """Possible explanations of a disagreement between two solutions, the best first.

    The trusted solution is the one whose accuracy is proven; if both or neither are proven, the first one.

    Returns:
        Explanations of most rows first, simple before far-fetched ones. Empty if no known kind of fault
        explains any row.
    """
    one, two = outcome.solutions
    trusted, given = (two, one) if two.accuracy.proven and not one.accuracy.proven else (one, two)
    return explain_evidence(Evidence.of(scene, given, trusted, outcome)) if outcome.disagreements else ()


def explain_evidence(evidence: Evidence) -> tuple[Explanation, ...]:
    """Possible explanations of the wrong rows of some evidence, the best first, as `explain_outcome`."""
    if not evidence.wrong or not len(evidence.times):
        return ()
    found = _explained(evidence)
    return (*(_in_words(evidence, one) for one in found), *_wrong_in_part(evidence, found))


def _wrong_in_part(evidence: Evidence, found: Iterable[Fault]) -> Iterator[Explanation]:
    """Where unexplained rows disagree, if that is one stretch and they agree at a share of all instants."""
    rows_of: dict[tuple[int, int], list[Row]] = {}
    for row in _open(evidence, found):
        right = evidence.gap(row, evidence.trusted[row]) <= evidence.off_by(row)
        places = np.flatnonzero(~right.reshape(len(right), -1).all(axis=-1)).tolist()
        if len(places) == places[-1] - places[0] + 1 <= (1.0 - LEAST_RIGHT) * len(right):
            rows_of.setdefault((places[0], places[-1]), []).append(row)
    for (first, last), rows in rows_of.items():
        where, end = evidence.label(first), evidence.label(last)
        where = f"at {where} only" if first == last else f"from {where} to {end} only"
        noun = "rows" if evidence.labels else "instants"
        words = f"disagrees {where}, {last - first + 1} of {len(evidence.times)} {noun}"
        share = max(evidence.left(row, evidence.trusted[row], evidence.allowed[row]) for row in rows)
        yield _in_words(evidence, Fault(words, {}, kind="part", explains=tuple(rows), leftover=share))


def _explained(evidence: Evidence) -> list[Fault]:
    """The faults that explain rows, the best first."""
    found = _supposed(evidence, "numbers")
    cars: list[Fault] = []
    stages: tuple[Stage, ...] = ("motion", "drawing")
    for stage in stages if evidence.other_cars and _elsewhere(evidence) else ():
        if _open(evidence, [*found, *cars]):
            cars += _supposed(evidence, stage)
    for one in _ranked(cars)[:1]:
        # Further faults in the numbers of this other car.
        if left := tuple(row for row in evidence.wrong if row not in one.explains):
            found += _supposed(evidence.after(one.rows, left), "numbers")
    found += cars
    if left := _open(evidence, found):
        found += _pairs(replace(evidence, wrong=left))
    if left := _open(evidence, found):
        found += _supposed(replace(evidence, wrong=left), "last")
    return list(_best(_ranked(found)))


def _elsewhere(evidence: Evidence) -> bool:
    """Whether another car or motion is possible: not if moving points are given and all are right."""
    moving = [row for row in evidence.given if row.is_place and np.ptp(evidence.trusted[row], axis=0).any()]
    return not moving or any(row in evidence.wrong for row in moving)


def _open(evidence: Evidence, found: Iterable[Fault]) -> tuple[Row, ...]:
    """The wrong rows that are not explained yet."""
    done = {row for one in found for row in one.explains}
    return tuple(
        row for row in evidence.wrong if row not in done and evidence.clear(row, evidence.allowed[row])
    )


def _supposed(evidence: Evidence, stage: Stage) -> list[Fault]:
    faults = (one for kind in KINDS if kind.stage == stage for one in _merged(kind, evidence))
    return [found for one in faults if (found := _tested(evidence, one))]


def _merged(kind: Kind, evidence: Evidence) -> Iterable[Fault]:
    """The possible faults of a kind; equal faults of several quantities are merged."""
    merged: dict[str, Fault] = {}
    # A car that cannot be solved, or does not give the numbers, explains nothing.
    with suppress(PointcoordError):
        for one in kind.suppose(evidence):
            known = merged[one.words].rows if one.words in merged else {}
            merged[one.words] = replace(one, kind=kind.name, rows={**known, **one.rows})
    return [one for one in merged.values() if one.rows]


def _tested(evidence: Evidence, fault: Fault) -> Fault | None:
    """The fault with the rows that it explains; None if it explains none."""
    left: dict[Row, float] = {}
    # Rows with small differences prove nothing, but are listed if the fault is in the whole car.
    barely: list[Row] = []
    for row, (value, allowed) in fault.rows.items():
        share = evidence.left(row, value, allowed)
        if share > 1.0:
            if fault.whole and row not in evidence.wrong:
                return None
        elif row in evidence.wrong:
            if fault.looser or evidence.clear(row, allowed):
                left[row] = share
            elif fault.whole:
                barely.append(row)
    groups = (some for some in together(left) if evidence.distinct(some) > fault.fitted)
    exact = [row for some in groups for row in some]
    leftover = max((left[row] for row in exact), default=0.0)
    return replace(fault, explains=(*exact, *barely), leftover=leftover) if exact else None


def _pairs(evidence: Evidence) -> Iterator[Fault]:
    """Two faults in the same numbers: the second is sought after the first is applied to trusted numbers."""
    for place, first in enumerate(KINDS):
        for one in _merged(first, evidence) if first.opens else ():
            after = evidence.after(one.rows, tuple(row for row in evidence.wrong if row in one.rows))
            if first.name == "unit":
                after = replace(after, units=dict.fromkeys(after.trusted, ("in its own unit", 1.0)))
            for second in (kind for kind in KINDS[place + 1 :] if kind.closes):
                if any(_tested(after.few, two) for two in _merged(second, after.few)):
                    for two in _merged(second, after):
                        both = replace(
                            two,
                            words=f"{one.words}, and {two.words}",
                            kind=f"{one.kind} and {two.kind}",
                            fitted=one.fitted + two.fitted,
                            cost=one.cost + two.cost + 1.0,
                            looser=False,
                        )
                        if found := _tested(evidence, both):
                            yield found


def _ranked(found: Iterable[Fault]) -> list[Fault]:
    """The faults in order: more rows before fewer, simple before far-fetched, better fits first."""
    return sorted(found, key=lambda one: (-len(one.explains), one.cost, one.leftover))


def _best(ranked: Iterable[Fault]) -> Iterator[Fault]:
    """The faults that explain a row that no better fault explains, or the same rows as simply."""
    kept: list[Fault] = []
    for one in ranked:
        rows = {*one.explains}
        more = {row for other in kept if len(other.explains) > len(rows) for row in other.explains}
        implied = any(
            rows <= {*other.explains} and (other.cost < one.cost or other.words == one.words)
            for other in kept
        )
        if not implied and not rows <= more:
            kept.append(one)
            yield one


def _in_words(evidence: Evidence, fault: Fault) -> Explanation:
    quantities: list[str] = []
    parts: list[str] = []
    for quantity in evidence.wrong_quantities:
        names = [row.name for row in fault.explains if row.quantity == quantity]
        words, of_car = QUANTITIES[quantity].words, QUANTITIES[quantity].of == "car"
        if names and not of_car and _is_whole(evidence, fault, quantity):
            quantities.append(quantity)
            parts.append(words)
        elif names:
            quantities += [f"{quantity}.{name}" for name in names]
            parts.append(("" if of_car else f"{words} of ") + ", ".join(names))
    return Explanation(f"{', '.join(parts)}: {fault.words}", fault.kind, tuple(quantities), fault.leftover)


def _is_whole(evidence: Evidence, fault: Fault, quantity: str) -> bool:
    """Whether a fault explains all rows of a quantity, but for those that agree with the fault too."""
    others = [row for row in evidence.trusted if row.quantity == quantity and row not in fault.explains]
    if any(row in evidence.wrong for row in others):
        return False
    silent = (row for row in others if row not in fault.rows)
    agree = {row: fault.rows[row] for row in others if row in fault.rows}
    return evidence.explained(agree) and not any(evidence.trusted[row].any() for row in silent)
