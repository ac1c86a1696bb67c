"""An independent column that is meant with another sign, unit or zero, found by one straight line.

The numbers of a row say themselves at which input it is: Gauss and Newton's method finds the input whose pose
has them. Over the rows of the file an input x so found is a straight line x = k v + c over its column v: k is
a sign and a unit, c another zero. What is found at some rows is held to the whole file.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pointcoord import PointcoordError
from validate.diagnosis import Explanation
from validate.diagnosis.evidence import Row
from validate.measured.mapping import Measured, Series
from validate.measured.meanings import INPUT
from validate.measured.poses import Driven, ours_of
from validate.measured.tolerances import Held, held_of
from validate.plain_text import shown
from validate.tables.units import ANGLES, KINDS, named

Array = NDArray[np.float64]

ROWS = 16  # that inputs are found at
NEARLY_ALL = 0.8  # of them must be in reach
# Of an input's range: of differences, the longest step, and where steps end.
STEP, LONGEST, ENDS = 1e-6, 0.1, 1e-9
STEPS = 25
LEAST = 1e-9  # of a spread, in our units
NEARLY = 1.5  # tolerances that may be left of the whole file: least squares make no largest difference least
NOTHING = 1e-4  # of the input's own size: a zero that is none
UNIT = 0.01  # of a unit: how far off a slope is that one still


def meant_otherwise(
    driven: Driven,
    measured: Measured,
    held: Sequence[Held],
    accuracy: float | None,
    factor: float,
    wrong: Sequence[Row],
) -> Explanation | None:
    """What explains the whole file: one of its columns with another sign, unit or zero; over time nothing.

    Args:
        wrong: what disagrees.
    """
    for words, other in _suppositions(driven, measured):
        try:
            found = held_of(other, driven, accuracy)[0]
        except PointcoordError:
            continue
        leftover = float(np.nanmax([h.share for h in found], initial=0.0)) / factor
        # Fewer rows that agree are no explanation of those that are out of reach then.
        if leftover <= NEARLY and _reached(found) >= _reached(held):
            return Explanation(words, "input", tuple(map(".".join, wrong)), leftover)
    return None


def _reached(held: Sequence[Held]) -> int:
    """How many rows have numbers of ours."""
    return int(np.isfinite([h.ours for h in held]).any(axis=0).sum())


def _suppositions(driven: Driven, measured: Measured) -> Iterator[tuple[str, Measured]]:
    """The file with one column as it may be meant, by some of its rows, and what that is in words."""
    numbers = tuple(s for s in measured.numbers if s.meaning.of_a_pose)
    if driven.over_time or not numbers:
        return
    rows = np.zeros(len(measured.rows), dtype=bool)
    rows[np.unique(np.linspace(0, len(rows) - 1, ROWS).astype(int))] = True
    some = replace(measured, numbers=numbers).taken(rows)
    for i, (one, s) in enumerate(zip(measured.independent, some.independent, strict=True)):
        x = _implied(driven, some, s.meaning.drives)
        if x is not None and (line := _line(s, x, driven)):
            factor, zero, words = line
            columns = list(measured.independent)
            columns[i] = replace(one, values=factor * one.values + zero, off=abs(factor) * one.off)
            yield words, replace(measured, independent=tuple(columns))


def _implied(driven: Driven, some: Measured, name: str) -> Array | None:
    """The input that each row's numbers come from, the others being as said; NaN where there is none."""
    if name not in driven.sensible:
        return None  # it moves the whole car
    here, _ = driven.inputs([s.values for s in some.independent])
    spread = np.ptp(np.nan_to_num([s.values for s in some.numbers]), axis=1)
    # By their digits: a column that hardly changes says little of where its rows are.
    wide = np.maximum([np.nanmax(s.off) for s in some.numbers], LEAST * np.maximum(spread, 1.0))
    low, high = driven.sensible[name]
    size, x = high - low, np.full(len(some.rows), driven.drawn[name])

    def gaps(x: Array) -> Array:
        """Ours less theirs, of their last digit, (columns, rows)."""
        found = driven.solved({**here, name: x}, {})
        ours = [ours_of(s, found)[0] for s in some.numbers]
        apart = [s.apart(one, s.values) for s, one in zip(some.numbers, ours, strict=True) if one is not None]
        return np.asarray(np.stack(apart) / wide[:, None])

    try:
        for _ in range(STEPS):
            gap = gaps(x)
            slope = (gaps(x + STEP * size) - gap) / STEP
            square = np.nansum(slope**2, axis=0)
            step = np.divide(np.nansum(slope * gap, axis=0), square, out=np.zeros_like(x), where=square > 0.0)
            x = np.clip(x - size * np.clip(step, -LONGEST, LONGEST), low, high)
            if np.abs(step).max() <= ENDS:
                break
        there = np.isfinite(gaps(x)).any(axis=0)
    except PointcoordError:
        return None
    found = np.where(there, x - driven.level(name), np.nan)
    return found if there.mean() >= NEARLY_ALL else None


def _line(s: Series, x: Array, driven: Driven) -> tuple[float, float, str] | None:
    """x = factor v + zero of a column v, with words; None where the column is as it is said or no line is."""
    some = np.isfinite(x) & np.isfinite(s.values)
    v, x = s.values[some], x[some]
    if len(v) < 2 or not np.ptp(v):
        return None
    slope, _ = np.polyfit(v, x, 1)
    known = [sign * size / s.factor for size in KINDS[s.meaning.unit].values() for sign in (1.0, -1.0)]
    factor = min(known, key=lambda one: abs(one - slope))
    if abs(factor - slope) > UNIT * abs(slope):
        return None
    unit = ANGLES["deg"] if s.meaning.unit == "rad" else s.factor
    zeros, near = x - factor * v, NOTHING * float(np.abs(x).max())
    # To the digits that their scatter leaves of the mean.
    scatter = float(np.std(zeros)) / math.sqrt(len(zeros))
    digits = -math.floor(math.log10(max(scatter / unit, LEAST)))
    zero = unit * round(float(np.mean(zeros)) / unit, digits)
    drawn = driven.drawn[s.meaning.name] if s.meaning.kind == INPUT else 0.0
    zero = next((one for one in (0.0, drawn) if abs(zero - one) <= near), zero)
    other, parts = named(abs(factor) * s.factor, s.meaning.unit), list[str]()
    if (said := named(s.factor, s.meaning.unit)) != other:
        parts.append(f"is in {other}, not in {said}")
    if factor < 0.0:
        parts.append("has the other sign")
    if zero == drawn != 0.0:
        parts.append("counts from the drawing on")
    elif zero:
        parts.append(f"counts from another zero: {zero / unit:+.4g} {named(unit, s.meaning.unit)} make ours")
    return (factor, zero, f"{shown(s.column)} {', and '.join(parts)}") if parts else None
