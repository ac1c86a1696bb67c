"""A second reader of mechanism files and scenes, written apart from the packages' own.

All models are given what one reader makes of a file; this one shows what that would get wrong.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from mechanism_files import Plain, Tables, full_input, mechanism_file

AXES = ("up", "right", "down", "left", "forward", "rearward")


def read_apart(tables: Tables, part: Mapping[str, Any], driven: Iterable[str]) -> Plain:
    """Tables of a mechanism file and a scene's mechanism, without parts, closures and stand-ins.

    Args:
        part: `points`, and where they are given `closure`, `up`, `right`, `side`, `wheel_radius`.
        driven: names of the inputs that are driven.
    """
    up, right = part.get("up", (0, 0, 1)), part.get("right", (0, 1, 0))
    tables, given = _one_mechanism(copy.deepcopy(tables), dict(part["points"]), right)
    for table, entries in tables.get("closures", {}).get(part.get("closure", "drawn"), {}).items():
        tables[table] |= entries
    slides = {name: _slide(slide) for name, slide in tables.get("slides", {}).items()}
    for name, other in tables.get("stand_ins", {}).items():
        if name not in given and name in tables["bodies"]["chassis"]:
            given[name] = given[other]
    absent = {name: other for name, other in tables.get("stand_ins", {}).items() if name not in given}
    inputs = {name: full_input(tables["inputs"][name]) for name in driven}
    return {
        "name": tables["title"],
        "bodies": {body: [p for p in ps if p not in absent] for body, ps in tables["bodies"].items()},
        "rods": dict(tables.get("rods", {})),
        "slides": slides,
        "inputs": _renamed(inputs, lambda name: absent.get(name, name)),
        "roles": _renamed(tables.get("roles", {}), lambda name: absent.get(name, name)),
        "sides": tables.get("sides", {}),
        "points": given,
        "up": list(up),
        "right": list(right),
        "side": part.get("side", "left"),
        "wheel_radius": part.get("wheel_radius"),
        "rack_per_turn": part.get("rack_per_turn"),
        "car": dict(part.get("car", {})),
        "loads": {},
    }


def _renamed(entry: Any, new: Callable[[str], str]) -> Any:
    """An entry of a table with every name in its values changed."""
    if isinstance(entry, dict):
        return {key: _renamed(value, new) for key, value in entry.items()}
    if isinstance(entry, list | tuple):
        return [_renamed(value, new) for value in entry]
    return new(entry) if isinstance(entry, str) else entry


def _slide(slide: Tables) -> Tables:
    return {
        "points": slide.get("points", [slide.get("point")]),
        "body": slide.get("body", "chassis"),
        "through": slide["through"],
        "along": slide["along"],
        "turns": slide.get("turns", True),
    }


def _one_mechanism(tables: Tables, given: Plain, right: Any) -> tuple[Tables, Plain]:
    """All parts in one, and the points under their prefixed names."""
    if "parts" not in tables:
        return tables, given
    whole: Tables = {key: dict(tables.get(key, {})) for key in ("rods", "slides", "roles", "stand_ins")}
    whole["bodies"] = {**tables.get("bodies", {}), "chassis": []}
    whole |= {"title": tables["title"], "inputs": dict(tables.get("inputs", {}))}
    whole_car = {point for listed in tables.get("bodies", {}).values() for point in listed}
    points: Plain = {name: place for name, place in given.items() if "." in name or name in whole_car}
    whole["sides"] = {prefix: part.get("side", "left") for prefix, part in tables["parts"].items()}
    for prefix, part in tables["parts"].items():
        inner = mechanism_file(part["mechanism"])
        words = {*AXES, "chassis", "drawing"}
        names = {
            key: _prefixed(inner.get(key, {}), prefix, words)
            for key in whole
            if key not in ("title", "sides")
        }
        whole["bodies"]["chassis"] += names["bodies"].pop("chassis")
        for key, entries in names.items():
            whole[key] |= entries
        for name in {p for ps in whole["bodies"].values() for p in ps} | {
            p for key in ("rods", "slides") for e in whole[key].values() for p in _points_of(e)
        }:
            own = name.removeprefix(f"{prefix}.")
            if own != name and own in given:
                place = given[own]
                beside = (
                    sum(a * b for a, b in zip(place, right, strict=True)) * 2 * bool(part.get("mirrored"))
                )
                mirrored = [a - beside * b for a, b in zip(place, right, strict=True)]
                points.setdefault(name, mirrored)
    whole["bodies"]["chassis"] += tables.get("bodies", {}).get("chassis", [])
    return whole, points


def _prefixed(entries: Tables, prefix: str, words: set[str]) -> Tables:
    def put(name: str) -> str:
        return name if name in words else f"{prefix}.{name}"

    return {put(name): _renamed(entry, put) for name, entry in entries.items()}


def _points_of(entry: Any) -> list[str]:
    if isinstance(entry, dict):
        return [entry["point"]] if "point" in entry else list(entry["points"])
    return list(entry)
