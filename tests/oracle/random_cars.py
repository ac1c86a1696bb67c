"""Random cars and motions, kept as scenes: numbers with their bounds, or which model refuses them and why.

The scenes are files of their own among what is frozen, so that nothing hangs on how random cars are made.

A few cars near a singular pose are refused for another reason than they were, or are refused now, or decided:
`KNOWN` names them, and README.md says of each why. That is no difference; their numbers are held.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from difference import Comparison, Difference
from program import document, numbers_of, pointcoord, scene_facts
from record import Facts, Record, read_text

from validate.toml_written import written

SCENES = "random-scenes.json.xz"
FIRST, SECOND = "pointcoord", "absolute"
KNOWN = frozenset((24, 122, 267, 671, 716, 759, 998, 1023, 1344, 1489, 1584, 1668, 1712))
"""Numbers of the cars whose refusal is another one."""
ALL = "all"


def unexpected(found: Comparison) -> Comparison:
    """Without what the refusals of known cars explain, the exit status of all in one run among it."""
    return replace(found, differences=[one for one in found.differences if not _explained(one)])


def _explained(one: Difference) -> bool:
    if one.case == ALL:
        return True
    if one.now == "disagree":
        return False
    refused = one.now == "nothing" or one.quantity.endswith(("refuses", "verdict", "exit status"))
    return refused and int(one.case.partition("-")[0]) in KNOWN


def stored(frozen: Path, count: int | None = None) -> dict[str, Any]:
    """The first so many frozen scenes by name; a name has the number and what the car comes near to."""
    path = frozen / SCENES
    return dict(list(read_text(path).items())[:count]) if path.exists() else {}


def record(folder: Path, scenes: dict[str, Any]) -> Record:
    """All scenes by both models, in one run of the program."""
    files = folder / "cars"
    files.mkdir()
    for name, content in scenes.items():
        (files / f"{name}.toml").write_text("\n".join(written(content)), encoding="utf-8")
    target, baseline = folder / "cars.json", folder / "cars.npz"
    options = ("--first", FIRST, "--second", SECOND, "--scenes-dir", files, "-q")
    status = pointcoord("validate", *options, "--json", target, "--save-baseline", baseline)
    facts: Facts = {ALL: {"exit status": status}}
    for name, found in scene_facts(document(target)).items():
        facts[name] = {quantity: fact for quantity, fact in found.items() if fact != "agrees"}
    return Record(facts, numbers_of(baseline))
