"""Writes plain data as TOML."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence


def written(table: Mapping[str, object], place: tuple[str, ...] = ()) -> list[str]:
    """The lines of a table: its values first, then its subtables."""
    inner = {key: value for key, value in table.items() if isinstance(value, Mapping)}
    plain = [f"{key_of(key)} = {value_of(value)}" for key, value in table.items() if key not in inner]
    lines = (["", f"[{'.'.join(map(key_of, place))}]"] if place and plain else []) + plain
    return lines + [line for key, value in inner.items() for line in written(value, (*place, key))]


def key_of(key: str) -> str:
    """A key, in quotes where it needs them."""
    return key if re.fullmatch(r"[A-Za-z0-9_-]+", key) else value_of(key)


def value_of(value: object) -> str:
    """A value on one line. A JSON string of printable text is also a valid TOML string."""
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, Mapping):
        return f"{{ {', '.join(f'{key_of(k)} = {value_of(v)}' for k, v in value.items())} }}"
    return f"[{', '.join(map(value_of, value))}]" if isinstance(value, Sequence) else repr(value)
