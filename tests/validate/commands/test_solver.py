"""`pointcoord validate --solver MODULE:NAME`: verdict, status, and one clear line for every mistake."""

import json
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import plain_solvers
import pytest
from program import ENVIRONMENT, PROGRAM, ROOT, complaints

from pointcoord import Scene
from validate.ci.summary import markdown
from validate.cli import main
from validate.solvers.apart import Apart
from validate.solvers.plain import SolverFailed, given_to_solver

RIGHT = "def solve(given):\n    from plain_solvers import closed_form\n    return closed_form(given)\n"
MODULES = {
    "right": RIGHT,
    "prints": 'import os\nprint("hello")\n'
    + RIGHT.replace("    return", '    os.system("echo hi")\n    return'),
    "half": RIGHT.replace("return closed_form(given)", 'return {"wheel": closed_form(given)["wheel"]}'),
    "wrong": RIGHT.replace("return closed_form(given)", 'a = closed_form(given)["wheel"]\n')
    + '    return {"camber": -a["camber"], "toe": a["toe"]}\n',
    "raises": "def solve(given):\n    return given['strut']\n\nclass Twice:\n  def __init__(self, a): ...\n",
    "some": "def solve(given):\n    if given['suspension'] == 'macpherson':\n        raise SystemExit(5)\n",
    "none": "def solve(given):\n    return None\n",
    "broken": "import nothing_of_that_name\n",
    "odd": "x = 1 / 0\n",
    "unread": "def solve(\n",
    "exits": "import os\nos._exit(7)\n",
}
STRUT = "    if given['suspension'] == 'macpherson':\n        "
CHASSIS = "    place = given['points']['rack_centre']\n"
CHASSIS += "    return {'position': {'rack_centre': [place] * len(given['instants'])}}\n"
# The point of the rack, which moves.
RACK = "    import numpy as np\n    x, place = given['inputs'], np.array(given['points']['rack_centre'])\n"
RACK += "    place = place - np.outer(x['rack']['position'], given['right'])\n"
RACK += "    place = place + np.outer(x['heave']['position'], given['up'])\n"
RACK += "    return {'position': {'tie_rod_inner': place}}\n"
# What becomes of a strut with it; a double wishbone it answers.
ENDS = {
    "leaves": ("os._exit(0)", "ended with exit status 0 and without an answer"),
    "crashes": ("os.kill(os.getpid(), 11)", "was ended by SIGSEGV"),
    "interrupts": ("raise KeyboardInterrupt", "KeyboardInterrupt"),
    "cuts": ("os.closerange(3, 64)", "ended with exit status"),
    "reads": ("input()", "EOFError"),
    "writes": ("given['instants'][0] = 1.0", "ValueError: assignment destination is read-only"),
    "counts": ("raise ValueError(os.getpid())", "ValueError"),
}
MODULES["some"] += RACK
HANGS = {"hangs": "while True: pass", "waits": "os.system('sleep 60')"}
MODULES |= {name: f"import os\ndef solve(given):\n{STRUT}{what}\n{RACK}" for name, what in HANGS.items()}
MODULES |= {name: f"import os\ndef solve(given):\n{STRUT}{what}\n{RACK}" for name, (what, _) in ENDS.items()}


@pytest.fixture
def solvers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A current directory with solvers in a package, and a short scene."""
    (tmp_path / "own_solvers").mkdir()
    for name, text in MODULES.items():
        (tmp_path / "own_solvers" / f"{name}.py").write_text(text, encoding="utf-8")
        sys.modules.pop(f"own_solvers.{name}", None)
    sys.modules.pop("own_solvers", None)
    for scene in ("off-axis-strut", "double-wishbone"):
        text = (ROOT / "pointcoord" / "scenes" / f"{scene}.toml").read_text(encoding="utf-8")
        (tmp_path / f"{scene}.toml").write_text(
            text.replace("samples = 101", "samples = 5"), encoding="utf-8"
        )
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [*sys.path])
    return tmp_path


def run(*words: str) -> int:
    return main(["validate", "--solver", *words])


def test_a_right_solver_ends_with_0(solvers: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert run("own_solvers.right:solve", "off-axis-strut.toml", "double-wishbone.toml") == 0
    said = capfd.readouterr()
    assert "own_solvers.right:solve and pointcoord: 2 scenes" in said.out
    assert "2 of 2 scenes agree" in said.out
    assert "DISAGREES" not in said.out
    assert not complaints(said.err)


def test_what_is_not_given_is_listed_and_no_fault(solvers: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert run("own_solvers.half:solve", "off-axis-strut.toml", "-v") == 0
    out = capfd.readouterr().out
    assert "note: own_solvers.half:solve gives no angular velocity" in out
    lines = {line.split("  ")[0]: line for line in out.splitlines()}
    assert lines["position"].endswith("not given")
    assert lines["camber"].endswith("agrees")


def test_a_wrong_solver_ends_with_1(solvers: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert run("own_solvers.wrong:solve", "off-axis-strut.toml", "-v") == 1
    lines = {line.split("  ")[0]: line for line in capfd.readouterr().out.splitlines()}
    assert "DISAGREES" in lines["camber"]
    assert lines["toe"].endswith("agrees")
    # A coarser accuracy is what it would have to state.
    assert run("own_solvers.wrong:solve", "--accuracy", "1e3", "off-axis-strut.toml") == 3
    capfd.readouterr()
    assert run("own_solvers.wrong:solve", "--accuracy", "1e6", "off-axis-strut.toml", "-q") == 3
    (line,) = capfd.readouterr().err.splitlines()
    assert "no verdict: no number that is given is tested; camber, toe: not tested: " in line


def test_another_solver_than_the_baselines_is_no_verdict(
    solvers: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    assert run("own_solvers.right:solve", "off-axis-strut.toml", "--save-baseline", "b.npz") == 0
    assert run("own_solvers.prints:solve", "off-axis-strut.toml", "--baseline", "b.npz", "-q") == 3
    lines = capfd.readouterr().err.splitlines()
    assert any("own_solvers.prints:solve in the place of own_solvers.right:solve" in line for line in lines)


def test_what_would_explain_a_disagreement_is_in_the_test_results_and_in_the_summary(
    solvers: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    tests, summary = solvers / "t.xml", solvers / "s.md"
    files = ["--junit", str(tests), "--summary", str(summary)]
    assert run("own_solvers.wrong:solve", "off-axis-strut.toml", *files) == 1
    why = capfd.readouterr().out.partition("  what would explain it: ")[2].splitlines()[0]
    assert "camber" in why
    assert "sign" in why
    (failure,) = ElementTree.parse(tests).getroot().iter("failure")
    assert f"; what would explain it: {why}" in failure.get("message", "")
    (line,) = (one for one in summary.read_text("utf-8").splitlines() if "what would explain it" in one)
    assert line.endswith(f"what would explain it: {markdown(why)}")


def test_json_is_alone_on_standard_output(solvers: Path) -> None:
    words = ["validate", "--solver", "own_solvers.prints:solve", "off-axis-strut.toml", "--json", "-"]
    # The tests' own folder, not ROOT's: ROOT is where the packages are installed.
    path = f"{ROOT}:{Path(plain_solvers.__file__).parent}"
    done = subprocess.run(
        [*PROGRAM, *words],
        capture_output=True,
        text=True,
        env={**ENVIRONMENT, "PYTHONPATH": path},
        check=True,
    )
    (scene,) = json.loads(done.stdout)["scenes"]
    assert scene["verdict"] == "agree"
    # It gives no dimensions of the wheel.
    given = [row for row in scene["comparisons"][0]["rows"] if row["quantity"] != "dimension"]
    assert {row["verdict"] for row in given} == {"agrees"}
    assert "hello" in done.stderr
    assert "hi" in done.stderr.split()


def test_a_solver_that_raises_is_told_in_a_line_and_other_scenes_go_on(
    solvers: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    assert run("own_solvers.raises:solve", "off-axis-strut.toml") == 3
    (line,) = complaints(capfd.readouterr().err)
    assert "off-axis-strut.toml: KeyError: 'strut' at raises.py:2" in line
    assert run("own_solvers.some:solve", "off-axis-strut.toml", "double-wishbone.toml") == 3
    said = capfd.readouterr()
    assert "SystemExit: 5 at some.py:3" in said.err
    assert "1 of 2 scenes agree" in said.out


def test_a_traceback_is_shown_where_it_is_asked_for(solvers: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert run("own_solvers.raises:solve", "--traceback", "off-axis-strut.toml") == 3
    assert "Traceback (most recent call last)" in capfd.readouterr().err


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["own_solvers.nowhere:solve"], "'own_solvers.nowhere' that is not found"),
        (["own_solvers.right:solv"], "(did you mean 'solve'?)"),
        (["own_solvers.raises:Twice"], "cannot be made without arguments: TypeError"),
        (["own_solvers.broken:solve"], "No module named 'nothing_of_that_name' at broken.py:1"),
        (["own_solvers.odd:solve"], "ZeroDivisionError: division by zero at odd.py:1"),
        (
            ["own_solvers.unread:solve"],
            "SyntaxError: '(' was never closed (unread.py, line 1); mend the module",
        ),
        (["own_solvers/right.py:solve"], "try own_solvers.right:solve"),
        (["own_solvers.right"], "give MODULE:NAME"),
        ([""], "give MODULE:NAME"),
        (["math:pi"], "is of type float, which is no solver"),
        (["own_solvers.right:solve", "--accuracy", "0"], "give a length above 0"),
        (["own_solvers.right:solve", "--accuracy", "fine"], "invalid float value: 'fine'"),
        (["own_solvers.right:solve", "--first", "absolute"], "--solver and --first are both given"),
        (["own_solvers.right:solve", "--second", "nobody"], "no formulation is called 'nobody'"),
    ],
)
def test_a_mistake_is_told_in_one_line(
    solvers: Path, capfd: pytest.CaptureFixture[str], words: list[str], said: str
) -> None:
    assert run(*words, "off-axis-strut.toml") == 2
    (line,) = complaints(capfd.readouterr().err)
    assert said in line


def test_an_accuracy_without_a_solver_is_a_mistake(capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["validate", "steer", "--accuracy", "1e-3"]) == 2
    assert "give --solver MODULE:NAME" in capfd.readouterr().err


def test_an_answer_that_is_no_mapping_is_told(solvers: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert run("own_solvers.none:solve", "off-axis-strut.toml") == 3
    assert "it answers with None; needed: a mapping" in capfd.readouterr().err


@pytest.mark.parametrize("module", ENDS)
def test_a_solver_that_crashes_or_reads_loses_that_scene_only(
    solvers: Path, capfd: pytest.CaptureFixture[str], module: str
) -> None:
    scenes = ["double-wishbone.toml", "off-axis-strut.toml", "./double-wishbone.toml"]
    junit, summary = (str(solvers / name) for name in ("j.xml", "s.md"))
    files = ["--junit", junit, "--summary", summary, "--json", "out.json"]
    assert run(f"own_solvers.{module}:solve", *scenes, *files) == 3
    said = capfd.readouterr()
    assert "2 of 3 scenes agree" in said.out
    (line,) = complaints(said.err)
    assert line.startswith("pointcoord: off-axis-strut.toml: ")
    assert ENDS[module][1] in line
    verdicts = [scene["exit_status"] for scene in json.loads(Path("out.json").read_text())["scenes"]]
    assert verdicts == [0, 3, 0]
    assert ENDS[module][1].split(":")[0] in Path(junit).read_text(encoding="utf-8")
    assert "2 of 3 scenes agree" in Path(summary).read_text(encoding="utf-8")


@pytest.mark.parametrize("module", HANGS)
def test_a_solver_that_hangs_is_stopped_and_made_anew(
    solvers: Path, capfd: pytest.CaptureFixture[str], module: str
) -> None:
    # Only who never answers is held to a short limit: a right one may wait for the machine.
    assert run(f"own_solvers.{module}:solve", "off-axis-strut.toml", "--solver-timeout", "0.5") == 3
    (line,) = complaints(capfd.readouterr().err)
    assert "took longer than 0.5 s and was stopped; --solver-timeout S allows more" in line
    strut, wishbone = (
        given_to_solver(Scene.load(name)) for name in ("off-axis-strut.toml", "double-wishbone.toml")
    )
    with Apart(f"own_solvers.{module}:solve", limit=0.5) as solver:
        with pytest.raises(SolverFailed, match="was stopped"):
            solver(strut)
        solver.limit = 600.0
        assert list(solver(wishbone)) == ["position"]


def test_a_module_that_ends_its_process_is_told_before_any_scene(
    solvers: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    assert run("own_solvers.exits:solve", "off-axis-strut.toml") == 2
    (line,) = complaints(capfd.readouterr().err)
    assert "cannot be imported: its process ended with exit status 7" in line


def test_what_a_stopped_solver_started_is_stopped_too(solvers: Path) -> None:
    mark = f"sleep {60 + len(str(solvers)) / 1000 + 0.0173}"
    text = f"import os\ndef solve(given):\n    os.system({mark!r})\n"
    (solvers / "own_solvers" / "starts.py").write_text(text, encoding="utf-8")
    assert run("own_solvers.starts:solve", "off-axis-strut.toml", "--solver-timeout", "3") == 3
    processes = subprocess.run(["ps", "-eo", "args"], capture_output=True, text=True, check=True).stdout
    assert mark not in processes.splitlines()


def test_a_solver_is_imported_once_for_all_scenes(solvers: Path, capfd: pytest.CaptureFixture[str]) -> None:
    text = "print('imported')\ndef solve(given):\n    return {}\n"
    (solvers / "own_solvers" / "once.py").write_text(text, encoding="utf-8")
    assert run("own_solvers.once:solve", "off-axis-strut.toml", "double-wishbone.toml") == 3
    assert capfd.readouterr().err.count("imported\n") == 1


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
    (solvers / "own_solvers" / "odd_ones.py").write_text(text, encoding="utf-8")
    told = []
    for extra in ([], ["--in-process"]):
        assert run("own_solvers.odd_ones:solve", "off-axis-strut.toml", "-v", *extra) == 3
        out = capfd.readouterr().out
        assert "agrees" in next(line for line in out.splitlines() if line.startswith("position"))
        told.append(out)
    assert told[0] == told[1]
    assert "velocity is of type Odd" in told[0]


def test_how_much_was_compared_is_said_and_points_of_the_chassis_are_no_agreement(
    solvers: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    (solvers / "own_solvers" / "chassis.py").write_text(f"def solve(given):\n{CHASSIS}", encoding="utf-8")
    tests = solvers / "tests.xml"
    assert run("own_solvers.chassis:solve", "off-axis-strut.toml", "--junit", str(tests)) == 3
    out = capfd.readouterr().out
    assert "not tested" in out
    assert "no verdict: whatever agrees is what the solver was given" in out
    count = sum(map(len, given_to_solver(Scene.load("off-axis-strut"))["asked"].values()))
    assert out.splitlines()[-2].endswith(
        f"; 1 of {count} numbers compared, 1 of them data that the solver was given, {count - 1} not given."
    )
    (error,) = ElementTree.parse(tests).getroot().iter("error")
    assert error.get("message", "").startswith("no verdict: whatever agrees is what the solver was given")


@pytest.mark.parametrize(
    ("part", "said", "case"),
    [
        ("{'toe': a['toe'][1:]}", "toe has the shape (4,); needed: (5,)", "toe"),
        (
            "{'cambre': a['camber']}",
            "'cambre', which the scene does not ask for (did you mean 'camber'?)",
            "",
        ),
        ("{'toe': __import__('numpy').ma.masked_less(a['toe'], 9)}", "toe has 5 masked entries", "toe"),
    ],
)
def test_what_is_given_and_cannot_be_used_ends_with_3_and_is_an_error_of_the_test_results(
    solvers: Path, capfd: pytest.CaptureFixture[str], part: str, said: str, case: str
) -> None:
    text = RIGHT.replace("return closed_form(given)", 'a = closed_form(given)["wheel"]')
    (solvers / "own_solvers" / "partly.py").write_text(
        f"{text}    return {{'camber': a['camber'], **{part}}}\n", encoding="utf-8"
    )
    tests = solvers / "tests.xml"
    assert run("own_solvers.partly:solve", "off-axis-strut.toml", "--junit", str(tests)) == 3
    out = capfd.readouterr().out
    assert f"  cannot be used: own_solvers.partly:solve{' ' if not case else ': wheel angle of '}" in out
    assert said in out
    assert "0 of 1 scene agrees" in out
    (error,) = ElementTree.parse(tests).getroot().iter("error")
    assert said in error.get("message", "")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--solver-timeout", "0"], "is no time limit in s"),
        (["--solver-timeout", "soon"], "is no time limit in s"),
        (["--solver-timeout", "5", "--in-process"], "--in-process has no time limit"),
    ],
)
def test_a_time_limit_that_is_none_is_refused(
    solvers: Path, capfd: pytest.CaptureFixture[str], words: list[str], said: str
) -> None:
    assert run("own_solvers.right:solve", "off-axis-strut.toml", *words) == 2
    (line,) = complaints(capfd.readouterr().err)
    assert said in line
