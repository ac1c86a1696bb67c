"""`pointcoord validate --solver MODULE:NAME`: verdict, status, and one clear line for every mistake."""

import json
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest
from program import ROOT, complaints

from pointcoord import Scene
from validate.ci.summary import markdown
from validate.cli import main
from validate.solvers.apart import Apart
from validate.solvers.plain import SolverFailed, given_to_solver

RIGHT = "def solve(given):\n    from plain_solvers import closed_form\n    return closed_form(given)\n"
STRUT = "    if given['suspension'] == 'macpherson':\n        "
# The point of the rack, which moves.
RACK = "    import numpy as np\n    x, place = given['inputs'], np.array(given['points']['rack_centre'])\n"
RACK += "    place = place - np.outer(x['rack']['position'], given['right'])\n"
RACK += "    place = place + np.outer(x['heave']['position'], given['up'])\n"
RACK += "    return {'position': {'tie_rod_inner': place}}\n"
# What becomes of a strut with it; a double wishbone it answers.
ENDS = {
    "crashes": ("os.kill(os.getpid(), 11)", "was ended by SIGSEGV"),
    "answers": ("return None", "it returns None; needed: a mapping"),
    "reads": ("input()", "EOFError"),
}
HANGS = {"hangs": "while True: pass"}
MODULES = {
    "prints": 'import os\nprint("hello")\n'
    + RIGHT.replace("    return", '    os.system("echo hi")\n    return'),
    "wrong": RIGHT.replace("closed_form(given)\n", "{'camber': -closed_form(given)['wheel']['camber']}\n"),
    **{
        name: f"import os\ndef solve(given):\n{STRUT}{what}\n{RACK}"
        for name, what in (HANGS | {name: what for name, (what, _) in ENDS.items()}).items()
    },
}


@pytest.fixture
def solvers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A current directory with solvers in a package, and two short scenes."""
    (tmp_path / "own").mkdir()
    for name, text in MODULES.items():
        (tmp_path / "own" / f"{name}.py").write_text(text, encoding="utf-8")
    for scene in ("off-axis-strut", "double-wishbone"):
        text = (ROOT / "pointcoord" / "scenes" / f"{scene}.toml").read_text(encoding="utf-8")
        (tmp_path / f"{scene}.toml").write_text(text.replace("samples = 101", "samples = 5"))
    for name in [name for name in sys.modules if name.partition(".")[0] == "own"]:
        del sys.modules[name]
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [*sys.path])
    return tmp_path


def run(solver: str, *words: str) -> int:
    return main(["validate", "--solver", f"own.{solver}:solve", *(words or ("off-axis-strut.toml",))])


def test_what_would_explain_a_disagreement_is_in_the_test_results_and_in_the_summary(
    solvers: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    assert run("wrong", "off-axis-strut.toml", "--junit", "t.xml", "--summary", "s.md") == 1
    why = capfd.readouterr().out.partition("  possible explanation: ")[2].splitlines()[0]
    assert "camber" in why
    assert "sign" in why
    (failure,) = ElementTree.parse("t.xml").getroot().iter("failure")
    assert f"; possible explanation: {why}" in failure.get("message", "")
    (line,) = (one for one in Path("s.md").read_text("utf-8").splitlines() if "possible explanation" in one)
    assert line.endswith(f"possible explanation: {markdown(why)}")


def test_json_is_alone_on_standard_output(solvers: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert run("prints", "off-axis-strut.toml", "--json", "-") == 0
    out, err = capfd.readouterr()
    (scene,) = json.loads(out)["scenes"]
    assert scene["verdict"] == "agree"
    # It gives no dimensions of the wheel.
    given = [row for row in scene["comparisons"][0]["rows"] if row["quantity"] != "dimension"]
    assert {row["verdict"] for row in given} == {"agrees"}
    # It is imported once.
    assert err.splitlines().count("hello") == 1
    assert "hi" in err.split()


@pytest.mark.parametrize("module", ENDS)
def test_a_solver_that_crashes_or_reads_loses_that_scene_only(
    solvers: Path, capfd: pytest.CaptureFixture[str], module: str
) -> None:
    scenes = ["double-wishbone.toml", "off-axis-strut.toml", "./double-wishbone.toml"]
    assert run(module, *scenes, "--junit", "j.xml", "--summary", "s.md", "--json", "out.json") == 3
    said = capfd.readouterr()
    assert "2 of 3 scenes agree" in said.out
    (line,) = complaints(said.err)
    assert line.startswith("pointcoord: off-axis-strut.toml: ")
    assert ENDS[module][1] in line
    assert [one["exit_status"] for one in json.loads(Path("out.json").read_text())["scenes"]] == [0, 3, 0]
    assert ENDS[module][1].split(":")[0] in Path("j.xml").read_text(encoding="utf-8")
    assert "2 of 3 scenes agree" in Path("s.md").read_text(encoding="utf-8")


def test_a_solver_that_hangs_is_stopped_and_made_anew(
    solvers: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    # Only who never answers is held to a short limit: a right one may wait for the machine.
    assert run("hangs", "off-axis-strut.toml", "--solver-timeout", "0.5") == 3
    (line,) = complaints(capfd.readouterr().err)
    assert "took longer than 0.5 s and was stopped; --solver-timeout S allows more" in line
    strut, wishbone = (
        given_to_solver(Scene.load(name)) for name in ("off-axis-strut.toml", "double-wishbone.toml")
    )
    with Apart("own.hangs:solve", limit=0.5) as solver:
        with pytest.raises(SolverFailed, match="was stopped"):
            solver(strut)
        solver.limit = 600.0
        assert list(solver(wishbone)) == ["position"]


def test_what_a_stopped_solver_started_is_stopped_too(solvers: Path) -> None:
    mark = f"sleep {60 + len(str(solvers)) / 1000 + 0.0173}"
    text = f"import os\ndef solve(given):\n    os.system({mark!r})\n"
    (solvers / "own" / "starts.py").write_text(text, encoding="utf-8")
    assert run("starts", "off-axis-strut.toml", "--solver-timeout", "3") == 3
    processes = subprocess.run(["ps", "-eo", "args"], capture_output=True, text=True, check=True).stdout
    assert mark not in processes.splitlines()


def test_arrays_of_other_libraries_and_odd_answers_come_through_as_they_would_in_the_process(
    solvers: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    text = (
        "class Array:\n    def __init__(self, a): self.a = a\n"
        "    def __array__(self, dtype=None, copy=None): return __import__('numpy').array(self.a)\n"
        "class Odd: pass\n"
        "def solve(given):\n"
        "    n, place = len(given['instants']), given['points']['rack_centre']\n"
        "    return {'position': {'rack_centre': Array([place] * n), 'wheel_centre': [[1.0], [2.0, 3.0]],\n"
        "                         'strut_top': Odd()}, 'velocity': Odd(), 3: 3}\n"
    )
    (solvers / "own" / "odd_ones.py").write_text(text, encoding="utf-8")
    told = []
    for extra in ([], ["--in-process"]):
        assert run("odd_ones", "off-axis-strut.toml", "-v", *extra) == 3
        out = capfd.readouterr().out
        assert "agrees" in next(line for line in out.splitlines() if line.startswith("position"))
        told.append(out)
    assert "strut_top is 'an object of type Odd'; needed: real numbers" in told[0]
    # Of a class that only the solver's process knows the name comes through.
    assert "velocity is of type" in told[0]
    assert "velocity is of type Odd" in told[1]


def test_many_numbers_of_one_fault_do_not_fill_the_terminal(
    solvers: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    numbers = "{name: x + 0j for name, x in closed_form(given)['wheel'].items()}"
    text = RIGHT.replace("closed_form(given)\n", f"{numbers}\n")
    (solvers / "own" / "many.py").write_text(text, encoding="utf-8")
    assert run("many", "off-axis-strut.toml") == 3
    out = capfd.readouterr().out
    assert out.count("is of type complex128") == 3
    assert "cannot be used: 1 further number; -v prints all lines" in out
