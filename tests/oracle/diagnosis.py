"""Planted faults, and the kinds of explanations that the program names for each."""

from __future__ import annotations

from pathlib import Path

from faulty import FAULTS, SCENE_FAULTS, SCENES
from program import document, validated
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
        target, words = folder / f"{fault}-{scene}.json", ("--in-process", "--solver", f"faulty:with_{fault}")
        found = validated(target, *words, SCENES / f"{scene}.toml", ORACLE_SCENE=scene)
        compared = [c for part in document(target).get("scenes", []) for c in part["comparisons"]]
        kinds = [one["kind"] for c in compared for one in c["explanations"]]
        facts[f"{fault} in {scene}"] = {**found, "first explanation": next(iter(kinds), "none")}
    return Record(facts)
