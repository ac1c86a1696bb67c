"""The program as its users meet it: what each command prints and writes."""

import csv
import io
import json
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow.parquet
import pytest
from program import short_scene

from pointcoord import Samples, Scene, built_in_scenes, simulate
from pointcoord.results.named_columns import columns
from validate import cli
from validate.cli import main
from validate.commands.pages import summary
from validate.exit_status import MEANINGS, ORDER, ExitStatus
from validate.output.columns import csv_lines, rows_of_motion
from validate.paper.scenes import DEFAULT_SCENES


@pytest.mark.parametrize("name", cli.COMMANDS)
def test_every_command_has_its_help_and_the_overview_names_it(
    name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([name, "--help"]) == 0
    told = capsys.readouterr().out
    assert told.startswith(f"usage: pointcoord {name} ")
    assert main(["--help"]) == 0
    overview = capsys.readouterr().out
    assert re.search(rf"^  {name} +{re.escape(summary(name))}$", overview, flags=re.M)
    # Every status is explained where a user looks.
    for status in ExitStatus:
        line = rf"^ +{status.value}  {re.escape(MEANINGS[status])}$"
        assert re.search(line, told, flags=re.M)
        assert re.search(line, overview, flags=re.M)
    assert {*ORDER, ExitStatus.INTERRUPTED, ExitStatus.TERMINATED} == set(ExitStatus)


@pytest.mark.parametrize(
    "words", ["--help", "simulate steer -q", "table steer", "sweep steer --vary strut_top.z=0,1 --instants 2"]
)
def test_a_command_brings_nothing_with_it_that_it_does_not_need(words: str) -> None:
    """So that solving needs no extra. The package itself is the program."""
    program = f"import runpy, sys; sys.argv[1:] = {words.split()}\ntry: runpy.run_module('validate', {{}}, "
    program += "'__main__')\nfinally: print(*sys.modules, file=sys.stderr)"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    loaded = {*done.stderr.split()}
    others = ("pinocchio", "mpmath", "flint", "pandas", "pyarrow", "scipy", "dask", "matplotlib")
    others += ("threadpoolctl", "validate.cost", "validate.html", "validate.reference")
    assert not {*others} & loaded


# Of all built-in scenes, which `.ci/run` compares; one has the longest name.
FEW = ("bounce", "steer", "bounce-on-a-heaving-chassis", "five-link")


def test_the_main_job_prints_every_scene_and_ends_with_0(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert {*DEFAULT_SCENES} == {*built_in_scenes()}
    monkeypatch.setattr("validate.commands.comparison.DEFAULT_SCENES", FEW)
    assert main(["validate", "--json", str(tmp_path / "all.json")]) == 0
    out, err = capsys.readouterr()
    # A warning is said once, with the scenes that it is about.
    (warning,) = err.splitlines()
    assert warning.startswith(f"pointcoord: warning: {', '.join(FEW[:3])}: closing the drawing moves ")
    head, blank, titles, *lines = out.splitlines()
    assert (head, blank) == ("pointcoord and absolute; pointcoord-newton and absolute: 4 scenes", "")
    line = re.compile(r"(\S+) +agrees +\d+\.\d s +\d+%  .* at .* s(, .*)?")
    scenes = [found[1] for one in lines[: len(FEW)] if (found := line.fullmatch(one))]
    assert scenes == list(FEW)
    assert lines[-1] == "4 of 4 scenes agree."
    assert titles.split()[:3] == ["scene", "verdict", "time"]
    assert max(map(len, lines)) <= 120  # names of scenes and of points are as long as they are
    data = json.loads((tmp_path / "all.json").read_text())
    assert [scene["scene"] for scene in data["scenes"]] == list(FEW)
    assert len(data["printed_tables"]["rows"]) == 18
    assert all(scene["refusals"] == [] for scene in data["scenes"])
    assert main(["validate", "-v"]) == 0
    out = capsys.readouterr().out
    assert "DISAGREES" not in out
    told = ("factor 2", "10.3 mm r.m.s.", "cannot be matched to better than about 10 mm")
    for words in (*told, *(f"{name}: pointcoord and absolute" for name in FEW)):
        assert words in out


@pytest.mark.parametrize(("scene", "instants"), [("bounce", None), ("double-wishbone", 7000)])
def test_every_kind_of_file_gives_back_the_same_bits(
    scene: str, instants: int | None, tmp_path: Path
) -> None:
    motion: Samples = simulate(Scene.load(scene))
    more = []
    if instants:
        (motion,) = motion.blocks(instants, instants)
        more = ["--instants", str(instants)]
    for name in ("m.csv", "m.npz", "m.parquet"):
        assert main(["simulate", scene, *more, "-o", str(tmp_path / name)]) == 0
    with (tmp_path / "m.csv").open(newline="") as stream:
        head, *rows = csv.reader(stream)
    texts = np.array(rows, dtype=float).T
    arrays, table = np.load(tmp_path / "m.npz"), pyarrow.parquet.read_table(tmp_path / "m.parquet")
    wanted = dict(columns(motion))
    assert head == list(arrays) == table.column_names == list(wanted)
    assert {"position.wheel_centre.x [mm]", "wheel.camber [deg]"} <= {*head}
    for name, text in zip(head, texts, strict=True):
        np.testing.assert_array_equal(text, arrays[name])
        np.testing.assert_array_equal(text, table[name].to_numpy())
        # How a sum of 21 terms is rounded depends on the block that it is computed in.
        most = 21 * 50 * float(np.finfo(float).eps) * np.abs(wanted[name]).max() if instants else 0.0
        assert np.abs(text - wanted[name]).max() <= most


def test_instants_are_evenly_over_the_scene_s_time(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["simulate", "steer", "--instants", "3", "-q"]) == 0
    times = [line.partition(",")[0] for line in capsys.readouterr().out.splitlines()]
    assert times == ["time [s]", "0.0", "0.2", "0.4"]


def test_numbers_that_are_none_are_written_so_that_they_can_be_read() -> None:
    motion = simulate(Scene.load("steer"))
    broken = motion.position["wheel_centre"].copy()
    broken[:3, 0] = np.nan, np.inf, -np.inf
    arrays = {**motion.numbers["position"], "wheel_centre": broken}
    numbers = {**motion.numbers, "position": motion.numbers["position"].with_arrays(arrays)}
    text = "".join(csv_lines(rows_of_motion(replace(motion, numbers=numbers))))
    rows = list(csv.DictReader(io.StringIO(text)))
    found = [float(row["position.wheel_centre.x [mm]"]) for row in rows]
    np.testing.assert_array_equal(found, broken[:, 0])
    assert (text.count("nan"), text.count("inf")) == (1, 2)


@pytest.mark.parametrize(
    ("scene", "effects", "words"),
    [
        (
            None,
            '["velocity"]',
            [
                "computed: velocity of every point",
                "left out: acceleration, jerk, snap, crackle, pop, knuckle_rates, ",
            ],
        ),
        ("bounce", "", ["from strut_lower (the default of wheel_axis_inner) to wheel_centre"]),
        (
            "double-wishbone",
            "",
            [
                "to   127.45 mm, stopped by link tie_rod_outer - upper_ball_joint, link ",
                "kingpin is 6.997 deg",
                "from wheel_axis_inner to wheel_centre",
                "closes",
            ],
        ),
    ],
)
def test_plan_says_what_is_computed_and_where_the_drawing_stands(
    scene: str | None, effects: str, words: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Lotus prints 7.00 degrees for the double wishbone."""
    assert main(["plan", scene or short_scene(tmp_path, effects=effects)]) == 0
    out = capsys.readouterr().out
    assert [word for word in words if word not in out] == []


def test_scenes_lists_every_built_in_scene(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["scenes"]) == 0
    assert [line.split()[0] for line in capsys.readouterr().out.splitlines()] == list(built_in_scenes())


def test_the_readme_s_picture_is_what_its_command_makes(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    picture, target = Path(__file__).parents[3] / ".github" / "hardpoints.svg", tmp_path / "car.svg"
    assert main(["draw", "off-axis-strut"]) == 0
    assert main(["draw", "off-axis-strut", "-o", str(target)]) == 0
    out, err = capsys.readouterr()
    assert (out, err) == (target.read_text(), "")
    # How far closing moves the points is rounding, which another machine rounds otherwise.
    made, kept = (
        [line for line in text.splitlines() if "moves by" not in line] for text in (out, picture.read_text())
    )
    assert made == kept


def test_a_table_in_text_says_each_sign_and_in_markdown_too(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["table", "semi-trailing-arm", "--number", "camber", "--number", "recession"]
    assert main(words) == 0
    said = capsys.readouterr().out
    assert "camber [deg]" in said
    assert "camber: positive where the wheel leans out at the top" in said
    assert main([*words, "-o", str(tmp_path / "t.md")]) == 0
    text = (tmp_path / "t.md").read_text("utf-8")
    assert "- recession: positive where the contact point goes rearward" in text
