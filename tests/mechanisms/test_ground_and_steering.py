"""Cars that move over wheels on the ground, and steering wheels: every mechanics against the reference."""

from typing import Any

import numpy as np
import pytest
from mechanism_files import mechanism_file

from pointcoord import Scene, simulate
from validate.comparison.compare import compare_solutions
from validate.formulations.reference_solution import reference_solution
from validate.formulations.registry import formulation

WISHBONE = Scene.load("double-wishbone").model_dump(exclude_none=True)["mechanism"]
TIME = {"start": 0.0, "stop": 1.0, "samples": 3}
RATES = ("velocity", "acceleration", "knuckle_rates")
ANGLES = (*RATES, "toe", "wheel_travel")


def on_the_ground(part: str) -> dict[str, Any]:
    return {"contact": [f"{part}.wheel_axis_inner", f"{part}.wheel_centre"], "over": "ground"}


def axle(effects: tuple[str, ...] = (*ANGLES, "wheel_angles", "wheel_travel_by_travel", "axle")) -> Scene:
    """An axle that rolls, pitches, heaves and steers; the left wheel goes up a kerb."""
    wheel = {"mechanism": "double_wishbone"}
    return Scene.from_mapping(
        {
            "effects": list(effects),
            "mechanism": {
                "bodies": {"chassis": ["roll_axis", "pitch_axis"]},
                "parts": {
                    "left": {**wheel, "side": "left", "mirrored": True},
                    "right": {**wheel, "side": "right"},
                },
                "inputs": {
                    "left.ground": on_the_ground("left"),
                    "right.ground": on_the_ground("right"),
                    "rack": {"travel": ["left.rack", "right.rack"]},
                    "roll": {"turns": "chassis", "about": "roll_axis", "along": "forward"},
                    "pitch": {"turns": "chassis", "about": "pitch_axis", "along": "right"},
                    "heave": {"moves": "chassis", "along": "up"},
                },
                "wheel_radius": 270.0,
                "points": {
                    **WISHBONE["points"],
                    "roll_axis": (0.0, 0.0, -10.0),
                    "pitch_axis": (900.0, 0.0, 40.0),
                },
            },
            "inputs": {
                "left.ground": {"polynomial": [0.0, 8.0]},
                "right.ground": {"constant": 0.0},
                "rack": {"polynomial": [0.0, 6.0, 3.0]},
                "roll": {"sine": {"amplitude": 0.04, "angular_frequency": 2.0}},
                "pitch": {"polynomial": [0.0, 0.015, -0.01]},
                "heave": {"sine": {"amplitude": 7.0, "angular_frequency": 3.0}},
            },
            "time": TIME,
        }
    )


def steered(per_turn: float | None, effects: tuple[str, ...] = (*RATES, "toe", "toe_by_rack")) -> Scene:
    """A double wishbone by its steering wheel; without its travel per turn by the rack itself."""
    inputs = {"wheel_travel": {"height": "wheel_centre"}, "rack": {"travel": "rack"}}
    rack = [0.0, 8.0, 4.0]
    part = {**mechanism_file("double_wishbone"), "side": "right", "points": WISHBONE["points"]}
    if per_turn is not None:
        inputs["rack"] = {"steers": "rack"}
        rack = [2.0 * np.pi / per_turn * c for c in rack]
        part["rack_per_turn"] = per_turn
    return Scene.from_mapping(
        {
            "effects": effects,
            "mechanism": {**part, "inputs": inputs},
            "inputs": {"wheel_travel": {"polynomial": [0.0, 9.0]}, "rack": {"polynomial": rack}},
            "time": TIME,
        }
    )


@pytest.mark.parametrize("who", ["pointcoord", "pointcoord-newton", "absolute"])
@pytest.mark.parametrize("scene", [axle(), steered(44.0), steered(-51.5)], ids=["axle", "wheel", "reversed"])
def test_all_numbers_are_the_references_within_what_is_claimed(who: str, scene: Scene) -> None:
    outcome = compare_solutions(scene, formulation(who).solve(scene), reference_solution(scene), "here")
    assert not outcome.disagreements, outcome.disagreements
    assert all(row.share <= 1.0 for row in outcome.rows if row.verdict != "not given")
    assert {row.quantity for row in outcome.rows} >= {
        "position",
        "velocity",
        "acceleration",
        "angular_velocity",
    }


@pytest.mark.parametrize("who", ["relative", "mujoco", "exudyn"])
@pytest.mark.parametrize("scene", [axle(ANGLES), steered(-51.5, (*RATES, "toe"))], ids=["axle", "wheel"])
def test_trees_of_joints_stand_on_the_ground_and_are_steered(who: str, scene: Scene) -> None:
    outcome = compare_solutions(scene, formulation(who).solve(scene), reference_solution(scene), "here")
    assert not outcome.disagreements, outcome.disagreements
    assert all(row.share <= 1.0 for row in outcome.rows)


def test_a_steering_wheel_gives_the_motion_and_the_gradients_of_its_rack() -> None:
    by_wheel, by_rack = simulate(steered(-51.5)), simulate(steered(None))
    off = by_wheel.proof(rates=True).proven, by_rack.proof(rates=True).proven
    for quantity, channel in by_rack.numbers.items():
        for name, array in channel.items():
            # The angles are rounded by some units, of which the car makes as much of its rates.
            allowed = off[0][quantity][name] + off[1][quantity][name] + 1e-13 * np.abs(array).max()
            assert (np.abs(by_wheel.numbers[quantity][name] - array) <= allowed).all(), (quantity, name)


def test_the_travel_of_a_turn_is_a_length() -> None:
    content = steered(44.0).model_dump(exclude_none=True)
    metres = {**content, "units": "m"}
    metres["mechanism"] = {**content["mechanism"], "rack_per_turn": 0.044}
    metres["mechanism"]["points"] = {n: tuple(1e-3 * x for x in p) for n, p in WISHBONE["points"].items()}
    metres["inputs"] = {**content["inputs"], "wheel_travel": {"constant": 0.009}}
    found = Scene.from_mapping(metres)
    assert found.mechanism.rack_per_turn == pytest.approx(44.0, rel=1e-15)
    assert found.inputs["rack"] == Scene.from_mapping(content).inputs["rack"]
