"""Every number that a car has, by the three mechanics: also those that no built-in scene asks for."""

from typing import Any

import numpy as np
import pytest

from pointcoord import Scene, built_in_scenes
from pointcoord.effects.registry import EFFECTS, NUMBERS_OF_THE_CAR
from validate.adjudication.reference_solution import reference_solution
from validate.comparison.compare import compare, compare_solutions
from validate.formulations.registry import formulation

SAMPLES = 4
CAR = {
    "axle": "rear",
    "wheelbase": 2618.3,
    "centre_of_gravity_height": 511.7,
    "brake_share": 0.37,
    "drive_share": 0.91,
}


def asking_for_all(name: str) -> Scene:
    """A built-in scene at few instants with every effect that its car has, given what they need."""
    content: dict[str, Any] = Scene.load(name).model_dump(exclude_none=True, exclude={"points"})
    content["mechanism"].setdefault("wheel_radius", 300.0)
    content["mechanism"]["car"] = CAR
    content["time"]["samples"] = SAMPLES
    plain = Scene.from_mapping(content | {"effects": ()}, name)
    return Scene.from_mapping(content | {"effects": plain.mechanism.effects}, name)


ASKED = {name: asking_for_all(name) for name in built_in_scenes()}


def of_the_car(scene: Scene) -> set[str]:
    """The numbers of its car that a scene asks for."""
    return {n for effect in scene.effects for n in EFFECTS[effect].names(scene.mechanism.topology)}


CARS = [name for name, scene in ASKED.items() if of_the_car(scene)]


def test_every_number_is_one_of_some_car() -> None:
    found = set().union(*map(of_the_car, ASKED.values()))
    assert {name.rpartition(".")[2] for name in found} == NUMBERS_OF_THE_CAR.keys()


@pytest.mark.parametrize("name", CARS)
def test_pointcoord_and_the_absolute_model_agree_in_every_number_of_a_car(name: str) -> None:
    outcome = compare(ASKED[name], "pointcoord", "absolute", name)
    assert outcome.agreed, (outcome.disagreements, outcome.undecided)


@pytest.mark.parametrize("name", CARS)
@pytest.mark.parametrize("who", ["pointcoord", "absolute"])
def test_each_of_them_agrees_with_the_reference_in_every_number_of_a_car(name: str, who: str) -> None:
    scene = ASKED[name]
    outcome = compare_solutions(scene, formulation(who).solve(scene), reference_solution(scene), name)
    assert not outcome.disagreements, outcome.disagreements
    # What is off by no more than is claimed: the reference's own part of that is nothing.
    within = {row.name for row in outcome.rows if row.verdict != "not given" and row.share <= 1.0}
    # Wheels that are steered apart have no Ackermann, and the reference says so of a whole motion.
    arrays = [array for solution in outcome.solutions for array in solution.numbers.items()]
    nowhere = {n for _, of in arrays for n, array in of.items() if not np.isfinite(array).all()}
    assert within >= of_the_car(scene) - nowhere
