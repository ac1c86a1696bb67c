"""Heights over the ground, turns that go round, and inputs that do not hold a mechanism."""

import tomllib
from collections.abc import Mapping

import numpy as np
import pytest

from pointcoord import Scene, SceneError, simulate
from pointcoord.mechanism.file import MECHANISMS
from pointcoord.results.motion import Motion

WISHBONE = Scene.load("double-wishbone").model_dump(exclude_none=True)["mechanism"]
RACK = {"polynomial": [0.0, 10.0]}
RADIUS = 300.0


def with_inputs(inputs: Mapping[str, object], **laws: object) -> Scene:
    """A scene of the wishbone with further inputs that can be driven."""
    tables = tomllib.loads((MECHANISMS / f"{WISHBONE['type']}.toml").read_text())
    tables["inputs"] = {**tables["inputs"], **inputs}
    own = {**WISHBONE, "type": None, "wheel_radius": RADIUS}
    return Scene.from_mapping(
        {
            "mechanism": {**own, **tables},
            "effects": [],
            "inputs": laws,
            "time": {"start": 0.0, "stop": 1.0, "samples": 5},
        }
    )


GROUND = {
    "c": {"contact": ["wheel_axis_inner", "wheel_centre"], "over": "ground"},
    "roll": {"turns": "chassis", "about": "upper_arm_front", "along": "forward"},
}
ROLL = {"sine": {"amplitude": 0.06, "angular_frequency": 5.0}}


CONSTANT = {"constant": 1.5}


@pytest.mark.parametrize(
    ("inputs", "laws", "words"),
    [
        (
            {"again": {"travel": "rack"}},
            {"arm_angle": CONSTANT, "again": CONSTANT},
            ("rack and again both drive the travel of rack",),
        ),
        (
            GROUND | {"roll": {**GROUND["roll"], "about": "wheel_centre"}},
            {"c": CONSTANT, "roll": ROLL},
            ("roll turns the chassis about wheel_centre, which it does not carry",),
        ),
    ],
)
def test_inputs_that_do_not_hold_the_mechanism_are_refused_by_name(
    inputs: dict[str, object], laws: dict[str, object], words: tuple[str, ...]
) -> None:
    with pytest.raises(SceneError) as caught:
        with_inputs(inputs, rack=RACK, **laws)
    assert all(word in str(caught.value) for word in words)


ARM_SCENE = Scene.load("semi-trailing-arm").model_dump(exclude_none=True)


def turned_arm(polynomial: list[float]) -> Motion:
    time = {"start": 0.0, "stop": 1.0, "samples": 9}
    effects = ["velocity", "knuckle_rates"]
    law = {"arm_turn": {"polynomial": polynomial}}
    return simulate(Scene.from_mapping({**ARM_SCENE, "inputs": law, "time": time, "effects": effects}))


def test_a_turn_is_right_handed_about_the_hinge_and_goes_round_as_often_as_it_says() -> None:
    inner, outer = (np.array(ARM_SCENE["mechanism"]["points"][f"pivot_{end}"]) for end in ("inner", "outer"))
    hinge = (outer - inner) / np.linalg.norm(outer - inner)
    motion = turned_arm([0.0, 8.0 * np.pi])
    assert np.abs(motion.angular_velocity["arm"] - 8.0 * np.pi * hinge).max() < 1e-10
    there = motion.position["wheel_centre"]
    assert np.abs(there[-1] - there[0]).max() < 1e-9
    # An eighth of four rounds is half of one: the centre is across the hinge.
    arm = there[0] - inner
    across = 2.0 * (arm @ hinge) * hinge - arm + inner
    assert np.abs(there[1] - across).max() < 1e-9
    # A motion that starts rounds away from the drawing goes there round by round.
    assert np.abs(turned_arm([7.0 * np.pi]).position["wheel_centre"][0] - across).max() < 1e-9


def test_a_tripod_of_rods_is_refused_as_a_structure() -> None:
    content = {
        "mechanism": {
            "bodies": {"chassis": ["a", "b", "c"]},
            "rods": {"r1": ["a", "p"], "r2": ["b", "p"], "r3": ["c", "p"]},
            "points": {"a": [0, 0, 0], "b": [300, 0, 0], "c": [0, 300, 10], "p": [100, 100, 300]},
        },
        "inputs": {},
        "time": {"start": 0.0, "stop": 1.0, "samples": 3},
    }
    with pytest.raises(SceneError, match="structure that nothing moves"):
        Scene.from_mapping(content)
