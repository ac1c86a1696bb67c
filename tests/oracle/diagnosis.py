"""Planted faults, and the kinds of explanations that the program names for each."""

from __future__ import annotations

from pathlib import Path

from faulty import FAULTS, SCENE_FAULTS, SCENES
from program import document, pointcoord, scene_facts
from record import Facts, Record

WISHBONE, STRUT = "double-wishbone", "off-axis-strut"
# (fault, scene): every fault in the wishbone; the closure in a strut, which alone has two, and some others.
CASES = (
    *((fault, WISHBONE) for fault in FAULTS),
    *((fault, WISHBONE) for fault in SCENE_FAULTS if fault != "other_closure"),
    *((fault, STRUT) for fault in ("mirrored", "hardpoint", "rack_sign", "other_closure")),
)


def record(folder: Path) -> Record:
    """By fault and scene: exit status, verdicts, which explanation comes first and the kinds of all."""
    facts: Facts = {}
    for fault, scene in CASES:
        facts[f"{fault} in {scene}"] = _explained(folder / f"{fault}-{scene}.json", fault, scene)
    return Record(facts)


def _explained(target: Path, fault: str, scene: str) -> dict[str, object]:
    options = ("--in-process", "--solver", f"faulty:with_{fault}", "-q", "--json", target)
    status = pointcoord("validate", *options, SCENES / f"{scene}.toml", ORACLE_SCENE=scene)
    content = document(target)
    found: dict[str, object] = {"exit status of the program": status}
    for facts in scene_facts(content).values():
        found |= facts
    explanations = [
        one for part in content.get("scenes", []) for c in part["comparisons"] for one in c["explanations"]
    ]
    found["first explanation"] = explanations[0]["kind"] if explanations else "none"
    return found
