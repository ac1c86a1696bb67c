"""Another number of the car than the scene says, such as the wheel's radius or a load: by least squares."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from pointcoord.effects.car_number import CarNumbers
from pointcoord.effects.loads import ROD_FORCE
from pointcoord.effects.registry import EFFECTS
from validate.diagnosis.evidence import Evidence
from validate.diagnosis.hypothesis import Hypothesis
from validate.diagnosis.other_car import Change, Content, amounts_of, supposed
from validate.formulations.asked_numbers import is_force

Path = tuple[str | int, ...]
"""Of a number in the mechanism's part of a scene, such as ("car", "wheelbase")."""

STEP = 1e-4  # of the number, of differences by it
RADIUS: Path = ("wheel_radius",)
LEAST = 1e-9  # of the radius, that it may be
NOTHING = 1e-6  # of the radius, below which the contact point is the wheel centre
FARTHEST = 3.0  # times a number of the car that it may be: another factor is one of the number that is made
LENGTHS = ("wheel_radius", "wheelbase", "centre_of_gravity_height", "spring_free_length")
UNITS = {**dict.fromkeys(LENGTHS, " mm"), "force": " N", "moment": " N mm", "spring_rate": " N/mm"}
MADE_OF = {
    number.name: (*(("car", name) for name in number.data), *([RADIUS] if number.needs_radius else []))
    for effect in EFFECTS.values()
    if isinstance(effect, CarNumbers)
    for number in effect.numbers
}
"""By the name of a number of the car, what the scene says of the car that it is made of."""


def other_data(evidence: Evidence) -> Iterator[Hypothesis]:
    """Each number that those which disagree are made of, by itself."""
    if not evidence.other_cars:
        return
    part, effects = evidence.solved.content["mechanism"], _effects(evidence)
    loads: list[Path] = [
        ("loads", wheel, what, i)
        for wheel, load in part.get("loads", {}).items()
        if _all_wrong(evidence, wheel)
        for what in load
        for i in range(3)
    ]
    made_of = {
        row: (*loads, RADIUS) if is_force(row[0]) else MADE_OF.get(row[1].rpartition(".")[2], ())
        for row in evidence.wrong
        if np.isfinite(evidence.given[row]).all()
    }
    for path in dict.fromkeys(path for paths in made_of.values() for path in paths):
        value, looked = _at(part, path), [row for row, paths in made_of.items() if path in paths]
        if isinstance(value, float):
            number = _number(path, value, effects)
            one = supposed(evidence, [number], amounts_of(evidence, looked, [number]))
            if one:
                # Another load is one of all forces; a radius may be another one for some numbers only.
                yield replace(one, cost=1.5, whole=path[0] == "loads")


def _all_wrong(evidence: Evidence, wheel: str) -> bool:
    """Whether every rod of a wheel disagrees, as under another load."""
    prefix = f"{wheel}." if wheel else ""
    rods = {row for row in evidence.held if row[0] == ROD_FORCE.name and row[1].startswith(prefix)}
    return rods <= {*evidence.wrong}


def _effects(evidence: Evidence) -> list[str]:
    """Those that give what disagrees; of rows of a file some that single poses have, beside the scene's."""
    scene = evidence.solved.fine
    topology, wrong = scene.mechanism.topology, {*evidence.wrong}
    giving = (
        name
        for name in scene.mechanism.effects
        for quantity, names in EFFECTS[name].gives_numbers(topology).items()
        if not wrong.isdisjoint((quantity, of) for of in names or ())
    )
    return [*dict.fromkeys(giving)]


def _number(path: Path, value: float, effects: list[str]) -> Change:
    least = LEAST * value if path == RADIUS else -np.inf

    def put(content: Content, number: float) -> None:
        content["effects"] = effects
        _at(content["mechanism"], path[:-1])[path[-1]] = max(number, least)

    def words(number: float) -> str:
        if path[0] == "car" and not value / FARTHEST <= number <= value * FARTHEST:
            return ""
        if path == RADIUS and number <= NOTHING * value:
            return "the wheel centre is taken for the contact point"
        return f"{_called(path)} is {number:.6g}{_unit(path)}, not {value:.6g}"

    return Change((*path, *effects), value, STEP * (abs(value) or 1.0), put, words)


def _at(tables: Any, path: Path) -> Any:
    """What stands at a path; None where there is nothing."""
    for key in path:
        if isinstance(tables, dict) and key not in tables:
            return None
        tables = tables[key]
    return tables


def _called(path: Path) -> str:
    if path[0] != "loads":
        return str(path[-1])
    _, wheel, what, axis = path
    return f"{wheel}{'.' if wheel else ''}{what}.{'xyz'[int(axis)]} of the load"


def _unit(path: Path) -> str:
    return UNITS.get(str(path[2] if path[0] == "loads" else path[-1]), "")
