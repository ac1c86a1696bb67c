"""Forces of rods, dampers and joints: closed forms, balances of bodies, laws of mirrors and turns."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
from knuckles_on_arms import guided_knuckle
from numpy.typing import NDArray

from pointcoord import MapError, Motion, Scene, SceneError, kinematic_map, simulate

Array = NDArray[np.float64]
RADIUS = 300.0
LOAD = {"force": [700.0, -400.0, 3000.0], "moment": [2e4, -1e5, 3e4]}
UP = {"force": [0.0, 0.0, 3000.0]}
FORCES = ("rod_force", "joint_force", "hinge_thrust")


def loaded(name: str, loads: Any, inputs: Mapping[str, Any] | None = None, **mechanism: Any) -> Motion:
    """A built-in car under loads at few instants."""
    content = Scene.load(name).model_dump(exclude_none=True)
    content["mechanism"] |= {"wheel_radius": RADIUS, "loads": loads, **mechanism}
    content |= {"effects": ["loads"], "inputs": inputs or content["inputs"]}
    content["time"] = {"start": 0.0, "stop": 1.0, "samples": 5}
    return simulate(Scene.from_mapping(content))


def contact_of(motion: Motion, inner: str = "wheel_axis_inner", centre: str = "wheel_centre") -> Array:
    """Where the lowest point of the wheel is, (N, 3)."""
    spin = motion.position[centre] - motion.position[inner]
    spin = spin / np.linalg.norm(spin, axis=-1, keepdims=True)
    down = spin[:, 2:] * spin - np.array([0.0, 0.0, 1.0])
    return motion.position[centre] + RADIUS * down / np.linalg.norm(down, axis=-1, keepdims=True)


def pull(motion: Motion, rod: str, here: str, there: str) -> Array:
    """What a rod or a damper does to what it holds at one of its ends, (N, 3)."""
    line = motion.position[there] - motion.position[here]
    return np.asarray(motion.rod_force[rod][:, None] * line / np.linalg.norm(line, axis=-1, keepdims=True))


def assert_balanced(about: Array, *forces: tuple[Array, Array | str], moment: Any = (0.0, 0.0, 0.0)) -> None:
    """Forces (N, 3) at places, of which none turns or shifts the body."""
    scale = max(float(np.abs(force).max()) for force, _ in forces)
    total = sum(force for force, _ in forces)
    turn = np.array(moment) + sum(np.cross(place - about, force) for force, place in forces)
    # Places are right to some 1e-13 of 1 m, by which forces are off with a factor of tens.
    assert np.abs(total).max() < 1e-10 * scale
    assert np.abs(turn).max() < 1e-10 * scale * 1000.0


def test_a_knuckle_that_an_arm_guides_is_in_balance_and_so_is_the_arm() -> None:
    """The point that is driven along the guide is held along it too."""
    motion = simulate(guided_knuckle(LOAD, RADIUS, driven="far"))
    at, contact, joint = motion.position, contact_of(motion, "inner", "centre"), motion.joint_force
    guides = [(joint[name], at[name]) for name in ("near", "far")]
    forces = [
        (np.broadcast_to(LOAD["force"], contact.shape), contact),
        (pull(motion, "link", "beside", "link_inner"), at["beside"]),
        *guides,
    ]
    up = np.zeros_like(contact)
    up[:, 2] = -sum(force[:, 2] for force, _ in forces)
    assert_balanced(contact, *forces, (up, at["centre"]), moment=LOAD["moment"])
    along = {name: np.abs(np.vecdot(joint[name], at["far"] - at["near"])) for name in ("near", "far")}
    assert along["near"].max() < 1e-6 < 1e4 < along["far"].min()
    hinge = at["arm_rear"] - at["arm_front"]
    thrust = (motion.hinge_thrust["arm_front"] / np.linalg.norm(hinge, axis=-1))[:, None] * hinge
    held = [(joint["arm_front"] + thrust, at["arm_front"]), (joint["arm_rear"], at["arm_rear"])]
    assert_balanced(contact, *((-force, place) for force, place in guides), *held)


TRAVEL = {f"{side}.wheel_travel": {"polynomial": [-15.0, 40.0]} for side in ("left", "right")}
STRAIGHT = {**TRAVEL, "rack": {"constant": 0.0}}


def test_a_wheels_load_makes_forces_as_of_a_wheel_alone_and_none_at_the_other() -> None:
    axle = loaded("axle-steer", {"right": LOAD}, STRAIGHT)
    inputs = {"wheel_travel": TRAVEL["left.wheel_travel"], "rack": {"constant": 0.0}}
    single = loaded("double-wishbone", LOAD, inputs)
    proven = axle.proof(rates=True).proven
    for quantity in FORCES:
        for name, force in axle.numbers[quantity].items():
            side, _, own = name.partition(".")
            assert (proven[quantity][name] <= 1e-11 * 1e4).all(), name
            if side == "left":
                assert (np.abs(force) <= proven[quantity][name]).all(), name
            else:
                assert force == pytest.approx(single.numbers[quantity][own], rel=1e-10, abs=1e-8), name


def test_a_load_in_other_units_has_its_moment_in_these() -> None:
    content = Scene.load("double-wishbone").model_dump(exclude_none=True)
    part = content["mechanism"]
    part.pop("car", None)
    part["loads"] = LOAD
    plain = Scene.from_mapping({**content, "effects": ["loads"]}).mechanism
    part["points"] = {n: [c / 1000.0 for c in place] for n, place in part["points"].items()}
    part |= {"wheel_radius": part["wheel_radius"] / 1000.0}
    part["loads"] = {"force": LOAD["force"], "moment": [m / 1000.0 for m in LOAD["moment"]]}
    metres = Scene.from_mapping({**content, "effects": ["loads"], "units": "m"}).mechanism
    assert metres.plain(())["loads"][""]["force"] == plain.plain(())["loads"][""]["force"]
    assert metres.plain(())["loads"][""]["moment"] == pytest.approx(plain.plain(())["loads"][""]["moment"])


def test_a_mechanism_that_is_held_twice_has_no_forces() -> None:
    content = Scene.load("bricard").model_dump(exclude_none=True)
    structure = Scene.from_mapping(content).mechanism.structure
    plain = structure.plain(content["inputs"])
    body = next(body for body in structure.bodies if body != "chassis")
    content["mechanism"] |= {
        **{key: plain[key] for key in ("bodies", "rods", "slides", "inputs")},
        "roles": {"knuckle": body, "wheel_axis": plain["bodies"][body][:2]},
        "type": None,
        "wheel_radius": RADIUS,
        "loads": UP,
    }
    with pytest.raises(SceneError, match="follow from the others"):
        Scene.from_mapping({**content, "effects": ["loads"]})


def test_a_map_takes_no_loads() -> None:
    content = Scene.load("pushrod").model_dump(exclude_none=True)
    content["mechanism"]["loads"] = UP
    scene = Scene.from_mapping({**content, "effects": ["loads"]})
    with pytest.raises(MapError, match="without derivatives"):
        kinematic_map(scene, dict.fromkeys(scene.inputs, (-1.0, 1.0)))
