"""Random cars and motions, kept as scenes: numbers with their bounds, or which model refuses them and why.

The scenes are files of their own among what is frozen, so that nothing hangs on how random cars are made.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

from program import ROOT, document, numbers_of, pointcoord, scene_facts
from record import Facts, Record, read_text, write_text

COUNT = 2000
SCENES = "random-scenes.json.xz"
FIRST, SECOND = "pointcoord", "absolute"


def stored(frozen: Path, count: int | None = None) -> dict[str, Any]:
    """The first so many frozen scenes by name; a name has the number and what the car comes near to."""
    path = frozen / SCENES
    return dict(list(read_text(path).items())[:count]) if path.exists() else {}


def extend(frozen: Path, count: int) -> None:
    """Keep this many scenes; those that are there stay. Needs the maker of random scenes as it was."""
    sys.path.insert(0, str(ROOT))
    from validate.cars.random_scenes import random_scene

    scenes = stored(frozen)
    for number in range(len(scenes), count):
        made = random_scene(number)
        content = made.scene.model_dump(mode="json", exclude_none=True)
        scenes[f"{number:05d} {made.variant.words}, {made.kind}".replace(" ", "-").replace(",", "")] = content
    frozen.mkdir(parents=True, exist_ok=True)
    write_text(frozen / SCENES, scenes)


def record(folder: Path, scenes: dict[str, Any]) -> Record:
    """All scenes by both models, in one run of the program."""
    files = folder / "cars"
    files.mkdir()
    for name, content in scenes.items():
        lines = (f"{key} = {_toml(value)}\n" for key, value in content.items())
        (files / f"{name}.toml").write_text("".join(lines), encoding="utf-8")
    target, baseline = folder / "cars.json", folder / "cars.npz"
    options = ("--first", FIRST, "--second", SECOND, "--scenes-dir", files, "-q")
    status = pointcoord("validate", *options, "--json", target, "--save-baseline", baseline)
    facts: Facts = {"all": {"exit status": status}}
    for name, found in scene_facts(document(target)).items():
        facts[name] = {quantity: fact for quantity, fact in found.items() if fact != "agrees"}
    return Record(facts, numbers_of(baseline))


def _toml(value: Any) -> str:
    """A value as TOML, tables on one line."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {_toml(one)}" for key, one in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(_toml, value)) + "]"
    return json.dumps(value)
