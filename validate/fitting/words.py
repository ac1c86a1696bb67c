"""A fit in words, as plain data, its corrections as a table, and the corrected scene as a file."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import qr

from validate.extras import needed
from validate.fitting.fit import CONFIDENCE, Combination, Fit
from validate.plain_text import shown
from validate.tables.units import degrees_of
from validate.toml_written import written

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
    for unit, (before, after, count) in fit.rms.items():
        lines.append(f"  r.m.s. {_of(unit, before)} before, {_of(unit, after)} after ({count} numbers)")
    for column in fit.columns:
        parts = (_of(column.unit, part) for part in (column.before, column.after, column.known_to))
        lines.append(f"    {shown(column.column)}: " + "{} before, {} after; known to {}".format(*parts))
    more = f"{fit.factor:.3g} times what" if fit.factor > 1.0 else "no more than"
    lines += [
        f"  what is left is {more} the digits explain",
        "",
        f"  correction, mm, within +-{fit.bounds:g}, its standard deviation, and where it lies "
        f"{100.0 * CONFIDENCE:g} times in 100",
    ]
    width = max(len(at) for at in fit.coordinates)
    for at, one in fit.coordinates.items():
        known = f"+- {one.deviation:.2g}   {one.low:+z.4f} to {one.high:+z.4f}"
        known = "  on its bound, and held there" if one.on_bound else known
        lines.append(f"    {at.ljust(width)} {one.correction:+z10.4f} {known}")
    lines += [
        "",
        "  singular values of the scaled Jacobian, 1/mm, and how well each combination is known, mm",
    ]
    for combined in fit.combinations:
        known = f"{combined.deviation:.3g}" if combined.seen else "not seen"
        lines.append(f"    {combined.singular_value:10.3g}  {known}")
    if not fit.unseen:
        return "\n".join(
            [*lines, "", "  The data settle every combination of these coordinates: unique near here."]
        )
    unseen = f"{len(fit.unseen)} of {len(fit.combinations)} combinations of coordinates"
    lines += [
        "",
        f"  The answer is not unique: the data cannot see {unseen}. Along these the",
        f"  correction is what the prior of {fit.prior:g} mm makes it, no finding. Any may be added:",
    ]
    return "\n".join([*lines, *(f"    {words}" for words in unseen_words(fit))])


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
    if on := ", ".join(at for at, one in fit.coordinates.items() if one.on_bound):
        found.append(f"{on} would go beyond the bounds of {fit.bounds:g} mm: less might be left")
    if fit.unseen:
        unseen = counted(len(fit.unseen))
        found.append(f"the answer is not unique: the data do not see {unseen} of coordinates")
    return tuple(found)


def counted(number: int) -> str:
    """So many combinations."""
    return f"{number} combination{'' if number == 1 else 's'}"


def unseen_words(fit: Fit) -> list[str]:
    """Which combinations the data cannot see; those that change nothing at all as simply as can be."""
    least = NOTHING * max(one.singular_value for one in fit.combinations)
    nothing = [one for one in fit.unseen if one.singular_value <= least]
    said = [f"{combination(parts, SAID_EXACT)}: changes nothing" for parts in simplest(nothing)]
    weak = (one for one in fit.unseen if one not in nothing)
    return said + [f"{combination(one.parts)}: known to {one.deviation:.2g} mm only" for one in weak]


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
    factor, unit = degrees_of(unit)
    return f"{factor * number:.4g} {unit}"


def data_of(fit: Fit, name: str, source: str) -> dict[str, Any]:
    """Everything that is said of a fit; angles in rad."""
    return {
        "scene": name,
        "data": shown(source),
        "rms": [
            dict(zip(("unit", "before", "after", "count"), (unit, *rms), strict=True))
            for unit, rms in fit.rms.items()
        ],
        "columns": [asdict(one) | {"column": shown(one.column)} for one in fit.columns],
        "coordinates": coordinates_of(fit),
        "combinations": [asdict(one) for one in fit.combinations],
        "unique": not fit.unseen,
        "unseen": unseen_words(fit),
        "left_over_digits": fit.factor,
        "confidence": CONFIDENCE,
        **{key: getattr(fit, key) for key in ("freedom", "bounds", "prior", "converged", "solves")},
        "failures": [shown(failure) for failure in fit.failures],
        "notes": [shown(note) for note in fit.notes],
        "warnings": [*warnings_of_fit(fit)],
    }


def table_of(fit: Fit) -> str:
    """A row for each coordinate (CSV); what one that is held on its bound is known to is left empty."""
    frame = needed("fit", "pandas").DataFrame(coordinates_of(fit))
    frame["on_bound"] = frame["on_bound"].astype(str).str.lower()
    names = {"deviation": "standard_deviation", "low": "low_95", "high": "high_95"}
    lengths = {key: f"{names.get(key, key)} [mm]" for key in frame if key not in ("coordinate", "on_bound")}
    return str(frame.rename(columns=lengths).to_csv(index=False))


def corrected_text(fit: Fit, name: str, source: str) -> str:
    """A scene file (TOML) of the corrected car, with what was done to it in comments."""
    before = [f"# {shown(name)}, its hardpoints fitted to {shown(source)}."]
    before += [
        f"# r.m.s. difference {first:.4g} {unit} before, {last:.4g} {unit} after."
        for unit, (first, last, _) in fit.rms.items()
    ]
    if fit.unseen:
        before.append(f"# Not unique: the data do not see {counted(len(fit.unseen))} of coordinates.")
    for at, one in fit.coordinates.items():
        known = "which is its bound" if one.on_bound else f"standard deviation {one.deviation:.2g} mm"
        before.append(f"# {at} moved by {one.correction:+z.4f} mm, {known}.")
    return "\n".join([*before, *written(fit.scene.model_dump(exclude_none=True))]) + "\n"


def coordinates_of(fit: Fit) -> list[dict[str, Any]]:
    """Each coordinate; nothing is known of one that is held on its bound."""
    rows = [{"coordinate": name, **asdict(one)} for name, one in fit.coordinates.items()]
    return [r | (dict.fromkeys(("deviation", "low", "high")) if r["on_bound"] else {}) for r in rows]
