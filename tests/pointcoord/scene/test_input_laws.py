"""What a law of an input may be written as, and what it then stands for."""

import tomllib
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pointcoord import Scene, SceneError, simulate

AROUND = {"sine": {"amplitude": 0.1, "angular_frequency": 6.0}}


HELD = {"constant": 0.0}


def wishbone(arm_angle: Any, rack: Any = HELD) -> dict[str, Any]:
    text = resources.files("pointcoord").joinpath("scenes", "double-wishbone.toml").read_text("utf-8")
    return {**tomllib.loads(text), "inputs": {"arm_angle": arm_angle, "rack": rack}}


@pytest.mark.parametrize(
    "law",
    [
        {"sum": [{"constant": "drawn"}, AROUND]},
        {"sine": {**AROUND["sine"], "offset": "drawn"}},
        {"sum": [{"sweep": ["drawn", "drawn"]}, AROUND]},
        {"sum": [{"polynomial": ["drawn", 0.0]}, {"sum": [AROUND, {"constant": 0.0}]}]},
        {"sum": [AROUND, {"table": {"times": [0, 1, 2, 3], "values": ["drawn"] * 4}}]},
    ],
)
def test_at_its_drawn_value_an_input_leaves_every_point_where_it_is_drawn(law: Any) -> None:
    scene = Scene.from_mapping(wishbone(law))
    motion = simulate(scene)
    # Its arm is 417 mm long: the angle is rounded to 2e-16, and the rows to some ten units of 1e-13 mm.
    for name, drawn in scene.mechanism.points.items():
        assert np.allclose(motion.position[name][0], drawn, rtol=0.0, atol=2e-12)
    amplitude, frequency = 0.1, 6.0
    (value,) = scene.functions["arm_angle"].series(np.array([0.2]), 0)[:, 0]
    (drawn_value,) = scene.functions["arm_angle"].series(np.array([0.0]), 0)[:, 0]
    assert abs(value - drawn_value - amplitude * np.sin(frequency * 0.2)) <= 4e-16


@pytest.mark.parametrize("still", [{"constant": "drawn"}, {"sum": [{"constant": "drawn"}, HELD]}])
def test_a_scene_whose_inputs_are_constant_is_one_pose_and_needs_no_time(still: Any) -> None:
    content = {name: value for name, value in wishbone(still).items() if name != "time"}
    scene = Scene.from_mapping(content)
    assert scene.instants.tolist() == [0.0]
    motion = simulate(scene)
    for name, drawn in scene.mechanism.points.items():
        assert np.allclose(motion.position[name], [drawn], rtol=0.0, atol=2e-12)
    with pytest.raises(SceneError, match="time: this key is missing"):
        Scene.from_mapping({**content, "inputs": {"arm_angle": AROUND, "rack": HELD}})


def test_units_and_tables_in_files_hold_for_terms_too(tmp_path: Path) -> None:
    (tmp_path / "bump.csv").write_text("0,0\n0.5,0.01\n1,0.02\n2,0.01\n")
    laws = '{ sum = [{ table = "bump.csv" }, { constant = 0.005 }] }'
    lines = ["wheel_radius = 0.3", "[inputs]", f"wheel_travel = {laws}", "rack = { constant = 0.0 }"]
    content = wishbone({"constant": "drawn"})
    points = (
        f"{name} = {[c / 1000 for c in place]}" for name, place in content["mechanism"]["points"].items()
    )
    text = ['units = "m"', "[mechanism.points]", *points]
    text += ["[mechanism]", 'type = "double_wishbone"', 'side = "right"', *lines, "[time]"]
    text += ["start = 0.0", "stop = 2.0", "samples = 5"]
    path = tmp_path / "car.toml"
    path.write_text("\n".join(text))
    travel = Scene.load(path).functions["wheel_travel"].series(np.array([0.0, 1.0]), 0)[:, 0]
    # mm, of one product and one sum.
    assert np.abs(travel - [5.0, 25.0]).max() <= 4 * np.spacing(25.0)


@pytest.mark.parametrize(
    ("law", "words"),
    [
        (
            {"constant": "draw"},
            "arm_angle.constant: is 'draw' (did you mean 'drawn'?); allowed: a number, or \"drawn\"",
        ),
        ({"polynomial": [0.0, "up"]}, "arm_angle.polynomial.1: is 'up'; allowed: a number, or \"drawn\""),
        ({"sum": [{"sine": {**AROUND["sine"], "offset": "up"}}]}, "arm_angle.sum.0.sine.offset: is 'up'; a"),
        ({"table": {"times": [0, 1, 2, 3], "values": ["up"] * 4}}, "arm_angle.table.values.0: is 'up'; a"),
        (
            {"sine": {"amplitude": "drawn", "angular_frequency": 1.0}},
            "arm_angle.sine.amplitude: Input",
        ),
        ({"sum": []}, "inputs.arm_angle.sum: Value should have at least 1 item"),
        (
            {"sum": [AROUND], "constant": 3.0},
            "arm_angle: constant and sum given; allowed: exactly one",
        ),
        (
            {"sum": [{"sweep": [0.0, "up"]}]},
            "arm_angle.sum.0.sweep: is [0.0, 'up']; allowed: two",
        ),
        (
            {"sum": [{"swep": [0.0, 1.0]}]},
            "inputs.arm_angle.sum.0.swep: there is no such key (did you mean 'sweep'?)",
        ),
    ],
)
def test_what_is_no_law_is_refused_with_its_place(law: Any, words: str) -> None:
    with pytest.raises(SceneError) as caught:
        Scene.from_mapping(wishbone(law))
    assert words in str(caught.value)


@pytest.mark.parametrize(
    ("inputs", "words"),
    [
        (("arm_angle", "rack"), r"no input is called 'arm_angle' \(did you mean 'left.arm_angle'"),
        (("rack",), "the axle has 4 freedoms, and 1 is driven: rack"),
    ],
)
def test_drawn_values_of_inputs_that_do_not_hold_the_car_hide_no_fault(
    inputs: tuple[str, ...], words: str
) -> None:
    content = Scene.load("axle-steer").model_dump(exclude_none=True)
    content["inputs"] = {name: {"constant": "drawn"} for name in inputs}
    with pytest.raises(SceneError, match=words):
        Scene.from_mapping(content)
