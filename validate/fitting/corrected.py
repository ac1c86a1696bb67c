"""The corrected scene as a file."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

from validate.fitting.fit import Fit
from validate.fitting.words import counted
from validate.plain_text import shown


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
    return "\n".join([*before, *_lines(content, ())]) + "\n"


def _lines(table: Mapping[str, Any], place: tuple[str, ...]) -> list[str]:
    """A table: its values, then the tables in it."""
    plain = [f"{_key(key)} = {_value(value)}" for key, value in table.items() if not _is_table(value)]
    lines = (["", f"[{'.'.join(map(_key, place))}]"] if place and plain else []) + plain
    for key, value in table.items():
        if _is_table(value):
            lines += _lines(value, (*place, key))
    return lines


def _is_table(value: object) -> bool:
    return isinstance(value, Mapping)


def _key(key: str) -> str:
    return key if key.replace("_", "").replace("-", "").isalnum() and key.isascii() else json.dumps(key)


def _value(value: object) -> str:
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, Sequence):
        return f"[{', '.join(map(_value, value))}]"
    return repr(value)
