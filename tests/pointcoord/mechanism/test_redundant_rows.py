"""Mechanisms with more equations than they need, and with parts that move in more ways than one."""

import pickle
from pathlib import Path

import numpy as np
import pytest
from changed_scenes import content_of, scene_with
from three_mechanics import scene_of

from pointcoord import (
    MechanismError,
    Scene,
    SceneError,
    kinematic_map,
    simulate,
    solve_poses,
    standing,
    sweep,
)
from pointcoord.mechanism.file import MECHANISMS


def four_bar(tilt: float) -> Scene:
    """Of hinges along y, the last one tilted."""
    pins = {"a": (0, 0, 0), "b": (0, 0, 100), "c": (200, 0, 160), "d": (250, 0, 0)}
    points = {name: [float(x) for x in place] for name, place in pins.items()}
    points |= {f"{name}_far": [x, y + 50.0, z] for name, (x, y, z) in points.items()}
    points["d_far"][2] += tilt
    bodies = {
        "chassis": ["a", "a_far", "d", "d_far"],
        "crank": ["a", "a_far", "b", "b_far"],
        "coupler": ["b", "b_far", "c", "c_far"],
        "rocker": ["c", "c_far", "d", "d_far"],
    }
    inputs = {"turn": {"angle": "crank", "from": "drawing"}}
    return scene_of({"bodies": bodies, "inputs": inputs, "points": points}, [], turn=[0.0, 0.4])


@pytest.mark.parametrize("tilt", [1.0, 1e-6])
def test_hinges_that_are_not_parallel_lock_a_four_bar(tilt: float) -> None:
    hinges = "a - a_far, d - d_far, b - b_far, c - c_far"
    with pytest.raises(SceneError, match=f"is locked.*the hinges {hinges} are meant to be parallel"):
        four_bar(tilt)


def test_one_of_two_rods_side_by_side_is_left_out() -> None:
    # A motorcycle's swing arm pulls a rocker by two dogbones. At 385.6 mm below the drawing they lie level.
    # The rocker stops the arm only where it comes into line with them.
    bodies = {
        "chassis": ["pivot_left", "pivot_right", "rocker_left", "rocker_right"],
        "swing_arm": ["pivot_left", "pivot_right", "arm_left", "arm_right", "wheel"],
        "rocker": ["rocker_left", "rocker_right", "bone_left", "bone_right"],
    }
    sides = {"pivot": (0, 120, 450), "arm": (190, 40, 400), "rocker": (60, 30, 300), "bone": (150, 40, 270)}
    points = {
        f"{name}_{side}": [x, sign * y, z]
        for name, (x, y, z) in sides.items()
        for side, sign in (("left", -1), ("right", 1))
    }
    mechanism = {
        "bodies": bodies,
        "rods": {side: [f"arm_{side}", f"bone_{side}"] for side in ("left", "right")},
        "inputs": {"wheel_travel": {"height": "wheel"}},
        "points": points | {"wheel": [590, 0, 370]},
    }
    scene = Scene.from_mapping({"mechanism": mechanism, "inputs": {"wheel_travel": {"sweep": [0.0, -402.0]}}})
    last = simulate(scene).position
    assert last["wheel"][-1, 2] == pytest.approx(370.0 - 402.0, abs=1e-9)
    # In line, the dogbone less the rocker's arm spans from the swing arm's end to the rocker's hinge.
    low = standing(scene).reach["wheel_travel"][0].value
    arm, wheel = np.subtract([190, 400], [0, 450]), np.subtract([590, 370], [0, 450])
    drawn = np.arctan2(wheel[1], wheel[0])
    turn = np.arcsin((wheel[1] + low) / np.hypot(*wheel)) - drawn
    cosine, sine = np.cos(turn), np.sin(turn)
    end = [cosine * arm[0] - sine * arm[1], 450 + sine * arm[0] + cosine * arm[1]]
    span = np.hypot(*np.subtract(end, [60, 300]))
    assert span == pytest.approx(np.hypot(40, 130) - np.hypot(90, 30), abs=1e-6)


def test_a_violated_row_is_named_by_maps_poses_and_sweeps() -> None:
    # A hinge is 1e-8 mm off: it closes, and its rows seem to depend on each other as drawn.
    scene = scene_with("bricard", {"points": {"P1": [1000.0 + 1e-8, 0.0, 0.0]}})
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


def test_a_scene_keeps_its_mechanism_when_the_file_is_gone(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    file.write_bytes((MECHANISMS / "axle.toml").read_bytes())
    axle = scene_with("axle-steer", {"type": str(file)})
    file.unlink()
    assert Scene.from_mapping(axle.model_dump()) == axle
    assert Scene.from_mapping(axle.model_dump(mode="json", exclude_none=True)) == axle
    again = pickle.loads(pickle.dumps(axle))
    assert again == axle
    assert again.mechanism.plain(again.mechanism.driven) == axle.mechanism.plain(axle.mechanism.driven)


def test_a_mechanism_that_is_held_twice_has_no_forces() -> None:
    content = content_of("bricard")
    plain = Scene.from_mapping(content).mechanism.structure.plain(content["inputs"])
    body = next(body for body in plain["bodies"] if body != "chassis")
    content["mechanism"] |= {key: plain[key] for key in ("bodies", "rods", "slides", "inputs")}
    content["mechanism"] |= {"type": None, "wheel_radius": 300.0, "loads": {"": {"force": [0.0, 0.0, 3e3]}}}
    content["mechanism"]["roles"] = {"knuckle": body, "wheel_axis": plain["bodies"][body][:2]}
    with pytest.raises(SceneError, match="follow from the others"):
        Scene.from_mapping({**content, "effects": ["loads"]})


def test_a_tripod_of_rods_is_refused_as_a_structure() -> None:
    mechanism = {
        "bodies": {"chassis": ["a", "b", "c"]},
        "rods": {"r1": ["a", "p"], "r2": ["b", "p"], "r3": ["c", "p"]},
        "points": {"a": [0, 0, 0], "b": [300, 0, 0], "c": [0, 300, 10], "p": [100, 100, 300]},
    }
    with pytest.raises(SceneError, match="no freedoms, and 0 are driven; it is locked"):
        scene_of(mechanism, [])
