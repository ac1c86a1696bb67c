"""A fit as plain data, its corrections as a table, and the corrected scene as a file."""

from __future__ import annotations

import csv
import io
from dataclasses import asdict
from typing import Any

from validate.fitting.fit import CONFIDENCE, Fit
from validate.fitting.words import counted, unseen_words, warnings_of_fit
from validate.plain_text import shown
from validate.toml_written import written


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
        "coordinates": _coordinates(fit),
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
    rows = _coordinates(fit)
    names = {"deviation": "standard_deviation", "low": "low_95", "high": "high_95"}
    text = io.StringIO()
    writer = csv.writer(text)
    heads = (names.get(key, key) for key in rows[0])
    writer.writerow([head if head in ("coordinate", "on_bound") else f"{head} [mm]" for head in heads])
    for row in rows:
        writer.writerow([str(value).lower() if isinstance(value, bool) else value for value in row.values()])
    return text.getvalue()


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


def _coordinates(fit: Fit) -> list[dict[str, Any]]:
    """Each coordinate; nothing is known of one that is held on its bound."""
    rows = [{"coordinate": name, **asdict(one)} for name, one in fit.coordinates.items()]
    return [r | (dict.fromkeys(("deviation", "low", "high")) if r["on_bound"] else {}) for r in rows]
