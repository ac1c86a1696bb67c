"""Hardpoints of other programs, and the scene that is made of each file."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from program import pointcoord
from record import Fact, Facts, Record

GIVEN = Path(__file__).parent / "given" / "import"
VEHICLE = "chrono-vehicle/own/vehicle/car.json"

CASES: dict[str, tuple[str, ...]] = {
    "a report of Lotus": ("lotus-report.txt",),
    "a table": ("table.csv",),
    "a table in metres": ("table-in-metres.csv",),
    "a table in inches": ("table-in-inches.csv", "--unit", "in"),
    "a table without a unit": ("table-without-unit.csv",),
    "a table without a unit, said": ("table-without-unit.csv", "--unit", "m"),
    "a table of one wheel by its ending": ("table-front-right.csv",),
    "a table, mirrored": ("table.csv", "--side", "right", "--mirror"),
    "a table, the wrong side said": ("table.csv", "--side", "left"),
    "a table without a spin axis": ("table-without-spin-axis.csv",),
    "a table with static angles": ("table-without-spin-axis.csv", "--camber=-2", "--toe=0.5"),
    "a table in other axes": ("table-left-forward-up.csv",),
    "a table in other axes, said": ("table-left-forward-up.csv", "--axes", "left,forward,up"),
    "a table with front and rear exchanged": ("table-front-and-rear-exchanged.csv",),
    "a table with one wrong sign": ("table-one-sign-wrong.csv",),
    "a table with a tie rod across the car": ("table-tie-rod-across.csv",),
    "a strut under our own names": ("table-own-names-strut.csv",),
    "a wishbone of Chrono": ("chrono-wishbone.json",),
    "a wishbone of Chrono, mirrored": ("chrono-wishbone.json", "--mirror"),
    "a strut of Chrono": ("chrono-strut.json",),
    "a strut of Chrono with its angles": ("chrono-strut-with-angles.json",),
    "a strut of Chrono, the wheel that it lacks": ("chrono-strut.json", "--side", "right"),
    "a broken file of Chrono": ("chrono-broken.json",),
    "the front axle of a vehicle": (VEHICLE, "--part", "front"),
    "the rear axle of a vehicle": (VEHICLE, "--part", "rear"),
    "a vehicle without an axle said": (VEHICLE,),
    "no hardpoints": ("no-points.txt",),
    "no such file": ("nowhere.txt",),
}

# Coordinates are written with the file's digits, or with 12 decimals of mm: some roundings of 2000 mm.
ROUNDING = 5e-12
# A bounce's amplitude is a quarter of the way to the nearer end of the reach, in four digits.
WRITTEN = {"amplitude": 1e-4}


def record(folder: Path) -> Record:
    """By file and options: the exit status and every key of the scene but its title."""
    facts: Facts = {}
    for number, (case, (name, *options)) in enumerate(CASES.items()):
        target = folder / f"{number}.toml"
        status = pointcoord("import", GIVEN / name, *options, "-o", target)
        facts[case] = {"exit status": status}
        if target.exists():
            scene = tomllib.loads(target.read_text(encoding="utf-8"))
            facts[case] |= {key: fact for key, fact in _flat(scene) if key != "title"}
    return Record(facts)


def _flat(content: dict[str, Any], before: str = "") -> Iterator[tuple[str, Fact]]:
    """Every value of nested tables under its path; numbers with how far they may be off."""
    for key, value in content.items():
        path = f"{before}{key}"
        if isinstance(value, dict):
            yield from _flat(value, f"{path}.")
        elif isinstance(value, list) and all(isinstance(one, int | float) for one in value):
            yield from ((f"{path}[{i}]", _number(key, one)) for i, one in enumerate(value))
        elif isinstance(value, int | float) and not isinstance(value, bool):
            yield path, _number(key, value)
        else:
            yield path, value


def _number(key: str, value: float) -> Fact:
    return [float(value), WRITTEN.get(key, ROUNDING)]
