"""Scene files: every fault names the file, the key, the value and what is allowed."""

import copy
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from pointcoord import PointcoordError, Scene, SceneError, simulate

POINTS = "\n".join(
    f"{name} = {place}"
    for name, place in {
        "lower_arm_front": [270, -5, -10],
        "lower_arm_rear": [540, -10, -20],
        "rack_centre": [570, 60, 90],
        "strut_top": [460, -180, 470],
        "lower_ball_joint": [450, -330, -40],
        "tie_rod_outer": [560, -300, 60],
        "strut_lower": [452, -320, 20],
        "strut_rod_end": [456, -250, 246],
        "tie_rod_inner": [570, 60, 90],
        "wheel_centre": [452, -410, 20],
    }.items()
)
GOOD = f"""
title = "a test"
effects = ["velocity"]
tolerance = 1e-9

[mechanism]
type = "macpherson"
side = "left"

[mechanism.points]
{POINTS}

[inputs]
arm_angle = {{ polynomial = [0.8, 0.25] }}
rack = {{ constant = 0.0 }}

[time]
start = 0.0
stop = 2.0
samples = 5
"""
RACK = "rack = { constant = 0.0 }"
# name: (text to replace, by what, key at fault, value shown, what is allowed)
# fmt: off
FAULTS: dict[str, tuple[str, str, str, str, str]] = {
    "unknown top key": ("tolerance = 1e-9", "tolerence = 1e-9", "tolerence", "", "tolerance"),
    "unknown key of time": ("samples = 5", "samples = 5\nstep = 1", "time.step", "", "samples"),
    "unknown kind of input": ("constant = 0.0", "constnt = 0.0", "inputs.rack", "constnt", "polynomial"),
    "missing section": ("[time]\nstart = 0.0\nstop = 2.0\nsamples = 5", "", "time", "", ""),
    "missing key": ("stop = 2.0\n", "", "time.stop", "", ""),
    "unknown mechanism": ('"macpherson"', '"wishbone"', "mechanism.type", "wishbone", "macpherson"),
    "unknown side": ('"left"', '"middle"', "mechanism.side", "middle", "right"),
    "unknown effect": ('["velocity"]', '["velocty"]', "effects", "velocty", "velocity, acceleration"),
    "effects not a list": ('["velocity"]', '"velocity"', "effects", "velocity", ""),
    "tolerance zero": ("1e-9", "0.0", "tolerance", "0.0", "greater than 0"),
    "tolerance negative": ("1e-9", "-1e-9", "tolerance", "-1e-09", "greater than 0"),
    "tolerance text": ("1e-9", '"small"', "tolerance", "small", "number"),
    "tolerance infinite": ("1e-9", "inf", "tolerance", "inf", "finite"),
    "unknown point": ("strut_top = [", "strut_topp = [", "mechanism.points", "strut_topp", "strut_top"),
    "missing point": ("strut_top = [460, -180, 470]\n", "", "mechanism.points", "strut_top", "needed"),
    "point of two numbers": ("[460, -180, 470]", "[460, -180]", "mechanism.points.strut_top", "", ""),
    "point of four numbers": ("[460, -180, 470]", "[460, -180, 470, 1]", "mechanism.points.strut_top", "",
        "3"),
    "point not a number": ("[460, -180, 470]", "[460, nan, 470]", "mechanism.points.strut_top.1", "nan",
        "finite"),
    "point is text": ("[460, -180, 470]", '[460, "a", 470]', "mechanism.points.strut_top.1", "a", "number"),
    "point is true": ("[460, -180, 470]", "[460, true, 470]", "mechanism.points.strut_top.1", "True",
        "number"),
    "up not a unit vector": ('"left"', '"left"\nup = [0, 0, 2]', "mechanism", "2", "unit"),
    "up along right": ('"left"', '"left"\nup = [0, 1, 0]', "mechanism", "(0.0, 1.0, 0.0)", "right angles"),
    "unknown input": (RACK, RACK + "\nroll = { constant = 0.0 }", "", "roll",
        "arm_angle, rack, steering_wheel, wheel_travel, contact_travel, heave"),
    "missing input": (RACK, "", "", "arm_angle", "drive 1 more of rack"),
    "two kinds of input": ("constant = 0.0", "constant = 0.0, polynomial = [1.0]", "inputs.rack",
        "constant and polynomial", "exactly one"),
    "no kind of input": (RACK, "rack = {}", "inputs.rack", "nothing", "exactly one"),
    "input is a number": (RACK, "rack = 5", "inputs.rack", "5", ""),
    "input infinite": ("constant = 0.0", "constant = inf", "inputs.rack.constant", "inf", "finite"),
    "empty polynomial": ("constant = 0.0", "polynomial = []", "inputs.rack.polynomial", "", "1 item"),
    "sine without amplitude": ("constant = 0.0", "sine = { angular_frequency = 1.0 }",
        "inputs.rack.sine.amplitude", "", ""),
    "short table": ("constant = 0.0", "table = { times = [0, 1], values = [0, 1] }",
        "inputs.rack.table.times", "", "4 items"),
    "table of unequal lengths": ("constant = 0.0",
        "table = { times = [0, 1, 2, 3], values = [0, 1, 2, 3, 4] }", "inputs.rack.table",
        "4 times and 5 values", "as many"),
    "table out of order": ("constant = 0.0", "table = { times = [0, 2, 1, 3], values = [0, 1, 2, 3] }",
        "inputs.rack.table", "do not increase", "strictly increasing"),
    "table too short in time": ("constant = 0.0",
        "table = { times = [0, 0.5, 1, 1.5], values = [0, 1, 2, 3] }", "", "0.0 to 1.5", "0.0 to 2.0"),
    "time backwards": ("stop = 2.0", "stop = -2.0", "time", "-2.0", "start < stop"),
    "one sample of a stretch": ("samples = 5", "samples = 1", "time", "one sample", "start = stop"),
    "no samples": ("samples = 5", "samples = 0", "time.samples", "0", "greater than or equal to 1"),
    "half a sample": ("samples = 5", "samples = 2.5", "time.samples", "2.5", "integer"),
    "too many samples": ("samples = 5", "samples = 10000001", "time.samples", "10000001", "10000000"),
    "start not a number": ("start = 0.0", "start = nan", "time.start", "nan", "finite"),
}
# fmt: on


def test_the_scene_that_the_faults_are_planted_in_is_right(tmp_path: Path) -> None:
    path = tmp_path / "good.toml"
    path.write_text(GOOD)
    scene = Scene.load(path)
    assert scene.instants.tolist() == [0.0, 0.5, 1.0, 1.5, 2.0]
    assert simulate(scene).velocity["wheel_centre"].shape == (5, 3)


@pytest.mark.parametrize("fault", FAULTS)
def test_fault_names_file_key_value_and_what_is_allowed(tmp_path: Path, fault: str) -> None:
    before, after, key, value, allowed = FAULTS[fault]
    assert GOOD.count(before) == 1
    path = tmp_path / "broken.toml"
    path.write_text(GOOD.replace(before, after))
    with pytest.raises(SceneError) as caught:
        Scene.load(path)
    error, message = caught.value, str(caught.value)
    assert error.source == str(path)
    assert str(path) in message
    assert key in error.key
    assert "\n" not in message
    assert value in message
    assert allowed in message.replace(str(path), "")


@pytest.mark.parametrize(
    ("content", "problem"),
    [(b"title = ", "not TOML"), (b"\xff\xfe", "not TOML"), (b"a = " + b"[" * 5000, "not TOML")],
    ids=["cut off", "not text", "too deep"],
)
def test_file_that_is_not_toml_is_refused(tmp_path: Path, content: bytes, problem: str) -> None:
    path = tmp_path / "broken.toml"
    path.write_bytes(content)
    with pytest.raises(SceneError, match=problem) as caught:
        Scene.load(path)
    assert caught.value.source == str(path)


@pytest.mark.parametrize("name", ["bounse", "", "no/such/file.toml", "a\0b"])
def test_scene_that_is_not_there_is_answered_with_the_built_in_ones(name: str) -> None:
    with pytest.raises(SceneError, match="bounce, bounce-and-steer"):
        Scene.load(name)


LARGE: dict[str, dict[str, Any]] = {
    "rack of 1e308 t": {"inputs": {"rack": {"polynomial": [0.0, 1e308]}}},
    "rack of 1e200 t": {"inputs": {"rack": {"polynomial": [0.0, 1e200]}}},
    "sine of 1e17 rad/s": {"inputs": {"rack": {"sine": {"amplitude": 1.0, "angular_frequency": 1e17}}}},
    "sine of 1e308 mm": {"inputs": {"rack": {"sine": {"amplitude": 1e308, "angular_frequency": 1.0}}}},
    "time of 1e308 s": {"time": {"start": -1e308, "stop": 1e308}},
    "whole number of 400 digits": {"inputs": {"rack": {"constant": 10**400}}},
}


@pytest.mark.parametrize("case", LARGE)
def test_numbers_too_large_for_the_arithmetic_end_in_an_error_of_this_package(
    make_scene: Callable[..., Scene], case: str
) -> None:
    content = copy.deepcopy(make_scene().model_dump(exclude_none=True))
    for section, changes in LARGE[case].items():
        content[section].update(changes)
    with pytest.raises(PointcoordError):
        simulate(Scene.from_mapping(content))


@pytest.mark.parametrize(
    ("points", "problem"),
    [
        (["strut_tob"], "no point of this car is called 'strut_tob' (did you mean 'strut_top'?); allowed: "),
        (["wheel_axis_inner"], "no point of this car is called 'wheel_axis_inner'"),
        ([], "none is named; allowed: one or more of lower_arm_front, "),
        (["strut_top", "strut_lower", "strut_top"], "'strut_top' is named twice; allowed: each point once"),
        ([3], "3"),
        ("strut_top", "strut_top"),
    ],
)
def test_points_to_report_are_points_of_the_car_each_once(points: object, problem: str) -> None:
    content = Scene.load("bounce").model_dump(exclude_none=True) | {"points": points}
    with pytest.raises(SceneError) as caught:
        Scene.from_mapping(content)
    assert caught.value.key.split(".")[0] == "points"
    assert problem in str(caught.value)
