"""The program as its users meet it: output, exit status, and one clear line for every mistake."""

import csv
import io
import json
import re
import subprocess
import sys
from dataclasses import replace
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from pointcoord import Samples, Scene, built_in_scenes, simulate
from validate import cli
from validate.cli import main
from validate.output.motion_tables import write_csv
from validate.paper.scenes import DEFAULT_SCENES, PAPER_SCENES


def scene_file(folder: Path, *changes: tuple[str, str]) -> str:
    """A scene file made from `bounce` by replacing text."""
    text = (Path(cli.__file__).parent.parent / "pointcoord" / "scenes" / "bounce.toml").read_text()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path = folder / "mine.toml"
    path.write_text(text)
    return str(path)


@pytest.mark.parametrize("name", cli.COMMANDS)
def test_a_command_by_itself_is_the_one_among_all(name: str) -> None:
    texts = []
    for parser in (cli.parser([name]), cli.parser()):
        with pytest.raises(cli.Answer) as answer:
            parser.parse_args([name, "--help"])
        texts.append(str(answer.value))
    assert texts[0] == texts[1]
    assert texts[0].startswith(f"usage: pointcoord {name} ")


def test_the_command_that_is_asked_for_brings_no_other_with_it() -> None:
    program = "import sys; from validate import cli; cli.parser(['validate']); print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    found = {name for name in done.stdout.split() if name.startswith("validate.commands.")}
    # The way to a page is shared by the commands that can write one, and loads none of what a page needs.
    assert found == {f"validate.commands.{name}" for name in ("comparison", "reporting", "usage")}
    assert not {"validate.cost", "pinocchio", "mpmath", "pyarrow", "scipy"} & {*done.stdout.split()}


def test_the_main_job_prints_every_scene_and_ends_with_0(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["validate"]) == 0
    out, err = capsys.readouterr()
    # A warning is said once, with the scenes that it is about.
    (warning,) = err.splitlines()
    assert warning.startswith(f"pointcoord: warning: {', '.join(PAPER_SCENES)}: closing the drawing moves ")
    head, blank, columns, *lines = out.splitlines()
    assert (head, blank) == ("pointcoord and absolute; pointcoord-newton and absolute: 22 scenes", "")
    line = re.compile(r"(\S+) +agrees +\d+\.\d s +\d+%  .* at .* s(, .*)?")
    scenes = [found[1] for one in lines[: len(DEFAULT_SCENES)] if (found := line.fullmatch(one))]
    assert scenes == list(DEFAULT_SCENES)
    assert lines[-1] == f"{len(DEFAULT_SCENES)} of {len(DEFAULT_SCENES)} scenes agree."
    assert columns.split()[:3] == ["scene", "verdict", "time"]
    assert max(map(len, lines)) <= 120  # names of scenes and of points are as long as they are


def test_who_asks_for_more_gets_every_table(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["validate", "-v"]) == 0
    out = capsys.readouterr().out
    for name in built_in_scenes():
        assert f"{name}: pointcoord and absolute" in out
    assert "DISAGREES" not in out
    assert "factor 2" in out
    assert "Table 2" in out
    assert "Table 3" in out
    assert "cannot be matched to better than about 10 mm" in out


def test_json_goes_alone_to_standard_output(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["validate", "steer", "--json", "-", "--quiet"]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    data = json.loads(out)
    (scene,) = data["scenes"]
    comparison, further = scene["comparisons"]
    assert further["formulations"] == ["pointcoord-newton", "absolute"]
    assert comparison["agreed"] is True
    rows = {(row["quantity"], row["name"]) for row in comparison["rows"]}
    assert ("acceleration", "wheel_centre") in rows
    assert ("angular_velocity", "knuckle") in rows
    assert all(row["difference"] <= row["tolerance"] for row in comparison["rows"])
    assert {row["rests_on"] for row in comparison["rows"]} <= set(comparison["formulations"])
    # The steering scene's printed omega is 0/0: JSON has no such number.
    assert data["printed_formulas"][0]["worst"]["difference"] is None


def test_json_of_the_main_job_holds_the_printed_tables(tmp_path: Path) -> None:
    target = tmp_path / "all.json"
    assert main(["validate", "--json", str(target)]) == 0
    data = json.loads(target.read_text())
    assert [scene["scene"] for scene in data["scenes"]] == list(DEFAULT_SCENES)
    assert len(data["printed_tables"]["rows"]) == 18
    assert all(scene["refusals"] == [] for scene in data["scenes"])


def test_an_angle_that_only_degrees_explain_is_asked_about(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for value, asked in ("88.0", True), ("3.5", False), ("200.0", False):
        text = scene_file(
            tmp_path,
            ("arm_angle = { polynomial = [0.8, 0.25, 0.0625] }", f"arm_angle = {{ constant = {value} }}"),
        )
        assert main(["validate", text]) == 3
        out, err = capsys.readouterr()
        assert ("if 88 is meant in degrees, it is 1.535889742 rad" in err) == asked
        assert "0 of 1 scene agrees" in out
        assert "not tested (refused): " in out


def test_a_disagreement_ends_with_1(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["validate", "bounce", "--second", "printed"]) == 1
    assert "DISAGREES" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ([("strut_top        = [460, -180, 470]", "")], ["mechanism.points", "strut_top", "missing"]),
        (
            [("wheel_centre ", "wheel_center ")],
            ["mechanism.points", "wheel_center", "allowed", "wheel_centre"],
        ),
        ([("[460, -180, 470]", "[460, -180]")], ["mechanism.points.strut_top"]),
        ([("[460, -180, 470]", "[460, nan, 470]")], ["mechanism.points.strut_top.1", "finite"]),
        ([("[460, -180, 470]", "[460, 'x', 470]")], ["mechanism.points.strut_top.1", "'x'"]),
        ([("samples = 131", "samples = 0")], ["time.samples", "0"]),
        ([("stop = 2.6", "stop = -1.0")], ["time", "allowed: start < stop"]),
        (
            [("arm_angle =", "arm_angel =")],
            ["arm_angel", "allowed: arm_angle, rack, wheel_travel, contact_travel, heave"],
        ),
        ([("polynomial = [0.8", "polynom = [0.8")], ["inputs.arm_angle", "no such key"]),
        ([('"velocity"', '"speed"')], ["effects", "speed", "allowed: velocity"]),
        ([("tolerance = 1e-9", "tolerance = 0.0")], ["tolerance", "greater than 0"]),
        ([('type = "macpherson"', 'type = "mcpherson"')], ["mechanism.type", "macpherson"]),
        ([('side = "left"', 'side = "port"')], ["mechanism.side", "left"]),
        ([("[450, -330, -40]", "[452, -320, 20]")], ["mechanism.points", "has no length"]),
        ([("title =", "title")], ["not TOML"]),
    ],
)
def test_a_wrong_scene_ends_with_2_and_one_line_that_says_where(
    changes: list[tuple[str, str]], words: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = scene_file(tmp_path, *changes)
    assert main(["simulate", path, "-o", str(tmp_path / "out.csv")]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert len(err.splitlines()) == 1
    for word in words:
        assert word in err, err


@pytest.mark.parametrize(
    ("law", "words"),
    [
        ("[0.2, 0.25, 0.0625]", ["arm_angle", "assembly stopped at", "nothing is written"]),
        ("[0.8, 1.25, 0.0625]", ["input 'arm_angle' is 3.", "allowed: 0 to pi rad"]),
    ],
)
def test_a_scene_that_is_refused_ends_with_3_and_one_line_that_says_where(
    law: str, words: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = scene_file(tmp_path, ("[0.8, 0.25, 0.0625]", law))
    assert main(["simulate", path, "-o", str(tmp_path / "out.csv")]) == 3
    out, err = capsys.readouterr()
    assert out == ""
    (line,) = err.splitlines()
    assert line.startswith(f"pointcoord: {path}: ")
    for word in words:
        assert word in line
    assert not (tmp_path / "out.csv").exists()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["validate", "bounse"], ["bounse", "bounce"]),
        (["validate", "no/such/file.toml"], ["no/such/file.toml", "No such file"]),
        (["validate", "bounce", "--second", "adams"], ["adams", "absolute"]),
        (["simulate", "bounce", "-o", "x.xlsx"], ["x.xlsx", ".csv", ".npz"]),
        (["simulate", "bounce", "-o", ""], ["-o ''", "names no file"]),
        (["simulate", "bounce", "--method", "euler"], ["euler", "newton"]),
        (["validate", "steer", "--json", ""], ["--json ''", "names no file"]),
        (["validate", "steer", "--second", "pointcoord"], ["'pointcoord'", "with itself", "absolute"]),
        (["validate", "steer", "--first", "absolute"], ["'absolute'", "with itself", "--first"]),
        (["validate", "-", "-"], ["standard input", "more than once"]),
        (["validate", ""], ["''", "names no scene"]),
        (["validate", "steer", "--first", ""], ["without a name", "absolute"]),
        (["simulat", "bounce"], ["simulat", "--help"]),
        ([], ["--help"]),
    ],
)
def test_a_wrong_command_ends_with_2_and_one_line(
    arguments: list[str], words: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments) == 2
    err = capsys.readouterr().err
    assert len(err.splitlines()) == 1
    for word in words:
        assert word in err


LONG_NAME = "n" * 10_000


@pytest.mark.parametrize(
    ("arguments", "status"),
    [
        (["validate", LONG_NAME], 2),
        (["simulate", "bounce", "-o", f"{LONG_NAME}.csv"], 4),
        (["simulate", "bounce", "-o", f"a.{LONG_NAME}"], 2),
        (["sweep", "bounce", "--vary", f"{LONG_NAME}=1"], 2),
        (["new", LONG_NAME], 4),
        (["study", "random", "--records", LONG_NAME], 2),
        ([LONG_NAME], 2),
    ],
)
def test_a_name_of_ten_thousand_letters_is_not_echoed(
    arguments: list[str], status: int, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments) == status
    (line,) = capsys.readouterr().err.splitlines()
    assert "n" * 50 in line
    assert "n" * 61 not in line
    assert "defect" not in line


def test_a_motion_that_stops_halfway_keeps_what_was_solved(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = scene_file(tmp_path, ("[0.8, 0.25, 0.0625]", "[0.8, 0.8]"))
    target = tmp_path / "out.csv"
    assert main(["simulate", path, "-o", str(target)]) == 3
    (said,) = capsys.readouterr().err.splitlines()
    assert "cannot pass" in said
    with target.open(newline="") as stream:
        times = [float(row["time [s]"]) for row in csv.DictReader(stream)]
    assert said.endswith(f", {len(times)} instants up to t = {times[-1]:.10g} s, is in {target}")
    # The arm meets its dead point at 152.013 degrees.
    last = (np.radians(152.013) - 0.8) / 0.8
    assert times[0] == 0.0
    assert last - 0.02 < times[-1] <= last + 1e-4


UNITS = {
    "position": "mm",
    "velocity": "mm/s",
    "acceleration": "mm/s^2",
    "angular_velocity": "rad/s",
    "angular_acceleration": "rad/s^2",
}


@pytest.mark.parametrize("scene", ["bounce", "double-wishbone"])
@pytest.mark.parametrize("instants", [None, 7000])
def test_every_kind_of_file_gives_back_the_same_bits(
    scene: str, instants: int | None, tmp_path: Path
) -> None:
    motion: Samples = simulate(Scene.load(scene))
    more = []
    if instants:
        (motion,) = motion.blocks(instants, 7000)
        more = ["--instants", str(instants)]
    for name in ("m.csv", "m.npz"):
        assert main(["simulate", scene, *more, "-o", str(tmp_path / name)]) == 0
    with (tmp_path / "m.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    arrays = np.load(tmp_path / "m.npz")
    columns = {"time [s]": motion.times}
    for quantity, unit in UNITS.items():
        for name, array in motion.numbers[quantity].items():
            for i, axis in enumerate("xyz"):
                columns[f"{quantity}.{name}.{axis} [{unit}]"] = array[:, i]
    for name, angle in motion.wheel.items():
        columns[f"wheel.{name} [deg]"] = np.degrees(angle)
    for name, length in motion.dimension.items():
        columns[f"dimension.{name} [mm]"] = length
    assert list(rows[0]) == list(arrays) == list(columns)
    assert "position.wheel_centre.x [mm]" in columns
    for name, column in columns.items():
        assert [float(row[name]) for row in rows] == arrays[name].tolist()
        # How a sum of 21 terms is rounded depends on the block that it is computed in.
        most = 21 * 50 * float(np.finfo(float).eps) * np.abs(column).max() if instants else 0.0
        assert np.abs(arrays[name] - column).max() <= most


@pytest.mark.parametrize("instants", [None, 140_000])
def test_parquet_holds_what_npz_holds_and_needs_pyarrow(
    instants: int | None, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    more = ["--instants", str(instants)] if instants else []
    scene, target = scene_file(tmp_path, ('"velocity", "acceleration", ', "")), tmp_path / "m.parquet"
    found = find_spec("pyarrow") is not None
    assert main(["simulate", scene, *more, "-o", str(target)]) == (0 if found else 2)
    assert found or "pip install 'pointcoord[parquet]'" in capsys.readouterr().err
    if found:
        table = import_module("pyarrow.parquet").read_table(target)
        assert main(["simulate", scene, *more, "-o", str(tmp_path / "m.npz")]) == 0
        arrays = np.load(tmp_path / "m.npz")
        assert table.column_names == list(arrays)
        for name, array in arrays.items():
            np.testing.assert_array_equal(table[name].to_numpy(), array)


def test_parquet_without_pyarrow_is_refused_before_anything_is_solved(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow.parquet", None)
    assert main(["simulate", "steer", "-o", str(tmp_path / "m.parquet")]) == 2
    assert "pip install 'pointcoord[parquet]'" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_other_instants_than_the_scenes_need_series(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["simulate", "steer", "--method", "newton", "--instants", "10"]) == 2
    assert "--instants needs the method auto, series or map" in capsys.readouterr().err
    assert main(["simulate", "steer", "--instants", "0"]) == 2
    assert "allowed: 1 or more" in capsys.readouterr().err
    assert main(["simulate", "steer", "--instants", "3", "-q"]) == 0
    assert [line.partition(",")[0] for line in capsys.readouterr().out.splitlines()] == [
        "time [s]",
        "0.0",
        "0.2",
        "0.4",
    ]


def test_numbers_that_are_none_are_written_so_that_they_can_be_read() -> None:
    motion = simulate(Scene.load("steer"))
    broken = motion.position["wheel_centre"].copy()
    broken[:3, 0] = np.nan, np.inf, -np.inf
    arrays = {**motion.numbers["position"], "wheel_centre": broken}
    numbers = {**motion.numbers, "position": motion.numbers["position"].with_arrays(arrays)}
    text = io.StringIO(newline="")
    write_csv(text, replace(motion, numbers=numbers))
    rows = list(csv.DictReader(io.StringIO(text.getvalue())))
    found = [float(row["position.wheel_centre.x [mm]"]) for row in rows]
    np.testing.assert_array_equal(found, broken[:, 0])
    assert text.getvalue().count("nan") == 1
    assert text.getvalue().count("inf") == 2


def test_plan_says_what_is_left_out(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = scene_file(
        tmp_path, ('["velocity", "acceleration", "knuckle_rates", "wheel_angles"]', '["velocity"]')
    )
    assert main(["plan", path]) == 0
    out = capsys.readouterr().out
    assert "computed: velocity of every point" in out
    assert "left out: camber and kingpin angle" in out
    assert "solved for: positions and velocities\n" in out
    assert "evaluated: positions and velocities of every point\n" in out


def test_plan_says_which_points_are_evaluated_further_than_others(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = scene_file(
        tmp_path, ('["velocity", "acceleration", "knuckle_rates", "wheel_angles"]', '["knuckle_rates"]')
    )
    assert main(["plan", path]) == 0
    out = capsys.readouterr().out
    assert (
        "evaluated: positions, velocities and accelerations of lower_ball_joint, tie_rod_outer, strut_lower; "
        "positions of lower_arm_front, " in out
    )


@pytest.mark.parametrize(
    ("name", "words"),
    [
        (
            "bounce",
            [
                "from 0.562492 rad (32.228 deg), where it is held by link lower_ball_joint - lower_arm_rear",
                "camber is -6.993 deg",
                "from strut_lower (the default of wheel_axis_inner) to wheel_centre",
            ],
        ),
        (
            "double-wishbone",
            [
                "to   127.45 mm, where it is held by link tie_rod_inner - tie_rod_outer, link ",
                "kingpin is 6.997 deg",
                "from wheel_axis_inner to wheel_centre",
                "closes",
            ],
        ),
    ],
)
def test_plan_says_where_the_drawing_stands(
    name: str, words: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    """Lotus prints 7.00 degrees for the double wishbone; 32.228 degrees are README's."""
    assert main(["plan", name]) == 0
    out = capsys.readouterr().out
    for word in words:
        assert word in out


def test_scenes_lists_every_built_in_scene(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["scenes"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == list(built_in_scenes())
