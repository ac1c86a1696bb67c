"""Somebody else's project, installed in its own environment, tests its solver by the plugin and the workflow.

The environment is as an installer would leave it, and made without a network.
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
from typing import Any

import pytest
import yaml

ROOT = Path(__file__).parents[3]
EXAMPLE = ROOT / "tests" / "example_project"
# Other plugins that happen to be installed are no part of the project that is tried; nor is a cache.
PLAIN = ("-m", "pytest", "-p", "no:cacheprovider", "-p", "no:xdist")
# The workflow that is shipped for GitHub Actions.
WORKFLOW: dict[Any, Any] = yaml.safe_load((ROOT / "validate" / "ci" / "github.yml").read_text("utf-8"))
(JOB,) = WORKFLOW["jobs"].values()
INSTALL, VALIDATE = (step["run"] for step in JOB["steps"] if "run" in step)


def settings() -> dict[str, str]:
    """What a program of it is told: nothing of this Python's and pytest's but where modules are compiled."""
    # Under CI pytest tells each error twice, the second time in its summary.
    dropped, kept = ("PYTHON", "PYTEST", "HYPOTHESIS", "CI", "BUILD_NUMBER"), ("PYTHONPYCACHEPREFIX",)
    return {k: v for k, v in os.environ.items() if k in kept or not k.startswith(dropped)}


class Environment:
    """A new virtual environment that also sees the packages of the running Python."""

    def __init__(self, folder: Path) -> None:
        subprocess.run([sys.executable, "-m", "venv", "--without-pip", str(folder)], check=True)
        self.python = folder / "bin" / "python"
        paths = {"base": str(folder), "platbase": str(folder)}
        self.site = Path(sysconfig.get_path("purelib", scheme="venv", vars=paths))
        # After its own packages: an older pointcoord that is installed there is not the one that is tried.
        others = dict.fromkeys([*site.getsitepackages(), *(p for p in sys.path if p.endswith("-packages"))])
        (self.site / "others.pth").write_text("\n".join(others) + "\n", encoding="utf-8")

    def install(self, project: Path) -> None:
        """Copy a project's packages, and write what its pyproject says of it beside them."""
        told = tomllib.loads((project / "pyproject.toml").read_text(encoding="utf-8"))
        about = told["project"]
        for package in told["tool"]["hatch"]["build"]["targets"]["wheel"]["packages"]:
            ignored = shutil.ignore_patterns("__pycache__")
            shutil.copytree(project / package, self.site / package, ignore=ignored)
        name = about["name"].replace("-", "_")
        folder = self.site / f"{name}-{about['version']}.dist-info"
        folder.mkdir()
        metadata = f"Metadata-Version: 2.1\nName: {about['name']}\nVersion: {about['version']}\n"
        (folder / "METADATA").write_text(metadata, encoding="utf-8")
        groups = [
            "\n".join([f"[{group}]", *(f"{key} = {value}" for key, value in entries.items())])
            for group, entries in about.get("entry-points", {}).items()
        ]
        (folder / "entry_points.txt").write_text("\n".join(groups) + "\n", encoding="utf-8")
        files = [p for p in self.site.rglob("*.py") if p.is_file()]
        record = "".join(f"{p.relative_to(self.site)},,\n" for p in files)
        (folder / "RECORD").write_text(record, encoding="utf-8")

    def run(
        self, *words: str, cwd: Path, program: str | None = None, **more: str
    ) -> "subprocess.CompletedProcess[str]":
        """Run its Python, or another program that is told more by its environment."""
        command = [program or str(self.python), *words]
        return subprocess.run(
            command, capture_output=True, text=True, check=False, cwd=cwd, env=settings() | more
        )


@pytest.fixture(scope="module")
def environment(tmp_path_factory: pytest.TempPathFactory) -> Environment:
    found = Environment(tmp_path_factory.mktemp("environment"))
    found.install(ROOT)
    found.install(EXAMPLE)
    return found


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Its tests, away from our own ones, which have settings of their own."""
    folder = tmp_path_factory.mktemp("project")
    shutil.copy(EXAMPLE / "pyproject.toml", folder)
    shutil.copytree(EXAMPLE / "tests", folder / "tests")
    return folder


# Of each kind of hard case one; all of them take a minute.
SOME = "double-wishbone or arm-highest or far-from or upper-arm-long or whole-range-rack"


def test_a_right_solver_passes_over_built_in_scenes_and_hard_cases(
    environment: Environment, project: Path
) -> None:
    done = environment.run(*PLAIN, "tests/right.py", "-k", SOME, "-rs", cwd=project)
    assert done.returncode == 0, done.stdout + done.stderr
    *_, skipped, summary = done.stdout.splitlines()
    # One of them without a pose, which it must not answer; one so near to a lock that 1e-6 mm says nothing.
    assert summary.startswith("6 passed, 1 skipped, "), done.stdout
    assert "whole-range-rack-wishbone at 1e-08" in skipped
    assert "an accuracy of 1e-06 mm gives no tolerance" in skipped


def test_a_wrong_solver_fails_and_hears_what_is_wrong_by_how_much_where_and_why(
    environment: Environment, project: Path
) -> None:
    done = environment.run(*PLAIN, "tests/wrong.py", cwd=project)
    assert done.returncode == 1, done.stdout + done.stderr
    said = [line.removeprefix("E").strip() for line in done.stdout.splitlines() if line.startswith("E ")]
    assert "disagree with pointcoord" in said[0]
    assert said[1].startswith("camber: difference ")
    assert " rad, tolerance " in said[1]
    assert " rad at " in said[1]
    assert said[2] == "possible explanation: camber: the other sign"
    # The message is all: not where in the harness it was found.
    assert "assertion.py" not in done.stdout


def said_of(environment: Environment, folder: Path, text: str, *options: str, status: int = 0) -> str:
    """What a run of pytest in the environment says of one file of tests."""
    (folder / "test_it.py").write_text(text, encoding="utf-8")
    done = environment.run(*PLAIN, *options, "test_it.py", cwd=folder)
    assert (done.returncode == 0) == (status == 0), done.stdout + done.stderr
    return done.stdout + done.stderr


def test_a_run_that_does_not_use_the_plugin_imports_nothing_for_it(
    environment: Environment, tmp_path: Path
) -> None:
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
    said_of(environment, tmp_path, text, *off, "-W", "error")
    # And it can be left out.
    said = said_of(environment, tmp_path, "def test_plain(): ...\n", *off, "-p", "no:pointcoord")
    assert "pointcoord" not in said


MARKED = "import pytest\n@pytest.mark.suspension_scenes('steer')\ndef test_marked(scene): ...\n"


def test_a_project_with_a_module_validate_of_its_own_keeps_it(
    environment: Environment, tmp_path: Path
) -> None:
    (tmp_path / "validate.py").write_text("OWN = 1\n", encoding="utf-8")
    said_of(environment, tmp_path, "import validate\ndef test_own(): assert validate.OWN\n")
    said = said_of(environment, tmp_path, MARKED, status=1)
    assert f"({tmp_path / 'validate.py'}) is not part of pointcoord" in said
    assert "Traceback" not in said
    said = said_of(environment, tmp_path, "def test_fixture(plain_scene): ...\n", status=1)
    assert "\nthe package 'validate' that Python finds" in said
    assert "1 error" in said


def test_without_the_extra_the_mark_says_how_to_get_it(environment: Environment, tmp_path: Path) -> None:
    (tmp_path / "conftest.py").write_text("import sys; sys.modules['flint'] = None\n", encoding="utf-8")
    (said,) = (
        line
        for line in said_of(environment, tmp_path, MARKED, status=1).splitlines()
        if "needs the package 'flint'" in line
    )
    assert "pip install 'pointcoord[validate]'" in said


def step(action: str) -> dict[str, Any]:
    """The last step that uses an action."""
    return [one for one in JOB["steps"] if one.get("uses", "").startswith(action)][-1]


def test_the_workflow_runs_at_each_push_may_only_read_and_installs_what_it_checks_out() -> None:
    # YAML takes the word `on` for a truth.
    assert WORKFLOW[True] == ["push", "pull_request"]
    assert WORKFLOW["permissions"] == {"contents": "read"}
    about = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    python, least = step("actions/setup-python")["with"]["python-version"], about["requires-python"]
    assert [*map(int, python.split("."))] >= [*map(int, least.removeprefix(">=").split("."))]
    # It is on no index: there its name would be anybody's.
    there = step("actions/checkout")["with"]["path"]
    assert shlex.split(INSTALL) == ["pip", "install", ".", f"./{there}[validate]"]
    assert "validate" in about["optional-dependencies"]
    kept = step("actions/upload-artifact")
    assert (kept["with"]["path"], kept["if"]) == ("pointcoord.xml", "always()")


def test_the_workflow_decides_by_what_it_runs(environment: Environment, tmp_path: Path) -> None:
    program = environment.python.with_name("pointcoord")
    program.write_text(f'#!/bin/sh\nexec "{environment.python}" -m pointcoord "$@"\n', encoding="utf-8")
    program.chmod(0o755)
    (tmp_path / "scenes").mkdir()
    text = (ROOT / "pointcoord" / "scenes" / "double-wishbone.toml").read_text("utf-8")
    (tmp_path / "scenes" / "front.toml").write_text(text.replace("samples = 101", "samples = 5"), "utf-8")
    path = f"{program.parent}{os.pathsep}{os.environ['PATH']}"
    for solver, status in (("solve", 0), ("wrong", 1)):
        summary = tmp_path / f"{solver}.md"
        command = VALIDATE.replace("my_package.my_module:solve", f"wishbone_solver:{solver}")
        more = JOB["env"] | {"PATH": path, "GITHUB_STEP_SUMMARY": str(summary)}
        done = environment.run("-e", "-c", command, program=shutil.which("bash"), cwd=tmp_path, **more)
        assert done.returncode == status, done.stdout + done.stderr
        assert ("disagrees" in summary.read_text(encoding="utf-8")) == bool(status)
        # What is kept as an artifact is there either way.
        assert ("<failure" in (tmp_path / "pointcoord.xml").read_text(encoding="utf-8")) == bool(status)
