"""The pytest plugin and the workflow, as another project uses them.

The environment is as an installer for development would leave it, and made without a network.
"""

import os
import shlex
import shutil
import site
import subprocess
import sys
import sysconfig
import tomllib
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import yaml

from pointcoord import built_in_scenes, pytest_plugin
from validate import assert_refuses
from validate.hard.case import HARD
from validate.hard.catalogue import CASES
from validate.hard.subjects import SUBJECTS
from validate.solvers.plain import given_to_solver
from validate.testing.scenes import NOT_ASKED, impossible_scenes

ROOT = Path(__file__).parents[3]
EXAMPLE = ROOT / "tests" / "example_project"
ABOUT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
# Other plugins that happen to be installed are no part of the project that is tried; nor is a cache.
PLAIN = ("-m", "pytest", "-p", "no:cacheprovider", "-p", "no:xdist", "--strict-markers")
# The workflow that is shipped for GitHub Actions.
WORKFLOW: dict[Any, Any] = yaml.safe_load((ROOT / "validate" / "ci" / "github.yml").read_text("utf-8"))
(JOB,) = WORKFLOW["jobs"].values()
INSTALL, VALIDATE = (step["run"] for step in JOB["steps"] if "run" in step)


@pytest.fixture(scope="module")
def python(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The Python of a new environment in which pointcoord and the example project are installed."""
    folder = tmp_path_factory.mktemp("environment")
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", str(folder)], check=True)
    paths = {"base": str(folder), "platbase": str(folder)}
    packages = Path(sysconfig.get_path("purelib", scheme="venv", vars=paths))
    # After our own: an older pointcoord that is installed in another place is not the one that is tried.
    others = dict.fromkeys([*site.getsitepackages(), *(p for p in sys.path if p.endswith("-packages"))])
    (packages / "all.pth").write_text("\n".join([str(ROOT), str(EXAMPLE), *others]) + "\n", "utf-8")
    about = packages / f"pointcoord-{ABOUT['version']}.dist-info"
    about.mkdir()
    (about / "METADATA").write_text(f"Metadata-Version: 2.1\nName: pointcoord\nVersion: {ABOUT['version']}\n")
    groups = ABOUT["entry-points"].items()
    lines = [
        line for group, all in groups for line in (f"[{group}]", *(f"{k} = {v}" for k, v in all.items()))
    ]
    (about / "entry_points.txt").write_text("\n".join(lines) + "\n")
    return folder / "bin" / "python"


def run(*command: object, cwd: Path, **more: str) -> "subprocess.CompletedProcess[str]":
    """Run a command with nothing of this Python's and pytest's settings but where modules are compiled."""
    # Under CI pytest prints each error twice, the second time in its summary.
    dropped, kept = ("PYTHON", "PYTEST", "HYPOTHESIS", "CI", "BUILD_NUMBER"), ("PYTHONPYCACHEPREFIX",)
    settings = {k: v for k, v in os.environ.items() if k in kept or not k.startswith(dropped)}
    words = list(map(str, command))
    return subprocess.run(words, capture_output=True, text=True, check=False, cwd=cwd, env=settings | more)


def said_of(python: Path, folder: Path, text: str, *options: str, passes: bool = True) -> str:
    """What a run of pytest says of one file of tests."""
    (folder / "pytest.ini").write_text("[pytest]\n", encoding="utf-8")
    (folder / "test_it.py").write_text(text, encoding="utf-8")
    done = run(python, *PLAIN, *options, "test_it.py", cwd=folder)
    assert (done.returncode == 0) == passes, done.stdout + done.stderr
    assert "Traceback" not in done.stdout + done.stderr
    return done.stdout + done.stderr


# Of each kind of hard case one; all of them take a minute.
SOME = "double-wishbone or arm-highest or far-from or upper-arm-long or whole-range-rack"


def test_an_example_project_tests_its_right_and_its_wrong_solver(python: Path) -> None:
    done = run(python, *PLAIN, "tests/right.py", "-k", SOME, "-rs", cwd=EXAMPLE)
    assert done.returncode == 0, done.stdout + done.stderr
    *_, skipped, summary = done.stdout.splitlines()
    # One of them without a pose, which it must not answer; one so near to a lock that 1e-6 mm says nothing.
    assert summary.startswith("6 passed, 1 skipped, "), done.stdout
    assert "whole-range-rack-wishbone at 1e-08" in skipped
    assert "an accuracy of 1e-06 mm gives no tolerance" in skipped
    done = run(python, *PLAIN, "tests/wrong.py", cwd=EXAMPLE)
    assert done.returncode == 1, done.stdout + done.stderr
    said = [line.removeprefix("E").strip() for line in done.stdout.splitlines() if line.startswith("E ")]
    assert "disagrees with pointcoord" in said[0]
    assert said[1].startswith("camber: difference ")
    assert said[2] == "possible explanation: camber: the other sign"
    # The message is all: not where in the harness it was found.
    assert "assertion.py" not in done.stdout


def test_a_run_that_does_not_use_the_plugin_imports_nothing_for_it(python: Path, tmp_path: Path) -> None:
    """The plugin is loaded by its entry point, and nothing with it that pytest has not loaded itself."""
    text = (
        "import sys\n"
        "def test_plain(request):\n"
        "    assert request.config.pluginmanager.hasplugin('pointcoord')\n"
        "    packages = 'pointcoord', 'absolute', 'validate', 'numpy', 'scipy', 'pydantic_core', 'flint'\n"
        "    found = {n for n in sys.modules if n.partition('.')[0] in packages}\n"
        "    assert found == {'pointcoord', 'pointcoord.pytest_plugin'}\n"
    )
    off = [word for name in ("benchmark", "hypothesispytest", "timeout") for word in ("-p", f"no:{name}")]
    said_of(python, tmp_path, text, *off, "-W", "error")
    # And it can be left out.
    assert "pointcoord" not in said_of(
        python, tmp_path, "def test_plain(): ...\n", *off, "-p", "no:pointcoord"
    )


def test_every_scene_is_one_test_and_fixtures_hold_solve_once_and_skip_what_is_not_tested(
    python: Path, tmp_path: Path
) -> None:
    text = """
import pytest
pytestmark = pytest.mark.suspension_scenes("arm-highest-held", near=1e-4)

@pytest.mark.suspension_scenes()
def test_one(scene):
    assert len(scene.instants)

def test_the_reference_is_proven_and_solved_once_and_agrees(reference, assert_agrees):
    solution = reference("steer")
    assert solution.accuracy.proven
    assert reference("steer") is solution
    assert assert_agrees(solution.numbers, "steer", accuracy=1e-6).passed

def test_not_tested(reference, assert_agrees):
    assert_agrees(reference("steer").numbers, "steer", accuracy=1e3)
"""
    said = said_of(python, tmp_path, text, "-v", "-rs")
    scenes = (*built_in_scenes(), "arm-highest-held at 0.0001")
    assert [name for name in scenes if f"test_one[{name}]" not in said] == []
    assert f"{len(scenes) + 1} passed, 1 skipped" in said
    assert "an accuracy of 1000 mm gives no tolerance" in said


MARKED = "import pytest\n@pytest.mark.suspension_scenes('steer')\ndef test_marked({}): ...\n"


@pytest.mark.parametrize(
    ("file", "content", "text", "words"),
    [
        ("validate.py", "", MARKED.format("scene"), "validate.py) is not part of pointcoord"),
        ("validate.py", "", "def test_fixture(plain_scene): ...\n", "\nthe package 'validate' that Python "),
        (
            "conftest.py",
            "import sys; sys.modules['flint'] = None\n",
            MARKED.format("scene"),
            "needs the package 'flint', which is not installed; try: pip install 'pointcoord[validate]'",
        ),
        (
            "",
            "",
            MARKED.format(""),
            "test_marked: suspension_scenes: the test takes no argument 'scene'; add",
        ),
    ],
)
def test_what_keeps_the_plugin_from_work_is_said(
    file: str, content: str, text: str, words: str, python: Path, tmp_path: Path
) -> None:
    (tmp_path / (file or "none")).write_text(content, encoding="utf-8")
    assert words in said_of(python, tmp_path, text, passes=False)


def test_a_project_with_a_module_validate_of_its_own_keeps_it(python: Path, tmp_path: Path) -> None:
    (tmp_path / "validate.py").write_text("OWN = 1\n", encoding="utf-8")
    said_of(python, tmp_path, "import validate\ndef test_own(): assert validate.OWN\n")


@pytest.mark.parametrize(
    ("name", "of", "options", "words"),
    [
        ("suspension_scenes", "bunce", {}, "did you mean 'bounce'?"),
        ("suspension_scenes", "link-twice", {}, "it is not a scene, or a solver may refuse it"),
        ("suspension_scenes", "branches-met", {}, "without a pose; mark with impossible_scenes"),
        (
            "suspension_scenes",
            "",
            {"suspension": "wishbone"},
            "'wishbone' does not exist; there are: andrews",
        ),
        ("suspension_scenes", "arm-highest-held", {"near": 0.0}, "near=0.0 is not a number above 0"),
        (
            "suspension_scenes",
            "steer",
            {"suspension": "axle"},
            "no scene fits the mark; leave `suspension` out",
        ),
        ("impossible_scenes", "steer", {}, "'steer' is not a case without a pose; there are: reach-arm-"),
    ],
)
def test_a_mark_that_cannot_be_followed_is_said_in_a_line(
    name: str, of: str, options: dict[str, object], words: str
) -> None:
    # As pytest hands it over; the plugin need not be loaded here.
    marked = SimpleNamespace(name=name, args=of.split(), kwargs=options)
    with pytest.raises(pytest.Collector.CollectError) as caught:
        pytest_plugin.scenes_of("test_it.py::test_one", [marked])
    said = str(caught.value)
    assert said.startswith("test_it.py::test_one: ")
    assert words in said
    assert "\n" not in said


def test_every_hard_case_is_asked_or_cannot_be() -> None:
    asked = {case.name for case in CASES if case.answered}
    refused = {case.name for case in CASES if case.without_pose}
    assert not asked & refused
    assert {case.name for case in CASES} - asked - refused == NOT_ASKED
    # What is no scene is refused when it is read, or is tried without one.
    assert {case.name for case in CASES if case.content is None} <= NOT_ASKED
    for subject in SUBJECTS:
        assert (f"turned-at-random{subject.suffix}" in asked) == (subject.name not in HARD)


def test_a_case_without_a_pose_is_refused_or_answered_by_none_that_is_right() -> None:
    (scene,) = impossible_scenes(["start-beyond-upper-arm-locks"]).values()
    answer = {"position": {"wheel_centre": np.zeros((len(given_to_solver(scene)["instants"]), 3))}}
    for wrong, words in (
        (answer, rf"answers '{scene.title}' at t = .*where there is no pose: "),
        ({"camber": [1.0, 2.0, 3.0, 4.0]}, "has the shape"),
        (None, "it returns None; needed: a mapping"),
    ):
        with pytest.raises(AssertionError, match=words):
            assert_refuses(lambda _, wrong=wrong: wrong, scene)
    answer["position"]["wheel_centre"] += np.nan
    assert_refuses(lambda _: answer, scene)

    def solve(given: object) -> None:
        raise ZeroDivisionError("the arm")

    assert_refuses(solve, scene)
    with pytest.raises(ZeroDivisionError):
        assert_refuses(solve, scene, raises=ValueError)
    with pytest.raises(AssertionError, match="every instant of 'double-wishbone' has a pose"):
        assert_refuses(solve, "double-wishbone")


def step(action: str) -> dict[str, Any]:
    """The last step that uses an action."""
    return [one for one in JOB["steps"] if one.get("uses", "").startswith(action)][-1]


def test_the_workflow_runs_at_each_push_may_only_read_and_installs_what_it_checks_out() -> None:
    # YAML takes the word `on` for a truth.
    assert WORKFLOW[True] == ["push", "pull_request"]
    assert WORKFLOW["permissions"] == {"contents": "read"}
    version, least = step("actions/setup-python")["with"]["python-version"], ABOUT["requires-python"]
    assert [*map(int, version.split("."))] >= [*map(int, least.removeprefix(">=").split("."))]
    # It is on no index: there its name would be anybody's.
    there = step("actions/checkout")["with"]["path"]
    assert shlex.split(INSTALL) == ["pip", "install", ".", f"./{there}[validate]"]
    assert "validate" in ABOUT["optional-dependencies"]
    kept = step("actions/upload-artifact")
    assert (kept["with"]["path"], kept["if"]) == ("pointcoord.xml", "always()")


@pytest.mark.parametrize(("solver", "status"), [("solve", 0), ("wrong", 1)])
def test_the_workflow_decides_by_what_it_runs(solver: str, status: int, python: Path, tmp_path: Path) -> None:
    program = python.with_name("pointcoord")
    program.write_text(f'#!/bin/sh\nexec "{python}" -m pointcoord "$@"\n', encoding="utf-8")
    program.chmod(0o755)
    (tmp_path / "scenes").mkdir()
    text = (ROOT / "pointcoord" / "scenes" / "double-wishbone.toml").read_text("utf-8")
    (tmp_path / "scenes" / "front.toml").write_text(text.replace("samples = 101", "samples = 5"), "utf-8")
    command = VALIDATE.replace("my_package.my_module:solve", f"wishbone_solver:{solver}")
    path = f"{program.parent}{os.pathsep}{os.environ['PATH']}"
    more = JOB["env"] | {"PATH": path, "GITHUB_STEP_SUMMARY": str(tmp_path / "summary.md")}
    done = run(shutil.which("bash"), "-e", "-c", command, cwd=tmp_path, **more)
    assert done.returncode == status, done.stdout + done.stderr
    assert ("disagrees" in (tmp_path / "summary.md").read_text(encoding="utf-8")) == bool(status)
    # What is kept as an artifact is there either way.
    assert ("<failure" in (tmp_path / "pointcoord.xml").read_text(encoding="utf-8")) == bool(status)
