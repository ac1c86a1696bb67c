"""Shipped mechanism files and scenes, and mechanisms as the plain descriptions that all models take."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from many_digits import DIGITS, Points, vector
from mpmath import mp

import pointcoord
from pointcoord.mechanism.file import MechanismFile
from validate.reference import Design, instants_of

ROOT = Path(pointcoord.__file__).parent
MECHANISMS = tuple(sorted(path.stem for path in (ROOT / "mechanisms").glob("*.toml")))
SCENES = tuple(sorted(path.stem for path in (ROOT / "scenes").glob("*.toml")))

Tables = dict[str, Any]
Plain = dict[str, Any]


def mechanism_file(name: str) -> Tables:
    """The tables of a shipped mechanism."""
    return tomllib.loads((ROOT / "mechanisms" / f"{name}.toml").read_text(encoding="utf-8"))


def scene_text(name: str) -> str:
    """A shipped scene as it is written."""
    return (ROOT / "scenes" / f"{name}.toml").read_text(encoding="utf-8")


def scene_file(name: str) -> Tables:
    """The tables of a shipped scene."""
    return tomllib.loads(scene_text(name))


def plain_scene(name: str, driven: Iterable[str] | None = None, **changes: Any) -> Plain:
    """The mechanism of a shipped scene, driven as the scene does or by the inputs that are named."""
    scene = scene_file(name)
    part = {**scene["mechanism"], **changes}
    return plain(mechanism_file(part["type"]), part, scene["inputs"] if driven is None else driven)


def plain(tables: Tables, part: Mapping[str, Any], driven: Iterable[str]) -> Plain:
    """Tables of a mechanism file and a scene's mechanism, flattened; numbers stay what they are.

    Args:
        part: `points`, and where they are given `closure`, `up`, `right`, `side`, `wheel_radius`, `car`.
        driven: names of the inputs that are driven.
    Raises:
        TableFault: the tables describe no mechanism.
    """
    parts = {
        n: {**one, "mechanism": mechanism_file(one["mechanism"])}
        for n, one in tables.get("parts", {}).items()
    }
    file = MechanismFile.of({**tables, "parts": parts}, tables["title"])
    structure, right = file.structures[part.get("closure", "drawn")], part.get("right", (0, 1, 0))
    points = {name: place for name, place in part["points"].items() if name in structure.points}
    for prefix, mirrored in file.mirrored.items():
        for name, place in part["points"].items():
            out = 2 * mirrored * sum(a * b for a, b in zip(place, right, strict=True))
            if prefix + name in structure.points:
                points.setdefault(prefix + name, [a - out * b for a, b in zip(place, right, strict=True)])
    for name, other in structure.stand_ins.items():
        if name in structure.bodies["chassis"]:
            points.setdefault(name, points[other])
    return {
        **structure.drawn_with(points).plain(tuple(driven)),
        "name": file.name,
        "points": points,
        "up": list(part.get("up", (0, 0, 1))),
        "right": list(right),
        "side": part.get("side", "left"),
        "wheel_radius": part.get("wheel_radius"),
        "rack_per_turn": part.get("rack_per_turn"),
        "car": dict(part.get("car", {})),
        "loads": {},
    }


def exact_states(
    plain: Mapping[str, Any], path: Sequence[Mapping[str, Sequence[Any]]], clearness: float = 0.0
) -> list[tuple[Points, ...]]:
    """By the reference, places of the points and their rates at some inputs, in the order in which they are
    reached, mm and s.

    Args:
        path: value, rate and acceleration of each input.
        clearness: how far another assembly must be from the drawing, in parts of the mechanism's size.
    Raises:
        NoReferenceError: with what is in the way.
    """
    found = []
    for instant in instants_of(Design.from_plain(plain), path, DIGITS, clearness):
        with mp.workdps(DIGITS):
            found.append(tuple({name: vector(p) for name, p in of.items()} for of in instant.derivatives))
    return found


def full_input(drive: Mapping[str, Any]) -> Tables:
    """An input's table with what may be left out."""
    if "travel" in drive:
        travel = drive["travel"]
        return {**drive, "travel": [travel] if isinstance(travel, str) else travel}
    if "height" in drive:
        return {"along": "up", **drive}
    return {"on": "chassis", **drive} if drive.get("from") == "drawing" else dict(drive)
