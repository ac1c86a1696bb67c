"""What cannot be done is said in one line before anything is solved, and nothing is written."""

import shlex
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from made_rows import kept, study
from program import BOUNCE, PAST_ITS_END, short_scene

from validate.cli import main
from validate.cost import study as studying

LONG = "n" * 10_000
# Files that the command lines name.
FILES = {
    "FILE": "mine",
    "FOREIGN/index.html": "<p>mine</p>",
    "CURVES": "time [s],camber [deg]\n0,1\n1,2\n",
    "LENGTHS.csv": "time [s],damper [mm]\n0,1\n",
    "none.csv": "",
    "column.csv": "strut_top\n1\n",
    "twice.csv": "strut_top.x,strut_top.x\n1,2\n",
    "short.csv": "strut_top.x,strut_top.y\n1,2\n1\n",
    "letters.csv": "strut_top.x\n1\nabc\n",
    "name.csv": "strut_tip.x\n1\n",
    "broken.json": "{",
    "deep.json": "[" * 100_000,
    "list.json": "[]",
    "other.json": '{"kind": "validate"}',
    "newer.json": '{"kind": "hard", "schema_version": 99, "complete": true}',
    "cut.json": '{"kind": "hard", "schema_version": 3, "complete": false}',
    "odd.json": '{"kind": "hard", "schema_version": 3, "complete": true, "cases": [1]}',
}


def refused() -> Iterator[tuple[str, int, list[str]]]:
    """Command lines of `refused.txt` beside this file, their status, and parts of what is said.

    A line is `STATUS COMMAND LINE => PART | PART`. ROWS is a file of measured rows, SCENE a scene file, FILE
    a file that is there, FOREIGN a folder with somebody's page, OUT nothing yet.
    """
    for line in Path(__file__).with_name("refused.txt").read_text(encoding="utf-8").splitlines():
        words, said = line.split(" => ")
        yield words[2:], int(words[0]), said.split(" | ")
    for words, status in (("simulate", 2), ("new", 4), ("", 2), ("study random --records", 2)):
        yield f"{words} {LONG}", status, ["n" * 50]
    yield f"sweep bounce --vary {LONG}=1", 2, ["n" * 50]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A current folder with all that the command lines name, in which nothing can be measured."""
    kept(tmp_path / "ROWS", study())
    short_scene(tmp_path, "SCENE")
    for name in ("EMPTY", "FOREIGN"):
        (tmp_path / name).mkdir()
    for name, text in FILES.items():
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
    for line, status, parts in refused():
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
        ("export steer", "mujoco", "peers"),
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
        ("arm_angle =", "arm_angel =", ["arm_angel", "allowed: arm_angle, rack, steering_wheel"]),
        ("title =", "title", ["not TOML"]),
    ],
)
def test_a_wrong_scene_ends_with_2_and_one_line_that_says_where(
    old: str, new: str, words: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """What else can be wrong in one is in tests/pointcoord/scene/refused.txt."""
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
