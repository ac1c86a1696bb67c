"""What a law of an input may be written as, and what it then stands for."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mechanism_files import scene_file, scene_text

from pointcoord import Scene, SceneError, simulate
from validate.toml_written import written

AROUND = {"sine": {"amplitude": 0.1, "angular_frequency": 6.0}}
HELD = {"constant": 0.0}


def wishbone(arm_angle: Any) -> dict[str, Any]:
    return {**scene_file("double-wishbone"), "inputs": {"arm_angle": arm_angle, "rack": HELD}}


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


def test_units_and_tables_in_files_hold_for_terms_too(tmp_path: Path) -> None:
    (tmp_path / "bump.csv").write_text("0,0\n0.5,0.01\n1,0.02\n2,0.01\n")
    content = wishbone({"constant": "drawn"})
    points = {n: [c / 1000 for c in place] for n, place in content["mechanism"]["points"].items()}
    part = {"type": "double_wishbone", "side": "right", "points": points, "wheel_radius": 0.3}
    laws = {"wheel_travel": {"sum": [{"table": "bump.csv"}, {"constant": 0.005}]}, "rack": HELD}
    time = {"start": 0.0, "stop": 2.0, "samples": 5}
    path = tmp_path / "car.toml"
    path.write_text("\n".join(written({"units": "m", "mechanism": part, "inputs": laws, "time": time})))
    travel = Scene.load(path).functions["wheel_travel"].series(np.array([0.0, 1.0]), 0)[:, 0]
    # mm, of one product and one sum.
    assert np.abs(travel - [5.0, 25.0]).max() <= 4 * np.spacing(25.0)


TIMES, VALUES = [0.0, 0.2, 0.4, 0.6, 0.8, 1.0], [-50.0, -32.0, -7.5, 8.25, 31.0, 50.0]


def wheel_travel(folder: Path, law: str) -> Path:
    path = folder / "car.toml"
    path.write_text(scene_text("wheel-travel").replace("{ polynomial = [-50.0, 100.0] }", law))
    return path


@pytest.mark.parametrize("head", ["", "time [s],travel [mm]\n", "t,travel (left)\n", "\n"])
def test_a_table_beside_the_scene_is_the_one_in_it(tmp_path: Path, head: str) -> None:
    lines = [f"{t!r},{v!r}\n" for t, v in zip(TIMES, VALUES, strict=True)]
    (tmp_path / "bump.csv").write_text(head + "".join(lines))
    beside = Scene.load(wheel_travel(tmp_path, '{ table = "bump.csv" }'))
    inside = Scene.load(wheel_travel(tmp_path, f"{{ table = {{ times = {TIMES}, values = {VALUES} }} }}"))
    assert beside.inputs == inside.inputs


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("t,z\n0,1\n1\n", "bump.csv: line 3: is '1'; allowed: two columns of numbers"),
        ("0,down\n1,2\n", "bump.csv: line 1: is '0,down'; allowed"),
        ("0,1\n0.5,up\n", "bump.csv: line 2: is '0.5,up'; allowed"),
        (
            "t [ms],z\n0,1\n",
            "bump.csv: line 1: says that the first column, time, is in ms; allowed: s or sec",
        ),
        (
            "t,z (m)\n0,1\n",
            "bump.csv: line 1: says that the second column, the input, is in m; allowed: mm;",
        ),
        ("0,1\n0.5,2\n0.5,3\n1,4\n", "table: times do not increase: 0.5 follows 0.5; allowed"),
        ("", "inputs.wheel_travel.table.times: "),
        (None, "file or directory); allowed: the path of a file of two columns, from the scene's folder"),
    ],
)
def test_a_file_that_is_no_table_is_refused_with_its_place(
    tmp_path: Path, text: str | None, words: str
) -> None:
    if text is not None:
        (tmp_path / "bump.csv").write_text(text)
    with pytest.raises(SceneError) as caught:
        Scene.load(wheel_travel(tmp_path, '{ table = "bump.csv" }'))
    assert words in str(caught.value)
