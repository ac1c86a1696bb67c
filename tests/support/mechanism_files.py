"""Shipped mechanism files and scenes, and mechanisms as the plain descriptions that all models take."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import pointcoord
from pointcoord.scene.scene_file import MechanismPart

ROOT = Path(pointcoord.__file__).parent
MECHANISMS = tuple(sorted(path.stem for path in (ROOT / "mechanisms").glob("*.toml")))
SCENES = tuple(sorted(path.stem for path in (ROOT / "scenes").glob("*.toml")))

Tables = dict[str, Any]
Plain = dict[str, Any]


def mechanism_file(name: str) -> Tables:
    """The tables of a shipped mechanism."""
    return tomllib.loads((ROOT / "mechanisms" / f"{name}.toml").read_text(encoding="utf-8"))


def scene_file(name: str) -> Tables:
    """The tables of a shipped scene."""
    return tomllib.loads((ROOT / "scenes" / f"{name}.toml").read_text(encoding="utf-8"))


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
        ValidationError: the tables describe no mechanism.
    """
    given = {key: value for key, value in part.items() if value is not None and key != "type"}
    found = MechanismPart.model_validate({**tables, **given}).plain(tuple(driven))
    own = {name: given["points"].get(name, place) for name, place in found["points"].items()}
    exact = {key: given[key] for key in ("up", "right", "wheel_radius", "car") if key in given}
    return {**found, **exact, "points": own}


def full_input(drive: Mapping[str, Any]) -> Tables:
    """An input's table with what may be left out."""
    if "travel" in drive:
        travel = drive["travel"]
        return {**drive, "travel": [travel] if isinstance(travel, str) else travel}
    if "height" in drive:
        return {"along": "up", **drive}
    return {"on": "chassis", **drive} if drive.get("from") == "drawing" else dict(drive)
