"""Shipped scenes with some of their values changed."""

from __future__ import annotations

import csv
import tomllib
from collections.abc import Mapping
from typing import Any

from pointcoord import Scene

Content = dict[str, Any]


def content_of(
    name: str,
    mechanism: Mapping[str, Any] | None = None,
    *,
    laws: Mapping[str, Any] | None = None,
    samples: int = 0,
    **parts: Any,
) -> Content:
    """A shipped scene as plain data, changed.

    Args:
        mechanism: keys of its mechanism, of which `points` are beside its own. laws: of inputs, likewise.
        samples: instants, where it is to have another number of them. parts: others of its own.
    """
    content = Scene.load(name).model_dump(mode="json", exclude_none=True)
    part, changes = content["mechanism"], dict(mechanism or {})
    part["points"] |= changes.pop("points", {})
    part |= changes
    content["inputs"] |= laws or {}
    content["time"]["samples"] = samples or content["time"]["samples"]
    return content | parts


def scene_with(name: str, mechanism: Mapping[str, Any] | None = None, **changes: Any) -> Scene:
    """The scene of that."""
    return Scene.from_mapping(content_of(name, mechanism, **changes), name)


def change(content: Content, changes: str) -> Content:
    """Content after changes, `key = value` in TOML or `key gone`, between `;`; dots lead into tables."""
    for one in changes.split(" ; "):
        key, given, value = one.partition(" = ")
        *tables, last = next(csv.reader([key.strip().removesuffix(" gone")], delimiter="."))
        box = content
        for table in tables:
            box = box[table]
        if given:
            box[last] = tomllib.loads(f"value = {value}")["value"]
        else:
            box.pop(last, None)
    return content
