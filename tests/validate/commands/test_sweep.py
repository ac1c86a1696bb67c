"""`pointcoord sweep`: what it writes is the designs one by one, and every mistake is told in a line."""

import csv
import json
import tracemalloc
from pathlib import Path

import jsonschema
import numpy as np
import pyarrow.parquet
import pytest

from pointcoord import Scene, simulate, sweep
from pointcoord.results.named_columns import columns
from validate.cli import main
from validate.commands.sweep import DESCRIPTION
from validate.output.document import schema_text
from validate.output.sweep_tables import write_sweep

SCENE = "double-wishbone"
VARY = ("--vary", "lower_ball_joint.z=-10,0,150", "--vary", "upper_ball_joint.y=0:1:2")
HEIGHTS, SIDES = (-10.0, 0.0, 150.0), (0.0, 1.0)
INSTANTS = ("--instants", "5")


def design(number: int) -> Scene:
    """The designs of `VARY` by hand."""
    scene = Scene.load(SCENE)
    points = dict(scene.mechanism.points)
    x, y, z = points["lower_ball_joint"]
    points["lower_ball_joint"] = (x, y, z + HEIGHTS[number // 2])
    x, y, z = points["upper_ball_joint"]
    points["upper_ball_joint"] = (x, y + SIDES[number % 2], z)
    time = scene.time.model_copy(update={"samples": 5})
    return scene.model_copy(
        update={"mechanism": scene.mechanism.model_copy(update={"points": points}), "time": time}
    )


def wanted(number: int) -> dict[str, np.ndarray]:
    return dict(columns(simulate(design(number))))


def assert_near(found: np.ndarray, alone: np.ndarray) -> None:
    # Each is within a tolerance of 1e-9 mm of the size of its kind; rates go up to 1e3 mm/s^2, angles are in
    # degrees.
    assert np.abs(found - alone).max() <= 1e-9 * max(1.0, np.abs(alone).max())


def test_every_kind_of_table_holds_the_designs_one_by_one(tmp_path: Path) -> None:
    for name in ("t.csv", "t.npz", "t.parquet"):
        assert main(["sweep", SCENE, *VARY, *INSTANTS, "-q", "-o", str(tmp_path / name)]) == 3
    with (tmp_path / "t.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    table = pyarrow.parquet.read_table(tmp_path / "t.parquet")
    arrays = np.load(tmp_path / "t.npz")
    assert len(rows) == table.num_rows == 6 * 5
    assert [int(row["design"]) for row in rows] == np.repeat(np.arange(6), 5).tolist()
    assert table.column_names == list(rows[0])
    for name in rows[0]:
        if name in ("design", "status"):
            assert [str(each) for each in table[name].to_pylist()] == [row[name] for row in rows]
            continue
        text = np.array([float(row[name]) for row in rows])
        np.testing.assert_array_equal(text, table[name].to_numpy())
        each = arrays[name]
        shaped = (
            np.tile(each, 6) if name == "time [s]" else np.repeat(each, 5) if each.ndim == 1 else each.ravel()
        )
        np.testing.assert_array_equal(text, shaped)
    statuses = arrays["status"].tolist()
    assert [status == "solved" for status in statuses] == [True] * 4 + [False] * 2
    for number in range(4):
        alone = wanted(number)
        assert set(alone) <= set(rows[0])
        for name, numbers in alone.items():
            assert_near(arrays[name] if name == "time [s]" else arrays[name][number], numbers)
        ball, side = arrays["lower_ball_joint.z [mm]"][number], arrays["upper_ball_joint.y [mm]"][number]
        points = design(number).mechanism.points
        assert (ball, side) == (points["lower_ball_joint"][2], points["upper_ball_joint"][1])
    assert np.isnan(arrays["wheel.camber [deg]"][4:]).all()


def test_standard_output_is_the_csv_and_nothing_else(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["sweep", SCENE, *VARY, *INSTANTS, "-o", str(tmp_path / "t.csv"), "-q"]) == 3
    capsys.readouterr()
    assert main(["sweep", SCENE, *VARY, *INSTANTS, "-o", "-"]) == 3
    out, err = capsys.readouterr()
    assert out.encode() == (tmp_path / "t.csv").read_bytes()
    assert "2 of 6 designs failed, the mechanism cannot be assembled; design 4 for one: " in err


def test_the_summary_says_what_failed_and_how_far_numbers_range(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["sweep", SCENE, *VARY, *INSTANTS, "--json", str(tmp_path / "s.json")]) == 3
    out, _ = capsys.readouterr()
    assert "solved: 4 of 6 designs, at 5 instants each" in out
    assert "failed: 2, the mechanism cannot be assembled; design 4 for one: the mechanism cannot" in out
    data = json.loads((tmp_path / "s.json").read_text())
    jsonschema.validate(data, json.loads(schema_text()))
    assert (data["kind"], data["designs"], data["tried"], data["solved"]) == ("sweep", 6, 6, 4)
    assert (data["exit_status"], data["failed"]) == (3, [4, 5])
    assert data["failures"][0]["designs"] == 2
    camber = [simulate(design(number)).wheel["camber"] for number in range(4)]
    (told,) = [one["in_motion"] for one in data["ranges"] if one["name"] == "camber"]
    assert told["lowest"] == pytest.approx(min(float(each.min()) for each in camber), abs=1e-12)
    assert told["highest"] == pytest.approx(max(float(each.max()) for each in camber), abs=1e-12)
    assert told["design_of_lowest"] == int(np.argmin([each.min() for each in camber]))
    assert told["design_of_highest"] == int(np.argmax([each.max() for each in camber]))


def test_a_table_of_designs_is_the_same_sweep(tmp_path: Path) -> None:
    lines = ["lower_ball_joint.z [mm],upper_ball_joint.y"]
    for number in range(6):
        points = design(number).mechanism.points
        lines.append(f"{points['lower_ball_joint'][2]!r},{points['upper_ball_joint'][1]!r}")
    (tmp_path / "d.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    for name, words in (("a.csv", VARY), ("b.csv", ("--designs", str(tmp_path / "d.csv")))):
        assert main(["sweep", SCENE, *words, *INSTANTS, "-q", "-o", str(tmp_path / name)]) == 3
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()


def test_offsets_and_places_mean_the_same_designs(tmp_path: Path) -> None:
    z = Scene.load(SCENE).mechanism.points["lower_ball_joint"][2]
    for name, values in (("a.csv", "=-2:2:3"), ("b.csv", f"=={z - 2}:{z + 2}:3"), ("c.csv", "=-2,0,2")):
        words = ["--vary", f"lower_ball_joint.z{values}", *INSTANTS, "-q", "-o", str(tmp_path / name)]
        assert main(["sweep", SCENE, *words]) == 0
    first = (tmp_path / "a.csv").read_bytes()
    assert first == (tmp_path / "b.csv").read_bytes() == (tmp_path / "c.csv").read_bytes()


def test_random_designs_are_the_same_each_time_and_spread_as_asked(tmp_path: Path) -> None:
    words = ["sweep", "steer", "--vary", "strut_top.x=normal:0.5", "--vary", "strut_top.y=uniform:2"]
    for name, seed in (("a.npz", "1"), ("b.npz", "1"), ("c.npz", "2")):
        more = ["--count", "200", "--seed", seed, "--instants", "2", "-q", "-o", str(tmp_path / name)]
        assert main([*words, *more]) == 0
    one, same, other = (np.load(tmp_path / name) for name in ("a.npz", "b.npz", "c.npz"))
    np.testing.assert_array_equal(one["strut_top.x [mm]"], same["strut_top.x [mm]"])
    assert (one["strut_top.x [mm]"] != other["strut_top.x [mm]"]).any()
    x, y, _ = Scene.load("steer").mechanism.points["strut_top"]
    # The deviation of 200 normal numbers is itself known to 1/sqrt(400) of it: four times that.
    assert np.std(one["strut_top.x [mm]"] - x) == pytest.approx(0.5, rel=0.2)
    assert 1.8 < np.abs(one["strut_top.y [mm]"] - y).max() <= 2.0


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([], ["nothing varies", "--vary POINT.AXIS=START:STOP:COUNT"]),
        (["--vary", "lower_bal_joint.z=0:1:2"], ["did you mean 'lower_ball_joint'?"]),
        (["--vary", "strut_top.w=0:1:2"], ["no axis of strut_top named 'w'", "x, y, z"]),
        (["--vary", "strut_top=0:1:2"], ["names no coordinate", "strut_top.x"]),
        (["--vary", "strut_top.x"], ["has no values"]),
        (["--vary", "strut_top.x=0:1"], ["2 parts", "START:STOP:COUNT"]),
        (["--vary", "strut_top.x=0:1:0"], ["the count '0'", "1 to"]),
        (["--vary", "strut_top.x=0:1:1"], ["one value from one number to another"]),
        (["--vary", "strut_top.x=0:a:2"], ["'a' for a number", "numbers, in mm"]),
        (["--vary", "strut_top.x=0:inf:2"], ["the number inf", "finite"]),
        (["--vary", "strut_top.x=0,1", "--vary", "strut_top.x=2,3"], ["is given twice"]),
        (["--vary", "strut_top.x=normal:1"], ["--count N"]),
        (["--vary", "strut_top.x=normal:-1", "--count", "2"], ["spreads by -1 mm"]),
        (["--vary", "strut_top.x==normal:1", "--count", "2"], ["random about the drawing"]),
        (["--vary", "strut_top.x=normal:1", "--vary", "strut_top.y=0,1", "--count", "2"], ["either"]),
        (["--vary", "strut_top.x=0,1", "--count", "2"], ["what is random"]),
        (["--vary", "strut_top.x=0,1", "--designs", "d.csv"], ["both --vary and --designs"]),
        (["--designs", "nowhere.csv"], ["nowhere.csv", "cannot be read"]),
        (["--vary", "strut_top.x=0,1", "-o", "x.xlsx"], ["x.xlsx", ".csv", ".npz", ".parquet"]),
        (["--vary", "strut_top.x=0,1", "--memory", "0.1"], ["memory is 0.1 MB", "more memory"]),
        (["--vary", "strut_top.x=0,1", "--memory", "0"], ["--memory is 0 MB"]),
        (["--vary", "strut_top.x=0,1", "-o", "-", "--json", "-"], ["both take standard output"]),
        (
            [f"--vary=strut_top.{axis}=0:1:10000" for axis in "xyz"],
            ["10000 x 10000 x 10000 = 1e+12 designs", "at most"],
        ),
        (["--vary", "strut_top.x=0,1", "--instants", "0"], ["samples", "0"]),
    ],
)
def test_a_mistake_is_told_in_a_line(
    words: list[str], said: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["sweep", "steer", *words]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert len(err.splitlines()) == 1
    assert [part for part in said if part not in err] == [], err


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "has no designs"),
        ("strut_top.x\n", "has no designs"),
        ("strut_top\n1\n", "line 1 has the column 'strut_top'"),
        ("strut_top.x,strut_top.x\n1,2\n", "line 1 has the column 'strut_top.x' twice"),
        ("strut_top.x,strut_top.y\n1,2\n1\n", "line 3 has 1 numbers"),
        ("strut_top.x\n1\nabc\n", "line 3 has 'abc' for a number"),
        ("strut_tip.x\n1\n", "did you mean 'strut_top'?"),
    ],
)
def test_a_mistake_in_a_table_of_designs_is_told_with_its_line(
    text: str, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "d.csv"
    path.write_text(text, encoding="utf-8")
    assert main(["sweep", "steer", "--designs", str(path)]) == 2
    err = capsys.readouterr().err
    assert said in err
    assert len(err.splitlines()) == 1


def test_a_file_that_is_there_stays_whole_if_the_sweep_ends_early(tmp_path: Path) -> None:
    target = tmp_path / "t.csv"
    target.write_text("mine", encoding="utf-8")
    scene = (Path(__file__).parents[3] / "pointcoord" / "scenes" / "steer.toml").read_text(encoding="utf-8")
    bad = tmp_path / "bad.toml"
    bad.write_text(scene.replace("constant = 1.5707963267948966", "constant = 9.0"), encoding="utf-8")
    assert main(["sweep", str(bad), "--vary", "strut_top.x=0,1", "-o", str(target)]) == 3
    assert target.read_text(encoding="utf-8") == "mine"
    assert [path.name for path in tmp_path.iterdir() if path.suffix == ".part"] == []


@pytest.mark.parametrize("ending", [".csv", ".npz", ".parquet"])
def test_a_table_is_written_in_the_memory_of_a_block(ending: str, tmp_path: Path) -> None:
    scene = Scene.load(SCENE)
    scene = scene.model_copy(update={"time": scene.time.model_copy(update={"samples": 101})})
    found = sweep(scene, offsets={"lower_ball_joint.z": np.linspace(-1.0, 1.0, 8)})
    write_sweep(str(tmp_path / f"few{ending}"), [found], 8)  # what is made once stays
    copies = 40

    def peak(count: int) -> int:
        tracemalloc.start()
        try:
            write_sweep(str(tmp_path / f"many{ending}"), (found for _ in range(count)), 8 * count)
            return tracemalloc.get_traced_memory()[1]
        finally:
            tracemalloc.stop()

    # What grows is a few words for each design and block: Parquet keeps where each of a hundred columns is.
    numbers = copies * len(found) * len(found.times) * 8 * 100
    assert peak(copies) - peak(2) < 0.05 * numbers


def test_the_help_says_what_the_tests_here_hold(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sweep", "--help"]) == 0
    out = capsys.readouterr().out
    assert DESCRIPTION.splitlines()[0] in out
    assert "Ends with 3 if a design could not be solved" in out
