"""Two corners on one chassis with one rack: how they are read, kept and driven."""

import pickle
from pathlib import Path

import pytest

from pointcoord import Scene, SceneError
from pointcoord.mechanism.file import mechanism_file

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


def test_the_first_inputs_of_an_axle_do_not_drive_one_corner_three_times() -> None:
    driven = mechanism_file("axle").topology().required_inputs
    assert driven == ("left.arm_angle", "left.rack", "right.arm_angle", "right.rack")
