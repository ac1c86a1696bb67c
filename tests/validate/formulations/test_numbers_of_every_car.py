"""Every number that a car has, by the three mechanics: also those that no built-in scene asks for."""

from typing import Any

import pytest

from pointcoord import Scene, built_in_scenes
from pointcoord.effects.point_states import STATES
from pointcoord.effects.registry import EFFECTS, NUMBERS_OF_THE_CAR
from validate.adjudication.reference_solution import reference_solution
from validate.comparison.compare import compare_solutions
from validate.formulations.registry import formulation

SAMPLES = 4
CAR = {
    "axle": "rear",
    "wheelbase": 2618.3,
    "centre_of_gravity_height": 511.7,
    "brake_share": 0.37,
    "drive_share": 0.91,
    "spring_rate": 31.7,
    "spring_free_length": 823.9,
}

LOAD = {"force": (-310.0, 1870.0, 3105.0), "moment": (4100.0, -73000.0, 21000.0)}

# What an axle has only where both wheels are steered to the same side.
OF_A_TURN = {"ackermann", "ackermann_error", "turning_radius"}


def asking_for_all(name: str) -> Scene:
    """A built-in scene at few instants with every effect that its car has, given what they need."""
    content: dict[str, Any] = Scene.load(name).model_dump(exclude_none=True, exclude={"points"})
    content["mechanism"].setdefault("wheel_radius", 300.0)
    content["mechanism"]["car"] = CAR
    topology = Scene.load(name).mechanism.topology
    wheels = [role.removesuffix("wheel_axis") for role in topology.roles if role.endswith("wheel_axis")]
    content["mechanism"]["loads"] = {wheel.removesuffix("."): LOAD for wheel in wheels}
    # At the start of a scene an axle goes straight ahead, where it has no turning radius.
    time = content["time"]
    content["time"] = {
        **time,
        "start": time["start"] + 0.05 * (time["stop"] - time["start"]),
        "samples": SAMPLES,
    }
    plain = Scene.from_mapping(content | {"effects": ()}, name)
    return Scene.from_mapping(content | {"effects": plain.mechanism.effects}, name)


ASKED = {name: asking_for_all(name) for name in built_in_scenes()}


def of_the_car(scene: Scene) -> set[str]:
    """The numbers of its car that a scene asks for."""
    topology = scene.mechanism.topology
    return {name for effect in scene.effects for name in EFFECTS[effect].names(topology)}


CARS = [name for name, scene in ASKED.items() if of_the_car(scene)]


def test_every_number_is_one_of_some_car() -> None:
    found = set().union(*map(of_the_car, ASKED.values()))
    assert {name.rpartition(".")[2] for name in found} >= NUMBERS_OF_THE_CAR.keys()
    assert any("loads" in scene.effects for scene in ASKED.values())


@pytest.mark.parametrize("name", CARS)
@pytest.mark.parametrize("who", ["pointcoord", "absolute"])
def test_each_of_them_agrees_with_the_reference_in_every_number_of_a_car(name: str, who: str) -> None:
    scene = ASKED[name]
    reference = reference_solution(scene)
    outcome = compare_solutions(scene, formulation(who).solve(scene), reference, name)
    assert not outcome.disagreements, outcome.disagreements
    # What is off by no more than is claimed: the reference's own part of that is nothing.
    within = {row.name for row in outcome.rows if row.verdict != "not given" and row.share <= 1.0}
    lacking = of_the_car(scene) - within
    assert lacking <= OF_A_TURN
    assert not lacking or name != "axle-steer"


@pytest.mark.parametrize("name", [name for name in ASKED if name not in CARS])
@pytest.mark.parametrize("who", ["pointcoord", "absolute"])
def test_states_of_points_of_other_mechanisms_are_the_references_up_to_pop(name: str, who: str) -> None:
    scene = ASKED[name]
    outcome = compare_solutions(scene, formulation(who).solve(scene), reference_solution(scene), name)
    # Bricard's claims are too wide to test the reference, which has hardly any; they hold its numbers.
    assert not outcome.disagreements, outcome.disagreements
    within = {row.quantity for row in outcome.rows if row.verdict != "not given" and row.share <= 1.0}
    assert set(STATES) <= within
