"""Mechanisms with more equations than they need, and with parts that move in more ways than one."""

import pickle
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pointcoord import (
    MechanismError,
    Scene,
    SceneError,
    kinematic_map,
    simulate,
    solve_poses,
    sweep,
)
from pointcoord.mechanism.freedoms import held_rows
from pointcoord.simulation import scene_mechanism

CUBE = np.array([[0, 0, 0], [1, 0, 0], [1, -1, 0], [1, -1, 1], [0, -1, 1], [0, 0, 1]]) * 1000.0
HINGES = np.array([[0, 1, 0], [0, 0, 1], [1, 0, 0]] * 2) * 100.0


def scene_of(bodies: dict[str, list[str]], first: str, points: dict[str, np.ndarray], turn: float) -> Scene:
    return Scene.from_mapping(
        {
            "mechanism": {
                "bodies": bodies,
                "inputs": {"turn": {"angle": first, "from": "drawing"}},
                "points": {name: [float(x) for x in place] for name, place in points.items()},
            },
            "inputs": {"turn": {"polynomial": [0.0, turn]}},
            "time": {"start": 0.0, "stop": 1.0, "samples": 5},
        }
    )


def four_bar(turn: float = 0.5, tilt: float = 0.0) -> Scene:
    pins = {"a": (0, 0, 0), "b": (0, 0, 100), "c": (200, 0, 160), "d": (250, 0, 0)}
    points = {name: np.array(place, dtype=float) for name, place in pins.items()}
    points |= {f"{name}_far": place + np.array([0.0, 50.0, 0.0]) for name, place in points.items()}
    points["d_far"] = points["d_far"] + np.array([0.0, 0.0, tilt])
    bodies = {
        "chassis": ["a", "a_far", "d", "d_far"],
        "crank": ["a", "a_far", "b", "b_far"],
        "coupler": ["b", "b_far", "c", "c_far"],
        "rocker": ["c", "c_far", "d", "d_far"],
    }
    return scene_of(bodies, "crank", points, turn)


def bricard(turn: float) -> Scene:
    points = {f"p{i}": CUBE[i] for i in range(6)} | {f"q{i}": CUBE[i] + HINGES[i] for i in range(6)}
    bodies = {f"link{i}": [f"p{i}", f"q{i}", f"p{i + 1}", f"q{i + 1}"] for i in range(5)}
    return scene_of({"chassis": ["p5", "q5", "p0", "q0"], **bodies}, "link0", points, turn)


def test_a_planar_four_bar_of_hinges_moves_as_its_closed_form() -> None:
    motion = simulate(four_bar())
    there = motion.position
    assert np.abs(there["c"][:, 1]).max() < 1e-11
    for one, other, length in (("b", "c", 40000 + 3600), ("c", "d", 2500 + 160**2)):
        apart = ((there[one] - there[other]) ** 2).sum(axis=1)
        assert np.abs(apart - length).max() < 1e-8
    angle = np.linspace(0.0, 0.5, 5)
    assert np.abs(there["b"] - 100.0 * np.stack([np.sin(angle), 0 * angle, np.cos(angle)], 1)).max() < 1e-11


@pytest.mark.parametrize("tilt", [1.0, 1e-6])
def test_hinges_that_are_not_parallel_lock_a_four_bar(tilt: float) -> None:
    hinges = "a - a_far, d - d_far, b - b_far, c - c_far"
    with pytest.raises(SceneError, match=f"is locked.*the hinges {hinges} are meant to be parallel"):
        four_bar(tilt=tilt)


def test_a_row_that_is_left_out_is_held_to_at_an_answer() -> None:
    scene = four_bar()
    mechanism = scene_mechanism(scene)
    assert mechanism.topology.left_out
    off = np.full(1, 1e-15)
    held_rows(mechanism, mechanism.drawn[None], off)
    moved = mechanism.drawn.copy()
    moved[mechanism.layout.vector("c_far")[1]] += 1e-9
    with pytest.raises(MechanismError, match="is locked"):
        held_rows(mechanism, moved[None], off)
    # Without such rows there is nothing to hold.
    held_rows(replace(mechanism, topology=replace(mechanism.topology, left_out=())), moved[None], off)


def bent_bricard() -> Scene:
    """A hinge that is 1e-8 mm off: it closes, and its rows seem to depend on each other as drawn."""
    content = Scene.load("bricard").model_dump(exclude_none=True)
    content["mechanism"]["points"]["P1"] = [1000.0 + 1e-8, 0.0, 0.0]
    return Scene.from_mapping(content)


@pytest.mark.parametrize("scene", [four_bar(0.4), bricard(0.4)])
def test_maps_and_unrelated_poses_of_redundant_mechanisms_are_those_of_the_motion(scene: Scene) -> None:
    motion = simulate(scene)
    turns = scene.functions["turn"].series(motion.times, 0)[:, 0]
    mapped, poses = kinematic_map(scene, {"turn": (-0.1, 0.5)}), solve_poses(scene, {"turn": turns})
    assert not poses.failures
    for name, place in motion.position.items():
        allowed = motion.proof().bound + poses.bound
        assert (np.abs(place - poses.position[name]).max(axis=1) <= allowed).all()
        allowed = motion.proof().bound + mapped.bound.position
        assert (np.abs(place - mapped({"turn": turns}).position[name]).max(axis=1) <= allowed).all()


def test_a_violated_row_is_named_by_maps_poses_and_sweeps() -> None:
    scene = bent_bricard()
    # A map that is within 1e-9 mm could not tell.
    with pytest.raises(MechanismError, match=r"is locked: normal of the link_\d"):
        kinematic_map(scene, {"turn": (-0.3, 0.3)}, tolerance=1e-10)
    # At the drawing itself every row is kept.
    poses = solve_poses(scene, {"turn": [0.0, 0.3]})
    assert list(poses.failures) == [1]
    assert "is locked: normal of the link" in str(poses.failures[1])
    assert np.isnan(poses.position["P3"][1]).all()
    assert list(poses.solved) == [True, False]
    swept = sweep(Scene.load("bricard"), points={"P1.x": [1000.0, 1000.0 + 1e-8, 1001.0]})
    assert list(swept.solved) == [True, False, False]
    reasons = [failure.reason for failure in swept.failures.values()]
    assert reasons == ["the mechanism locks", "the drawing is refused"]


AXLE = """
title = "Axle"
[parts]
left  = { mechanism = "double_wishbone", side = "left", mirrored = true }
right = { mechanism = "double_wishbone", side = "right" }
[inputs]
steer = { travel = ["left.rack", "right.rack"] }
"""
POINTS = Scene.load("double-wishbone").mechanism.points
STEER, ANGLES = 7.0, (1.49, 1.53)


def constant(value: float) -> dict[str, object]:
    return {"constant": value}


@pytest.fixture
def axle(tmp_path: Path) -> Scene:
    (tmp_path / "axle.toml").write_text(AXLE)
    points = "\n".join(f"{name} = {list(place)}" for name, place in POINTS.items())
    scene = tmp_path / "scene.toml"
    scene.write_text(
        f'[mechanism]\ntype = "axle.toml"\n[mechanism.points]\n{points}\n[inputs]\n'
        f"steer = {{ constant = {STEER} }}\nleft.arm_angle = {{ constant = {ANGLES[0]} }}\n"
        f"right.arm_angle = {{ constant = {ANGLES[1]} }}\n[time]\nstart = 0.0\nstop = 0.0\nsamples = 1\n"
    )
    return Scene.load(scene)


def test_a_scene_keeps_its_mechanism_when_the_file_is_gone(axle: Scene, tmp_path: Path) -> None:
    (tmp_path / "axle.toml").unlink()
    assert Scene.from_mapping(axle.model_dump()) == axle
    assert Scene.from_mapping(axle.model_dump(mode="json", exclude_none=True)) == axle
    again = pickle.loads(pickle.dumps(axle))
    assert again == axle
    assert again.mechanism.plain(again.mechanism.driven) == axle.mechanism.plain(axle.mechanism.driven)


def test_the_plain_description_is_flat(axle: Scene) -> None:
    flat = axle.mechanism.plain(axle.inputs)
    assert flat["slides"]["left.rack"]["through"] == "left.rack_centre"
    assert flat["points"]["left.rack_centre"] == flat["points"]["left.tie_rod_inner"]
    assert flat["inputs"]["steer"] == {"travel": ["left.rack", "right.rack"]}
    assert set(flat["inputs"]) == set(axle.inputs)
    assert {*flat["bodies"]["chassis"]} == {
        f"{side}.{name}"
        for side in ("left", "right")
        for name in ("lower_arm_front", "lower_arm_rear", "upper_arm_front", "upper_arm_rear", "rack_centre")
    }


@pytest.mark.parametrize("driven", [("left.arm_angle", "left.wheel_travel", "rack")])
def test_three_inputs_of_one_corner_are_named_before_anything_is_solved(driven: tuple[str, ...]) -> None:
    content = Scene.load("axle-steer").model_dump(exclude_none=True)
    content["inputs"] = {name: constant(1.5 if "angle" in name else 0.0) for name in driven}
    with pytest.raises(SceneError) as caught:
        Scene.from_mapping(content)
    words = str(caught.value)
    assert "the inputs left.arm_angle, left.wheel_travel, rack drive more" in words
    assert "z of right.lower_ball_joint" in words.partition("leave free")[2]
    assert "right.wheel_travel" in words.partition("instead one of")[2]
