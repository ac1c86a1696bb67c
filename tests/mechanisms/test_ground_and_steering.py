"""Cars that move over wheels on the ground, and steering wheels: every mechanics against the reference."""

import math
from functools import cache
from pathlib import Path

import pytest
from changed_scenes import scene_with

from pointcoord import Scene
from validate.comparison.compare import compare_solutions
from validate.formulations.protocol import Solution
from validate.formulations.reference_solution import reference_solution
from validate.formulations.registry import formulation

TIME = {"start": 0.0, "stop": 1.0, "samples": 3}


def steered(per_turn: float) -> Scene:
    """A double wishbone by its steering wheel, with the travel of a turn."""
    laws = {"wheel_travel": [0.0, 9.0], "steering_wheel": [0.0, 16.0 * math.pi / per_turn, 8.0 / per_turn]}
    effects = ("velocity", "acceleration", "knuckle_rates", "toe", "toe_by_rack")
    inputs = {name: {"polynomial": law} for name, law in laws.items()}
    return scene_with(
        "double-wishbone", {"rack_per_turn": per_turn}, effects=effects, inputs=inputs, time=TIME
    )


SCENES = {
    "axle": Scene.load(Path(__file__).with_name("kerb.toml")),
    "wheel": steered(44.0),
    "reversed": steered(-51.5),
}


@cache
def exact(name: str) -> Solution:
    return reference_solution(SCENES[name])


@pytest.mark.parametrize(
    "who", ["pointcoord", "pointcoord-newton", "absolute", "relative", "mujoco", "exudyn"]
)
@pytest.mark.parametrize("name", SCENES)
def test_all_numbers_are_the_references_within_what_is_claimed(who: str, name: str) -> None:
    scene = SCENES[name]
    outcome = compare_solutions(scene, formulation(who).solve(scene), exact(name), "here")
    assert not outcome.disagreements, outcome.disagreements
    given = [row for row in outcome.rows if row.verdict != "not given"]
    assert all(row.share <= 1.0 for row in given)
    # Trees of joints give no rates of a knuckle or gradients of their own.
    assert {row.quantity for row in given} >= {"position", "velocity", "acceleration", "wheel"}
