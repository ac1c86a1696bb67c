"""Forces of loads at wheels on joints that no shipped car has, by the three mechanics."""

from typing import Any

import pytest
from knuckles_on_arms import guided_knuckle, hinged_knuckle

from pointcoord import Scene
from pointcoord.effects.registry import EFFECTS
from validate.comparison.compare import Outcome, compare, compare_solutions
from validate.formulations.reference_solution import reference_solution
from validate.formulations.registry import formulation

LOAD = {"force": [700.0, -400.0, 3000.0], "moment": [2e4, -1e5, 3e4]}
GUIDED = "a knuckle that an arm guides"
ROLLING = "a car that rolls about a point of a hinge"
ARM: dict[str, Any] = {
    "bodies": {"chassis": ["front", "rear"], "arm": ["front", "rear", "inner", "centre"]},
    "inputs": {
        "ground": {"contact": ["inner", "centre"], "over": "ground"},
        "roll": {"turns": "chassis", "about": "front", "along": "forward"},
    },
    "roles": {"knuckle": "arm", "wheel_axis": ["inner", "centre"]},
    "points": {
        "front": [-200.0, 300.0, 250.0],
        "rear": [180.0, 350.0, 270.0],
        "inner": [0.0, 650.0, 290.0],
        "centre": [10.0, 750.0, 300.0],
    },
    "side": "right",
}
HINGED = {
    "a knuckle hinged to an arm": ("chassis", "arm", "knuckle"),
    "an arm hinged to a knuckle": ("chassis", "knuckle", "arm"),
}


def loaded(name: str, samples: int = 5) -> Scene:
    if name == ROLLING:
        motion = {"ground": {"constant": 0.0}, "roll": {"polynomial": [0.0, 0.05]}}
        time = {"start": 0.0, "stop": 1.0, "samples": samples}
        part = ARM | {"loads": {"": LOAD}, "wheel_radius": 300.0}
        return Scene.from_mapping({"mechanism": part, "inputs": motion, "effects": ["loads"], "time": time})
    if name == GUIDED:
        return guided_knuckle({"": LOAD}, 300.0, samples)
    return hinged_knuckle({"": LOAD}, 300.0, samples, HINGED[name])


def forces(outcome: Outcome) -> dict[tuple[str, str], str]:
    return {(r.quantity, r.name): r.verdict for r in outcome.rows if r.unit == "N"}


def test_forces_of_one_pose_in_which_nothing_moves_are_compared() -> None:
    plain = Scene.load("pushrod").model_dump(include={"mechanism"}, exclude_unset=True)
    plain["mechanism"]["loads"] = {"force": [0.0, -3000.0, 3000.0]}
    still = {"wheel_travel": {"constant": 0.0}, "rack": {"constant": 0.0}}
    scene = Scene.from_mapping({**plain, "inputs": still, "effects": ["loads"]})
    found = forces(compare(scene, "pointcoord", "absolute"))
    assert len(found) >= 10
    assert set(found.values()) == {"agrees"}


@pytest.mark.parametrize("name", [*HINGED, GUIDED, ROLLING])
def test_three_mechanics_give_the_same_forces(name: str) -> None:
    scene = loaded(name)
    gives = EFFECTS["loads"].gives_numbers(scene.mechanism.topology)
    every = {(quantity, n): "agrees" for quantity, names in gives.items() for n in names or ()}
    assert len(every) >= 2
    outcome = compare(scene, "pointcoord", "absolute", name)
    assert forces(outcome) == every
    few = loaded(name, 2)
    ours = formulation("pointcoord").solve(few)
    assert forces(compare_solutions(few, ours, reference_solution(few), name)) == every
