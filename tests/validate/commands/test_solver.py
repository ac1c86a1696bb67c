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
WHEEL = RIGHT.replace("return closed_form(given)\n", 'a = closed_form(given)["wheel"]\n    return ')
STRUT = "    if given['suspension'] == 'macpherson':\n        "
CHASSIS = "def solve(given):\n    place = given['points']['rack_centre']\n"
CHASSIS += "    return {'position': {'rack_centre': [place] * len(given['instants'])}}\n"
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
    "right": RIGHT,
    "prints": 'import os\nprint("hello")\n'
    + RIGHT.replace("    return", '    os.system("echo hi")\n    return'),
    "half": f"{WHEEL}{{'wheel': a}}\n",
    "wrong": f"{WHEEL}{{'camber': -a['camber'], 'toe': a['toe']}}\n",
    "raises": "def solve(given):\n    return given['strut']\n\nclass Twice:\n  def __init__(self, a): ...\n",
    "chassis": CHASSIS,
    "odd": "x = 1 / 0\n",
    "unread": "def solve(\n",
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


def test_a_solver_s_numbers_decide_and_what_it_does_not_give_is_listed(
    solvers: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    assert run("half", "off-axis-strut.toml", "double-wishbone.toml", "-v") == 0
    out = capfd.readouterr().out
    assert "own.half:solve and pointcoord: 2 scenes" in out
    assert "2 of 2 scenes agree" in out
    assert "note: own.half:solve gives no angular velocity" in out
    lines = {line.split("  ")[0]: line for line in out.splitlines()}
    assert lines["position"].endswith("not given")
    assert lines["camber"].endswith("agrees")
    assert run("wrong", "off-axis-strut.toml", "-v") == 1
    lines = {line.split("  ")[0]: line for line in capfd.readouterr().out.splitlines()}
    assert "DISAGREES" in lines["camber"]
    assert lines["toe"].endswith("agrees")
    # A coarser accuracy is what it would have to state, and says nothing of anything.
    assert run("wrong", "off-axis-strut.toml", "--accuracy", "1e6", "-q") == 3
    (line,) = capfd.readouterr().err.splitlines()
    assert "no verdict: none of the numbers given is tested; camber, toe: not tested: " in line


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


@pytest.mark.parametrize(
    ("solver", "words", "said"),
    [
        ("own.nowhere:solve", "", "the module 'own.nowhere' is not found"),
        ("own.right:solv", "", "(did you mean 'solve'?)"),
        ("own.raises:Twice", "", "cannot be made without arguments: TypeError"),
        ("own.odd:solve", "", "ZeroDivisionError: division by zero at odd.py:1"),
        ("own.unread:solve", "", "SyntaxError: '(' was never closed (unread.py, line 1); fix the module"),
        ("own/right.py:solve", "", "try own.right:solve"),
        ("", "", "give MODULE:NAME"),
        ("math:pi", "", "is of type float, which is not a solver"),
        ("own.right:solve", "--accuracy 0", "give a length above 0"),
        ("own.right:solve", "--solver-timeout 0", "allowed: a positive, finite number"),
        ("own.right:solve", "--solver-timeout 5 --in-process", "leave one of them out"),
    ],
)
def test_a_mistake_is_told_in_one_line(
    solvers: Path, capfd: pytest.CaptureFixture[str], solver: str, words: str, said: str
) -> None:
    # In this process, where they are the same words sooner.
    words = words or "--in-process"
    assert main(["validate", "--solver", solver, "off-axis-strut.toml", *words.split()]) == 2
    (line,) = complaints(capfd.readouterr().err)
    assert said in line


def test_a_traceback_is_shown_where_it_is_asked_for(solvers: Path, capfd: pytest.CaptureFixture[str]) -> None:
    for more in ([], ["--traceback"]):
        assert run("raises", "off-axis-strut.toml", *more) == 3
        out, err = capfd.readouterr()
        assert "off-axis-strut.toml: KeyError: 'strut' at raises.py:2" in err
        # No input goes too far: what is to be mended is the solver.
        assert out.splitlines()[-1] == "Next: correct own.raises:solve as its message says."
        assert ("Traceback (most recent call last)" in err) == bool(more)


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


def test_the_line_of_a_scene_says_how_many_instants_a_solver_gives(
    solvers: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    some = "{'instants': given['instants'][:2] + [0.0, 1e-9], 'camber': a['camber'][:2]}"
    (solvers / "own" / "few.py").write_text(f"{WHEEL}{some}\n", encoding="utf-8")
    assert run("few", "off-axis-strut.toml") == 0
    assert "camber at 0 s; only 1 of 5 instants compared" in capfd.readouterr().out


def test_what_is_given_and_cannot_be_used_ends_with_3_and_is_an_error_of_the_test_results(
    solvers: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    text = f"{WHEEL}{{'camber': a['camber'], 'toe': a['toe'][1:]}}\n"
    (solvers / "own" / "partly.py").write_text(text, encoding="utf-8")
    assert run("partly", "off-axis-strut.toml", "--junit", "t.xml") == 3
    out, said = capfd.readouterr().out, "toe has the shape (4,); needed: (5,)"
    assert f"  cannot be used: own.partly:solve: wheel angle of {said}" in out
    assert "0 of 1 scene agrees" in out
    (error,) = ElementTree.parse("t.xml").getroot().iter("error")
    assert said in error.get("message", "")
