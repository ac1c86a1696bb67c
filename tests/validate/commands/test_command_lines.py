"""Command lines and what the program must say: answers; in one line, before any work, what cannot be done.

`answered.txt` and `refused.txt` beside this file have lines `STATUS COMMAND LINE => PART | PART`; what stands
after `not: ` must not be said, and `without PACKAGE: ` before the command line hides one. ROWS is a file
of measured rows, FOREIGN a folder with somebody's page, OUT nothing yet; what else is named is in `FILES` and
`SCENES`.
"""

import re
import shlex
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from every_number import loaded
from made_rows import kept, study
from program import BOUNCE, PAST_ITS_END, complaints, short_scene

from pointcoord import built_in_scenes
from pointcoord.scene.scene_file import SCENES as SCENE_FILES
from validate.cli import main
from validate.cost import study as studying

LONG = "n" * 10_000
# A solver's answer is made of the wheel's angles; SCENE's times and the strut's are five.
ANGLES = (
    "def solve(given):\n    from plain_solvers import closed_form\n    a = closed_form(given)['wheel']\n    "
)
STRUT, WISHBONE = (
    (SCENE_FILES / f"{name}.toml").read_text("utf-8").replace("samples = 101", "samples = 5")
    for name in ("off-axis-strut", "double-wishbone")
)
# A double wishbone is solved; what becomes of a strut stands in the braces.
NO_STRUT = ANGLES + "if given['suspension'] == 'macpherson': {}\n    return {{'wheel': a}}\n"
FILES = {
    "FILE": "mine",
    "FOREIGN/index.html": "<p>mine</p>",
    "CURVES": "time [s],camber [deg]\n0,1\n1,2\n",
    "GRID.csv": "arm_angle [deg],rack [mm],toe [deg]\n86.5,0,0\n85,10,0.5\n",
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
    "own/right.py": "def solve(given): ...\nclass Twice:\n  def __init__(self, a): ...\n",
    "own/half.py": f"{ANGLES}return {{'wheel': a}}\n",
    "own/wrong.py": f"{ANGLES}return {{'camber': -a['camber'], 'toe': a['toe']}}\n",
    "own/silent.py": "def solve(given): return {}\n",
    "own/empty.py": f"{ANGLES}return {{name: x * float('nan') for name, x in a.items()}}\n",
    "own/partly.py": f"{ANGLES}return {{'camber': a['camber'], 'toe': a['toe'][1:]}}\n",
    "own/few.py": f"{ANGLES}t = given['instants'][:2] + [0, 1e-9]\n    "
    "return {'instants': t, 'camber': a['camber'][:2]}\n",
    "own/many.py": f"{ANGLES}return {{name: x + 0j for name, x in a.items()}}\n",
    "own/odd_ones.py": "class Array:\n  def __init__(self, a): self.a = a\n"
    "  def __array__(self, dtype=None, copy=None): return __import__('numpy').array(self.a)\n"
    "class Odd: pass\n"
    "def solve(given):\n"
    "  place = Array([given['points']['rack_centre']] * 5)\n"
    "  ragged = [[1.0], [2.0, 3.0]]\n"
    "  places = {'rack_centre': place, 'wheel_centre': ragged, 'strut_top': Odd()}\n"
    "  return {'position': places, 'velocity': Odd(), 3: 3}\n",
    "own/crashes.py": NO_STRUT.format("import os; os.kill(os.getpid(), 11)"),
    "own/answers.py": NO_STRUT.format("return None"),
    "own/reads.py": NO_STRUT.format("input()"),
    "own/hangs.py": "def solve(given):\n    while True: pass\n",
    "own/raises.py": "def solve(given):\n    return given['strut']\n",
    "own/odd.py": "x = 1 / 0\n",
    "own/unread.py": "def solve(\n",
    # What else can be wrong in a scene is in tests/pointcoord/scene/refused.txt.
    "ANGEL": BOUNCE.replace("arm_angle =", "arm_angel ="),
    "STRUT": STRUT,
    "WISHBONE": WISHBONE,
    "LOADED": loaded("off-axis-strut", 3, ["camber", "loads"]),
    "UNREADABLE": BOUNCE.replace("title =", "title"),
}
SCENES = {
    "SCENE": {},
    "OPTIMUMK": {"convention": '"optimumk"', "effects": '["toe"]'},
    "LOCKED": {"arm_angle": "{ polynomial = [0.2, 0.25, 0.0625] }"},
    "ANGLE": {"arm_angle": "{ polynomial = [0.8, 1.25, 0.0625] }"},
    "DEGREES": {"arm_angle": "{ constant = 88.0 }"},
    "RADIANS": {"arm_angle": "{ constant = 3.5 }"},
    "LARGE": {"arm_angle": "{ constant = 200.0 }"},
}


def lines_of(file: str) -> Iterator[tuple[str, int, list[str]]]:
    """Command lines, their status, and the parts."""
    for line in Path(__file__).with_name(file).read_text(encoding="utf-8").splitlines():
        words, said = line.split(" => ")
        yield words[2:], int(words[0]), said.split(" | ")


def refused() -> Iterator[tuple[str, int, list[str]]]:
    yield from lines_of("refused.txt")
    for words, status in (("simulate", 2), ("new", 4), ("", 2), ("study random --records", 2)):
        yield f"{words} {LONG}", status, ["n" * 50]
    yield f"sweep bounce --vary {LONG}=1", 2, ["n" * 50]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A current folder with all that the command lines name."""
    kept(tmp_path / "ROWS", study())
    for name in ("EMPTY", "FOREIGN", "own"):
        (tmp_path / name).mkdir()
    for name, text in FILES.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    for name, changes in SCENES.items():
        short_scene(tmp_path, name, **changes)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [*sys.path])
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    for name in [name for name in sys.modules if name.partition(".")[0] == "own"]:
        monkeypatch.delitem(sys.modules, name)
    return tmp_path


def contents(folder: Path) -> dict[Path, bytes | None]:
    return {path: path.read_bytes() if path.is_file() else None for path in folder.rglob("*")}


def test_an_answer_says_what_its_line_says(folder: Path, capfd: pytest.CaptureFixture[str]) -> None:
    before = contents(folder)
    every = "scenes", 0, [*built_in_scenes()]
    for line, status, parts in (*lines_of("answered.txt"), every):
        assert main(shlex.split(line)) == status, line
        out, err = capfd.readouterr()
        assert len(complaints(err)) <= (status > 1) or "--traceback" in line, (line, err)
        said = re.sub(" +", " ", out + err)
        for part in parts:
            wanted = part.removeprefix("not: ")
            assert (wanted in said) == (wanted == part), (line, part, said)
    assert contents(folder) == before


def test_what_cannot_be_done_is_one_line_that_says_why_and_nothing_is_written(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(studying, "measure", lambda *_: pytest.fail("measured"))
    for name in ("solved.simulate", "comparison.examine"):
        monkeypatch.setattr(f"validate.commands.{name}", lambda *_, **__: pytest.fail("solved"))
    before = contents(folder)
    for line, status, parts in refused():
        lacking, _, words = line.rpartition(": ") if line.startswith("without ") else ("", "", line)
        with monkeypatch.context() as patch:
            if lacking:
                patch.setitem(sys.modules, lacking.removeprefix("without "), None)
            assert main(shlex.split(words)) == status, line[:200]
        out, err = capsys.readouterr()
        assert out == "", line[:200]
        (said,) = (one for one in err.splitlines() if not one.startswith("pointcoord: note: "))
        assert [part for part in parts if part not in said] == [], (line[:200], said)
        assert "n" * 61 not in said
        assert "defect" not in said
    assert contents(folder) == before


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
