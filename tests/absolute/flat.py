"""Mechanism files as the flat data that models are given: just enough of the format for the tests here."""

import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import absolute

SHIPPED = Path(__file__).parents[2] / "pointcoord" / "mechanisms"
DRIVEN = ("arm_angle", "rack")


def flat(
    file: Mapping[str, Any],
    points: Mapping[str, Any],
    driven: Sequence[str],
    *,
    up: Sequence[float] = (0.0, 0.0, 1.0),
    right: Sequence[float] = (0.0, 1.0, 0.0),
    side: str = "left",
    closure: str = "drawn",
    wheel_radius: float | None = None,
) -> dict[str, Any]:
    """The tables of a file with a drawing: its closure put in, its stand-ins drawn."""
    tables = {
        name: dict(file.get(name, {}))
        for name in ("bodies", "rods", "slides", "inputs", "roles", "stand_ins")
    }
    for name, entries in (file["closures"][closure] if closure != "drawn" else {}).items():
        tables[name] |= entries
    place = dict(points)
    for point, other in tables.pop("stand_ins").items():
        if point in place:
            continue
        if point in tables["bodies"]["chassis"]:
            place[point] = place[other]
        else:
            roles = tables["roles"].items()
            tables["roles"] = {role: _put(names, point, other) for role, names in roles}
    tables["bodies"] = {
        body: [name for name in names if name in place or name not in file.get("stand_ins", {})]
        for body, names in tables["bodies"].items()
    }
    slides = {
        name: {"body": "chassis", "turns": True, **slide, "points": slide.get("points", [slide.get("point")])}
        for name, slide in tables["slides"].items()
    }
    inputs = {name: dict(tables["inputs"][name]) for name in driven}
    for given in inputs.values():
        if isinstance(given.get("travel"), str):
            given["travel"] = [given["travel"]]
    return {
        **tables,
        "name": file["title"],
        "slides": slides,
        "inputs": inputs,
        "points": place,
        "up": up,
        "right": right,
        "side": side,
        "wheel_radius": wheel_radius,
    }


def _put(names: Any, point: str, other: str) -> Any:
    if isinstance(names, str):
        return other if names == point else names
    return [other if name == point else name for name in names]


def shipped(name: str) -> dict[str, Any]:
    """The tables of a shipped file."""
    return tomllib.loads((SHIPPED / f"{name}.toml").read_text(encoding="utf-8"))


def built_in(
    kind: str, points: Mapping[str, Any], driven: Sequence[str] = DRIVEN, **told: Any
) -> absolute.Model:
    """A shipped mechanism with a drawing."""
    return absolute.compile(flat(shipped(kind), points, driven, **told))
