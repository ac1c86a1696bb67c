"""Finds a wrong sign, unit or zero of an independent column from a straight line.

The numbers of a row determine its input: least squares find the input whose pose has these numbers. If the
column v has a wrong sign, unit or zero, the inputs x of the rows are on a straight line x = k v + c: k gives
the sign and the unit, c the zero. The line found from some rows is tested on the whole file.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from scipy.optimize import least_squares

from pointcoord import PointcoordError
from validate.arrays import Array
from validate.diagnosis import Explanation
from validate.diagnosis.evidence import Row
from validate.measured.mapping import Measured, Series
from validate.measured.meanings import INPUT
from validate.measured.poses import Driven, columns_of
from validate.measured.tolerances import Held, held_of
from validate.plain_text import shown
from validate.tables.units import ANGLES, KINDS, named

ROWS = 16  # number of rows at which inputs are found
NEARLY_ALL = 0.8  # least share of these rows that must be within reach
STEPS = 25  # of least squares
LEAST = 1e-9  # least relative width of a column of numbers
NEARLY = 1.5  # allowed difference / tolerance in the whole file: least squares do not minimise the largest
NOTHING = 1e-4  # a zero below this share of the input's size counts as none
UNIT = 0.01  # largest relative difference of the slope from that of a known unit


def meant_otherwise(
    driven: Driven,
    measured: Measured,
    held: Sequence[Held],
    accuracy: float | None,
    factor: float,
    wrong: Sequence[Row],
) -> Explanation | None:
    """The explanation that one independent column has another sign, unit or zero; None if it does not fit.

    Args:
        wrong: the rows that disagree.
    """
    for words, other in _suppositions(driven, measured):
        try:
            found = held_of(other, driven, accuracy)[0]
        except PointcoordError:
            continue
        leftover = float(np.nanmax([h.share for h in found], initial=0.0)) / factor
        # It is no explanation if more rows are then out of reach.
        if leftover <= NEARLY and _reached(found) >= _reached(held):
            return Explanation(words, "input", tuple(map(".".join, wrong)), leftover)
    return None


def _reached(held: Sequence[Held]) -> int:
    """The number of rows at which we have numbers."""
    return int(np.isfinite([h.ours for h in held]).any(axis=0).sum())


def _suppositions(driven: Driven, measured: Measured) -> Iterator[tuple[str, Measured]]:
    """For each independent column with a wrong meaning: the fault in words, and the corrected file."""
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
    """The input that fits the numbers of each row, with the other inputs as given; NaN where none fits."""
    if name not in driven.sensible:
        return None  # this input moves the whole car
    here, _ = driven.inputs([s.values for s in some.independent])
    spread = np.ptp(np.nan_to_num([s.values for s in some.numbers]), axis=1)
    # Weighted by their rounding: a column that hardly changes says little about the input.
    wide = np.maximum([np.nanmax(s.off) for s in some.numbers], LEAST * np.maximum(spread, 1.0))
    count, (low, high) = len(some.rows), driven.sensible[name]

    def gaps(x: Array) -> Array:
        """Our numbers minus the given ones, over their rounding, (columns, rows)."""
        found = driven.solved({**here, name: x}, {})
        ours = columns_of(some.numbers, found.numbers, len(x))
        apart = [s.apart(one, s.values) for s, one in zip(some.numbers, ours, strict=True)]
        return np.asarray(apart / wide[:, None])

    try:
        # The numbers of a row depend on the input of this row alone.
        x = least_squares(
            lambda x: np.nan_to_num(gaps(x)).ravel(),
            np.full(count, np.clip(driven.drawn[name], low, high)),
            jac_sparsity=np.tile(np.eye(count), (len(some.numbers), 1)),
            bounds=(low, high),
            x_scale=high - low,
            max_nfev=STEPS,
        ).x
        there = np.isfinite(gaps(x)).any(axis=0)
    except PointcoordError:
        return None
    found = np.where(there, x - driven.level(name), np.nan)
    return found if there.mean() >= NEARLY_ALL else None


def _line(s: Series, x: Array, driven: Driven) -> tuple[float, float, str] | None:
    """The line x = factor v + zero of a column v, in words; None if it is x = v, or if there is no line."""
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
    # The mean is rounded to the digits that its scatter allows.
    scatter = float(np.std(zeros)) / math.sqrt(len(zeros))
    digits = -math.floor(math.log10(max(scatter / unit, LEAST)))
    zero = unit * round(float(np.mean(zeros)) / unit, digits)
    drawn = driven.drawn[s.meaning.name] if s.meaning.kind == INPUT else 0.0
    zero = next((one for one in (0.0, drawn) if abs(zero - one) <= near), zero)
    other, parts = named(abs(factor) * s.factor, s.meaning.unit), list[str]()
    if (given := named(s.factor, s.meaning.unit)) != other:
        parts.append(f"is in {other}, not in {given}")
    if factor < 0.0:
        parts.append("has the other sign")
    if zero == drawn != 0.0:
        parts.append("counts from the drawing")
    elif zero:
        parts.append(f"counts from another zero: add {zero / unit:+.4g} {named(unit, s.meaning.unit)}")
    return (factor, zero, f"{shown(s.column)} {', and '.join(parts)}") if parts else None
