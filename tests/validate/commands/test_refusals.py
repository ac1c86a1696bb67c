"""What cannot be done is said in one line before anything is solved, and nothing is written."""

import shlex
import sys
from pathlib import Path

import pytest
from made_rows import kept, study
from program import BOUNCE, PAST_ITS_END, short_scene

from validate.cli import main
from validate.cost import study as studying

LONG = "n" * 10_000
DESIGNS = {
    "none": ("", "has no designs"),
    "column": ("strut_top\n1\n", "line 1 has the column 'strut_top'"),
    "twice": ("strut_top.x,strut_top.x\n1,2\n", "line 1 has the column 'strut_top.x' twice"),
    "short": ("strut_top.x,strut_top.y\n1,2\n1\n", "line 3 has 1 numbers"),
    "letters": ("strut_top.x\n1\nabc\n", "line 3 has 'abc' for a number"),
    "name": ("strut_tip.x\n1\n", "did you mean 'strut_top'?"),
}
HARD = {
    "broken": ("{", "is no JSON"),
    "deep": ("[" * 100_000, "is no JSON"),
    "list": ("[]", "holds no hard cases"),
    "other": ('{"kind": "validate"}', "holds no hard cases"),
    "newer": ('{"kind": "hard", "schema_version": 99, "complete": true}', "schema_version: "),
    "cut": ('{"kind": "hard", "schema_version": 2, "complete": false}', "complete: "),
    "odd": ('{"kind": "hard", "schema_version": 2, "complete": true, "cases": [1]}', "holds no hard cases ("),
}
FITTED = "bounce --data CURVES"
CAR = "double-wishbone"
# Command lines, their status, and parts of what is said. ROWS is a file of measured rows, SCENE a scene file,
# FILE a file that is there, FOREIGN a folder with somebody's page, OUT nothing yet.
REFUSED: list[tuple[str, int, list[str]]] = [
    ("", 2, ["--help"]),
    ("simulat bounce", 2, ["simulat", "--help"]),
    ("axle-roll", 2, ["there is axle-roll among the scenes: pointcoord simulate axle-roll"]),
    ("five_link -q", 2, ["there is five-link among the scenes"]),
    ("roll", 2, ["'roll' (there is axle-roll among the scenes: pointcoord simulate axle-roll)"]),
    ("axle", 2, ["axle-opposed and axle-parallel and axle-roll", ": pointcoord simulate axle-opposed)"]),
    ("car.toml", 2, ["a scene's file stands after a command", "pointcoord simulate"]),
    ("simulate bounse", 2, ["bounse", "bounce"]),
    ("simulate no/such/file.toml", 2, ["no/such/file.toml", "No such file"]),
    ("validate - -", 2, ["standard input", "more than once"]),
    ("simulate ''", 2, ["''", "names no scene"]),
    ("validate bounce --second adams", 2, ["adams", "absolute"]),
    ("validate steer --first ''", 2, ["without a name", "absolute"]),
    ("validate steer --second pointcoord", 2, ["'pointcoord'", "with itself", "absolute"]),
    ("validate steer --accuracy 1e-3", 2, ["--accuracy goes with --solver or --data only"]),
    ("validate steer --map x.toml", 2, ["--map goes with --data only"]),
    *(
        (f"validate steer --tolerance-factor={f}", 2, ["positive, finite"])
        for f in ("0", "-1", "nan", "1e999")
    ),
    ("validate steer --scenes-dir EMPTY", 2, ["--scenes-dir", "holds no scene"]),
    ("validate steer --scenes-dir none", 2, ["--scenes-dir", "No such file"]),
    ("validate steer --json ''", 2, ["--json ''", "names no file"]),
    ("validate steer --junit OUT --summary ./OUT", 2, ["--junit and --summary are both", "of its own"]),
    ("validate steer --json - --summary -", 2, ["--json and --summary are both -", "of its own"]),
    ("validate steer --save-baseline -", 2, ["is not text"]),
    ("validate steer --baseline none.npz", 2, ["none.npz", "No such file", "--save-baseline"]),
    ("validate steer --baseline FILE --json FILE", 2, ["would overwrite"]),
    ("validate SCENE --junit SCENE", 2, ["would overwrite the scene"]),
    ("simulate SCENE -o SCENE", 2, ["would overwrite the scene"]),
    ("simulate bounce -o no/x.csv", 4, ["no/x.csv: "]),
    ("draw bounce -o no/x.svg", 4, ["no/x.svg: "]),
    ("validate steer --summary none/x", 4, ["there is no folder"]),
    ("validate steer --save-baseline EMPTY", 4, ["Is a directory"]),
    ("validate steer --report ''", 2, ["--report '' names no folder"]),
    ("validate steer --solver pathlib:nope --report OUT", 2, ["has no 'nope'"]),
    ("validate --data missing.csv steer", 2, ["missing.csv: cannot be read"]),
    ("validate --data missing.csv", 2, ["no scene is given with --data"]),
    ("validate --data missing.csv steer --accuracy 1e308", 2, ["allowed: a number from 0 to 1e+12"]),
    ("validate steer --data x --save-baseline OUT", 2, ["--save-baseline does not go with --data"]),
    *(
        (f"validate --tables {words}", 2, [f"{option} does not go with --tables"])
        for option, words in {
            "SCENE": "bounce",
            "--first": "--first absolute",
            "--tolerance-factor": "--tolerance-factor 2",
            "--fail-fast": "--fail-fast",
        }.items()
    ),
    ("report '' steer", 2, ["names no folder"]),
    ("report FILE steer", 2, ["is a file; allowed: a folder"]),
    ("report FOREIGN steer", 2, ["is no report of this program"]),
    ("report steer bounce", 2, ["the folder of the report comes first"]),
    ("report mine.toml bounce", 2, ["the folder of the report comes first"]),
    ("report OUT steer --cost none", 2, ["--cost none"]),
    ("report OUT steer --data x --hard h", 2, ["--hard does not go with --data"]),
    *((f"report OUT steer --hard {name}.json", 2, [said]) for name, (_, said) in HARD.items()),
    ("hard --list --report OUT", 2, ["leave it out with --list"]),
    ("hard arm-higest", 2, ["no hard case is called 'arm-higest'", "near names: ", "--list"]),
    (
        f"fit {FITTED} --free strut_top strut_top.z",
        2,
        ["--free: strut_top.z is there twice", "each coordinate once"],
    ),
    (f"fit {FITTED} --free strut_tip", 2, ["did you mean 'strut_top'?"]),
    ("simulate bounce -o x.xlsx", 2, ["x.xlsx", ".csv", ".npz"]),
    ("simulate bounce -o ''", 2, ["-o ''", "names no file"]),
    ("simulate bounce --method euler", 2, ["euler", "newton"]),
    ("simulate steer --method newton --instants 10", 2, ["needs the method auto, series or map"]),
    ("simulate steer --instants 0", 2, ["allowed: 1 or more"]),
    ("draw no-such-scene", 2, ["bounce"]),
    ("draw steer -o x.png", 2, ["allowed: .svg"]),
    ("plot LENGTHS.csv -o a.svg", 2, ["has no angle of a wheel; say --y NAME of its columns: time, damper"]),
    ("plot bounce --x toe", 2, ["--x", "was not computed", "add 'toe' to the scene's effects"]),
    (f"plot {CAR} --y cambr", 2, ["--y 'cambr'", "did you mean 'camber'", "there are: time"]),
    (f"plot {CAR} --y velocity", 2, ["more than one number", "velocity.wheel_centre"]),
    (f"plot {CAR} --x camber --x toe --y camber --y toe", 2, ["several of one of them"]),
    (f"plot {CAR} -o a.gif", 2, ["no known ending", ".svg, .png"]),
    ("table bricard", 2, ["there is no number of a wheel"]),
    ("table wheel-travel --number tow", 2, ["did you mean 'toe'?"]),
    ("table five-link --number caster", 2, ["needs the role steering_axis"]),
    ("table bmw-e90-strut --number scrub_radius", 2, ["wheel_radius = 300.0"]),
    ("table wheel-travel -o t.pdf", 2, ["allowed: .csv, .md"]),
    (
        "table wheel-travel --grid wheel_travl=1,2",
        2,
        ["no input that the scene drives (did you mean 'wheel_travel'?)"],
    ),
    ("table wheel-travel --grid rack=1:2", 2, ["is no range; allowed: START:STOP:COUNT"]),
    ("table wheel-travel --grid rack=1,two", 2, ["has 'two' for a number"]),
    ("table wheel-travel --grid rack=1,2", 2, ["wheel_travel moves in the scene; give its values too"]),
    ("table wheel-travel --grid rack=1 --grid rack=2", 2, ["is given twice"]),
    ("table wheel-travel --grid rack=1 --rows 3", 2, ["--rows is about a way of the inputs"]),
    (
        "table axle-steer --number tooe",
        2,
        ["no number of a car is called tooe", "and 168 more (--all shows every one)"],
    ),
    (
        f"table {CAR} --convention bmw",
        2,
        ["no convention named 'bmw'; there are: iso, paper, lotus, optimumk, adams"],
    ),
    (f"table {CAR} --convention adams --all", 2, ["--all is every number by our names"]),
    (f"sensitivity {CAR} --point tie_rod_outr", 2, ["tie_rod_outr"]),
    (f"sensitivity {CAR} --number toes", 2, ["no number of a car is called toes (did you mean 'toe'?)"]),
    ("sweep steer", 2, ["nothing varies", "--vary POINT.AXIS=START:STOP:COUNT"]),
    ("sweep steer --vary lower_bal_joint.z=0:1:2", 2, ["did you mean 'lower_ball_joint'?"]),
    ("sweep steer --vary strut_top.w=0:1:2", 2, ["no axis of strut_top named 'w'", "x, y, z"]),
    ("sweep steer --vary strut_top=0:1:2", 2, ["names no coordinate", "strut_top.x"]),
    ("sweep steer --vary strut_top.x", 2, ["for a number"]),
    ("sweep steer --vary strut_top.x=0:1", 2, ["is no range", "START:STOP:COUNT"]),
    ("sweep steer --vary strut_top.x=0:1:0", 2, ["is no range", "1 to"]),
    ("sweep steer --vary strut_top.x=0:1:1", 2, ["one value from one number to another"]),
    ("sweep steer --vary strut_top.x=0:a:2", 2, ["'a' for a number"]),
    ("sweep steer --vary strut_top.x=0:inf:2", 2, ["finite"]),
    ("sweep steer --vary strut_top.x=0,1 --vary strut_top.x=2,3", 2, ["is given twice"]),
    ("sweep steer --vary strut_top.x=normal:1", 2, ["--count N"]),
    ("sweep steer --vary strut_top.x=normal:-1 --count 2", 2, ["0 mm or more"]),
    ("sweep steer --vary strut_top.x==normal:1 --count 2", 2, ["after one ="]),
    ("sweep steer --vary strut_top.x=normal:1 --vary strut_top.y=0,1 --count 2", 2, ["either"]),
    ("sweep steer --vary strut_top.x=0,1 --count 2", 2, ["what is random"]),
    ("sweep steer --vary strut_top.x=0,1 --designs d.csv", 2, ["both --vary and --designs"]),
    ("sweep steer --vary strut_top.x=0,1 -o x.xlsx", 2, [".csv, .npz, .parquet"]),
    ("sweep steer --vary strut_top.x=0,1 -o - --json -", 2, ["-o and --json are both -"]),
    ("sweep steer --vary strut_top.x=0,1 --memory 0.1", 2, ["memory is 0.1 MB", "more memory"]),
    ("sweep steer --vary strut_top.x=0,1 --memory 0", 2, ["--memory is 0 MB"]),
    (
        " ".join(["sweep steer", *(f"--vary=strut_top.{axis}=0:1:10000" for axis in "xyz")]),
        2,
        ["10000 x 10000 x 10000 = 1e+12 designs"],
    ),
    ("sweep steer --designs nowhere.csv", 2, ["nowhere.csv", "cannot be read"]),
    *((f"sweep steer --designs {name}.csv", 2, [said]) for name, (_, said) in DESIGNS.items()),
    ("cost --from-rows --rows ROWS --ways serie", 2, ["did you mean 'series'", "mujoco"]),
    ("cost --from-rows --rows ROWS bounc", 2, ["did you mean 'bounce'", "double-wishbone"]),
    ("cost --from-rows --rows ROWS --parts accuracies", 2, ["part", "accuracy, growth"]),
    ("cost --from-rows --rows ROWS --parts ,", 2, ["--parts", "names nothing"]),
    ("cost --from-rows --rows ROWS --report ' '", 2, ["--report", "names no folder"]),
    ("cost --rows OUT --report FILE", 2, ["is a file; allowed: a folder"]),
    ("cost --rows -", 2, ["--rows", "names no file"]),
    ("cost --rows none/x", 4, ["--rows", "no folder"][1:]),
    ("cost --rows FILE", 2, ["is no Parquet file of what accuracy costs"]),
    ("cost --rows FILE --from-rows", 2, ["is no Parquet file of what accuracy costs"]),
    *((f"{words} {LONG}", status, ["n" * 50]) for words, status in (("simulate", 2), ("new", 4), ("", 2))),
    (f"sweep bounce --vary {LONG}=1", 2, ["n" * 50]),
    (f"study random --records {LONG}", 2, ["n" * 50]),
]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A current folder with all that the command lines name, in which nothing can be measured."""
    kept(tmp_path / "ROWS", study())
    short_scene(tmp_path, "SCENE")
    for name in ("EMPTY", "FOREIGN"):
        (tmp_path / name).mkdir()
    texts = {
        "FILE": "mine",
        "FOREIGN/index.html": "<p>mine</p>",
        "CURVES": "time [s],camber [deg]\n0,1\n1,2\n",
        "LENGTHS.csv": "time [s],damper [mm]\n0,1\n",
    }
    texts |= {f"{name}.csv": text for name, (text, _) in DESIGNS.items()}
    texts |= {f"{name}.json": text for name, (text, _) in HARD.items()}
    for name, text in texts.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(studying, "measure", lambda *_: pytest.fail("measured"))
    for name in ("solved.simulate", "comparison.examine"):
        monkeypatch.setattr(f"validate.commands.{name}", lambda *_, **__: pytest.fail("solved"))
    return tmp_path


def contents(folder: Path) -> dict[Path, bytes | None]:
    return {path: path.read_bytes() if path.is_file() else None for path in folder.rglob("*")}


def test_what_cannot_be_done_is_one_line_that_says_why_and_nothing_is_written(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = contents(folder)
    for line, status, parts in REFUSED:
        assert main(shlex.split(line)) == status, line[:200]
        out, err = capsys.readouterr()
        assert out == "", line[:200]
        (said,) = err.splitlines()
        assert [part for part in parts if part not in said] == [], (line[:200], said)
        assert "n" * 61 not in said
        assert "defect" not in said
    assert contents(folder) == before


@pytest.mark.parametrize(
    ("line", "package", "extra"),
    [
        ("simulate steer -o m.parquet", "pyarrow.parquet", "parquet"),
        ("report OUT steer", "jinja2", "report"),
        ("plot steer -o a.svg", "matplotlib", "plot"),
        ("export steer", "validate.peers.mjcf", "peers"),
    ],
)
def test_without_a_package_the_extra_is_named(
    line: str,
    package: str,
    extra: str,
    folder: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, package, None)
    before = contents(folder)
    assert main(line.split()) == 2
    assert f"pip install 'pointcoord[{extra}]'" in capsys.readouterr().err
    assert contents(folder) == before


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("strut_top        = [460, -180, 470]", "", ["mechanism.points", "strut_top", "missing"]),
        ("wheel_centre ", "wheel_center ", ["mechanism.points", "wheel_center", "allowed", "wheel_centre"]),
        ("arm_angle =", "arm_angel =", ["arm_angel", "allowed: arm_angle, rack, steering_wheel"]),
        ('type = "macpherson"', 'type = "mcpherson"', ["mechanism.type", "macpherson"]),
        ("[450, -330, -40]", "[452, -320, 20]", ["mechanism.points", "has no length"]),
        ("title =", "title", ["not TOML"]),
    ],
)
def test_a_wrong_scene_ends_with_2_and_one_line_that_says_where(
    old: str, new: str, words: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert old in BOUNCE
    path = tmp_path / "mine.toml"
    path.write_text(BOUNCE.replace(old, new))
    for command in (["simulate", str(path), "-o", str(tmp_path / "out.csv")], ["validate", "-q", str(path)]):
        assert main(command) == 2
        out, err = capsys.readouterr()
        assert out == ""
        (said,) = err.splitlines()
        assert said.startswith(f"pointcoord: {path}: ")
        assert [word for word in words if word not in said] == [], said


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
    path = short_scene(tmp_path, arm_angle=f"{{ polynomial = {law} }}")
    for command, ending in (("simulate", "csv"), ("plot", "svg"), ("table", "csv")):
        target = tmp_path / f"out.{ending}"
        assert main([command, path, "-o", str(target)]) == 3
        (said,) = capsys.readouterr().err.splitlines()
        assert said.startswith(f"pointcoord: {path}: ")
        assert [word for word in words if word not in said] == [], said
        assert not target.exists()


def test_an_angle_that_only_degrees_explain_is_asked_about(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for value, asked in (("88.0", True), ("3.5", False), ("200.0", False)):
        assert main(["validate", short_scene(tmp_path, arm_angle=f"{{ constant = {value} }}")]) == 3
        out, err = capsys.readouterr()
        assert ("if 88 is meant in degrees, it is 1.535889742 rad" in err) == asked
        assert "0 of 1 scene agrees; not tested (refused): " in out


@pytest.mark.parametrize(("command", "ending"), [("simulate", "csv"), ("plot", "svg"), ("table", "csv")])
def test_a_motion_that_stops_halfway_is_kept_as_far_as_it_goes(
    command: str, ending: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, target = short_scene(tmp_path, samples="131", **PAST_ITS_END), tmp_path / f"out.{ending}"
    assert main([command, "-q", path, "-o", str(target)]) == 3
    (said,) = capsys.readouterr().err.splitlines()
    assert "cannot pass" in said
    assert said.endswith(f" s, is in {target}")
    last = float(said.partition("up to t = ")[2].split(" ")[0])
    # The arm meets its dead point at 152.013 degrees.
    end = (152.013 * 3.141592653589793 / 180.0 - 0.8) / 0.8
    assert end - 0.02 < last <= end + 1e-4
    assert target.stat().st_size > 500


def test_the_table_and_the_verdict_shorten_a_name_that_no_file_can_have(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["validate", LONG]) == 2
    said = capsys.readouterr()
    assert LONG[:50] in said.out
    assert "n" * 256 not in said.out + said.err
