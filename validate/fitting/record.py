"""A fit as plain data, its corrections as a table, and the corrected scene as a file."""

from __future__ import annotations

import csv
import io
from typing import Any

from validate.fitting.fit import CONFIDENCE, Fit
from validate.fitting.words import counted, unseen_words, warnings_of_fit
from validate.plain_text import shown
from validate.toml_written import written

HEADER = (
    "coordinate",
    "drawn [mm]",
    "correction [mm]",
    "corrected [mm]",
    "standard_deviation [mm]",
    "low_95 [mm]",
    "high_95 [mm]",
    "on_bound",
)


def data_of(fit: Fit, name: str, source: str) -> dict[str, Any]:
    """Everything that is said of a fit; angles in rad."""
    units = dict.fromkeys(column.unit for column in fit.columns)
    return {
        "scene": name,
        "data": shown(source),
        "rms": [
            {"unit": unit, "before": before, "after": after, "count": count}
            for unit, (before, after, count) in ((unit, fit.rms(unit)) for unit in units)
        ],
        "columns": [
            {
                "column": shown(column.column),
                "unit": column.unit,
                "before": column.before,
                "after": column.after,
                "known_to": column.digits,
                "count": column.count,
            }
            for column in fit.columns
        ],
        "coordinates": [_coordinate(fit, one) for one in fit.corrections],
        "combinations": [
            {
                "singular_value": one.singular,
                "deviation": one.deviation,
                "seen": one.seen,
                "parts": one.parts,
            }
            for one in fit.combinations
        ],
        "unique": fit.unique,
        "unseen": unseen_words(fit) if fit.unseen else [],
        "left_over_digits": fit.factor,
        "freedom": fit.freedom,
        "bounds": fit.bounds,
        "prior": fit.prior,
        "confidence": CONFIDENCE,
        "converged": fit.converged,
        "solves": fit.solves,
        "failures": [shown(failure) for failure in fit.failures],
        "notes": [shown(note) for note in fit.notes],
        "warnings": [*warnings_of_fit(fit)],
    }


def table_of(fit: Fit) -> str:
    """A row for each coordinate (CSV); what one that is held on its bound is known to is left empty."""
    text = io.StringIO()
    writer = csv.writer(text)
    writer.writerow(HEADER)
    for one in fit.corrections:
        row = _coordinate(fit, one)
        cells = (
            "" if value is None else str(value).lower() if value in (True, False) else repr(value)
            for value in list(row.values())[1:]
        )
        writer.writerow([one, *cells])
    return text.getvalue()


def corrected_text(fit: Fit, name: str, source: str) -> str:
    """A scene file (TOML) of the corrected car, with what was done to it in comments."""
    content = fit.scene.model_dump(exclude_none=True)
    before = [f"# {shown(name)}, its hardpoints fitted to {shown(source)}."]
    for unit in dict.fromkeys(column.unit for column in fit.columns):
        first, last, _ = fit.rms(unit)
        before.append(f"# r.m.s. difference {first:.4g} {unit} before, {last:.4g} {unit} after.")
    if not fit.unique:
        before.append(f"# Not unique: the data do not see {counted(len(fit.unseen))} of coordinates.")
    before += [
        f"# {one} moved by {amount:+z.4f} mm, "
        + (
            "which is its bound."
            if one in fit.on_bounds
            else f"standard deviation {fit.deviations[one]:.2g} mm."
        )
        for one, amount in fit.corrections.items()
    ]
    return "\n".join([*before, *written(content)]) + "\n"


def _coordinate(fit: Fit, one: str) -> dict[str, Any]:
    held = one in fit.on_bounds
    low, high = fit.interval(one)
    return {
        "coordinate": one,
        "drawn": fit.drawn[one],
        "correction": fit.corrections[one],
        "corrected": fit.drawn[one] + fit.corrections[one],
        "deviation": None if held else fit.deviations[one],
        "low": None if held else low,
        "high": None if held else high,
        "on_bound": held,
    }
