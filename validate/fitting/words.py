"""A fit in words."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import qr

from validate.fitting.fit import CONFIDENCE, Combination, Fit, Fitted
from validate.plain_text import shown

Array = NDArray[np.float64]

# Parts of a combination that are said, of its largest one; all that two decimals show where it is exact.
SAID, SAID_EXACT = 0.2, 0.005
# Singular values below this part of the largest are rounding: differences over 0.02 mm to either side lack
# (0.02 / L)^2 / 6 of a slope, with lines of L = 60 mm and more.
NOTHING = 2e-8
# Times what the digits explain, from which on something else than hardpoints is likelier.
STRANGE = 5.0


def text_of(fit: Fit, name: str, source: str) -> str:
    """Everything that is to be said of a fit."""
    lines = [f"{name}: hardpoints fitted to {source}"]
    for unit in dict.fromkeys(column.unit for column in fit.columns):
        before, after, count = fit.rms(unit)
        lines.append(f"  r.m.s. {_of(unit, before)} before, {_of(unit, after)} after ({count} numbers)")
    lines += [f"    {_column(column)}" for column in fit.columns]
    lines.append(
        f"  what is left is {fit.factor:.3g} times what the digits explain"
        if fit.factor > 1.0
        else "  what is left is no more than the digits explain"
    )
    lines += [
        "",
        f"  correction, mm, within +-{fit.bounds:g}, its standard deviation, and where it lies "
        f"{100.0 * CONFIDENCE:g} times in 100",
    ]
    width = max(len(one) for one in fit.corrections)
    for one, amount in fit.corrections.items():
        deviation = fit.deviations[one]
        said = f"    {one.ljust(width)} {amount:+z10.4f}"
        if one in fit.on_bounds:
            lines.append(f"{said}   on its bound, and held there")
            continue
        low, high = fit.interval(one)
        open_ = "   not known from these data" if one in fit.unknown else ""
        lines.append(f"{said} +- {deviation:.2g}   {low:+z.4f} to {high:+z.4f}{open_}")
    lines += [
        "",
        "  singular values of the scaled Jacobian, 1/mm, and how well each combination is known, mm",
    ]
    lines += [f"    {one.singular:10.3g}  {_known(one)}" for one in fit.combinations]
    if fit.unique:
        lines += [
            "",
            "  The data settle every combination of these coordinates: unique near here.",
        ]
        return "\n".join(lines)
    count = len(fit.unseen)
    lines += [
        "",
        f"  The answer is not unique: the data cannot see {count} of {len(fit.combinations)} combinations of "
        "coordinates.",
        f"  Along these the correction is as small as the prior of {fit.prior:g} mm makes it: a choice, no "
        "finding; fewer --free coordinates narrow it.",
        "  Any of them may be added, to first order:",
    ]
    lines += [f"    {words}" for words in unseen_words(fit)]
    return "\n".join(lines)


def warnings_of_fit(fit: Fit) -> tuple[str, ...]:
    """What must not be overlooked."""
    found = []
    if not fit.converged:
        why = f"; a design on the way could not be solved ({fit.failures[-1]})" if fit.failures else ""
        found.append(
            f"least squares did not end at a minimum, {fit.solves} designs were tried{why}; take fewer "
            "coordinates, closer bounds or a smaller prior"
        )
    if fit.factor > STRANGE:
        found.append(
            f"what is left is {fit.factor:.3g} times what the digits explain: other hardpoints than "
            "these, or another unit, sign or definition of a column; pointcoord validate SCENE --data FILE "
            "says column by column how far they are apart"
        )
    if fit.on_bounds:
        found.append(
            f"{', '.join(fit.on_bounds)} would go beyond the bounds of {fit.bounds:g} mm: less might be left"
        )
    if not fit.unique:
        found.append(
            f"the answer is not unique: the data do not see {counted(len(fit.unseen))} of coordinates"
        )
    return tuple(found)


def counted(number: int) -> str:
    """So many combinations."""
    return f"{number} combination{'' if number == 1 else 's'}"


def unseen_words(fit: Fit) -> list[str]:
    """Which combinations the data cannot see; those that change nothing at all as simply as can be."""
    largest = max(one.singular for one in fit.combinations)
    nothing = [one for one in fit.unseen if one.singular <= NOTHING * largest]
    weak = [one for one in fit.unseen if one not in nothing]
    said = [f"{combination(parts, SAID_EXACT)}: changes nothing" for parts in simplest(nothing)]
    said += [f"{combination(one.parts)}: known to {one.deviation:.2g} mm only" for one in weak]
    return said


def combination(parts: Mapping[str, float], said: float = SAID) -> str:
    """A combination as a sum, largest part first; parts that are small beside it are left out."""
    largest = max(abs(part) for part in parts.values())
    told = sorted(parts.items(), key=lambda one: -abs(one[1]))
    some = [(name, part / largest) for name, part in told if abs(part) >= said * largest]
    if len(some) == 1:
        return some[0][0]
    sign = math.copysign(1.0, some[0][1])
    words = " ".join(f"{'-' if sign * part < 0.0 else '+'} {abs(part):.2f} {name}" for name, part in some)
    return words.removeprefix("+ ")


def simplest(found: Sequence[Combination]) -> list[dict[str, float]]:
    """The same space of combinations by ones of few coordinates: each has one of its own, by pivoting."""
    if not found:
        return []
    rows = np.array([[*one.parts.values()] for one in found])
    _, order = qr(rows, mode="r", pivoting=True)
    few = np.linalg.solve(rows[:, order[: len(rows)]], rows)
    return [dict(zip(found[0].parts, row.tolist(), strict=True)) for row in few]


def _of(unit: str, number: float) -> str:
    if unit.startswith("rad"):
        return f"{math.degrees(number):.4g} deg{unit.removeprefix('rad')}"
    return f"{number:.4g} {unit}"


def _column(column: Fitted) -> str:
    parts = (_of(column.unit, part) for part in (column.before, column.after, column.digits))
    before, after, digits = parts
    return f"{shown(column.column)}: {before} before, {after} after; known to {digits}"


def _known(one: Combination) -> str:
    return f"{one.deviation:.3g}" if one.seen else "not seen"
