"""The workflow that is shipped for GitHub Actions does what it says, for a right and a wrong solver."""

import os
import shlex
import shutil
import subprocess
import tomllib
from importlib import resources
from pathlib import Path
from typing import Any

import yaml
from new_environment import Environment, settings

import pointcoord
from validate import cli

ROOT = Path(__file__).parents[3]
TEXT = (resources.files("validate.ci") / "github.yml").read_text(encoding="utf-8")
WORKFLOW: dict[Any, Any] = yaml.safe_load(TEXT)
(JOB,) = WORKFLOW["jobs"].values()
INSTALL, VALIDATE = (step["run"] for step in JOB["steps"] if "run" in step)
SOLVER = "my_package.my_module:solve"


def step(action: str) -> dict[str, Any]:
    """The last step that uses an action."""
    return [one for one in JOB["steps"] if one.get("uses", "").startswith(action)][-1]


def test_the_workflow_runs_at_each_push_and_may_only_read() -> None:
    # YAML takes the word `on` for a truth.
    assert WORKFLOW[True] == ["push", "pull_request"]
    assert WORKFLOW["permissions"] == {"contents": "read"}
    python = step("actions/setup-python")["with"]["python-version"]
    least = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["requires-python"]
    assert tuple(map(int, python.split("."))) >= tuple(map(int, least.removeprefix(">=").split(".")))


def test_pointcoord_is_installed_from_where_it_is_checked_out() -> None:
    """It is on no index: there its name would be anybody's."""
    there = step("actions/checkout")["with"]["path"]
    assert shlex.split(INSTALL) == ["pip", "install", ".", f"./{there}[validate]"]
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert "validate" in extras["optional-dependencies"]


def test_every_option_of_the_workflow_is_one_of_the_command() -> None:
    program, name, *words = shlex.split(VALIDATE)
    assert (program, name) == ("pointcoord", "validate")
    # Which solver it is stands in its place among the options.
    solver = words.index("--solver")
    assert words[solver + 1] == SOLVER
    del words[solver : solver + 4]
    options = cli.parser(name).parse_args(words)
    assert (options.scenes_dir, options.junit) == ("scenes", "pointcoord.xml")
    assert options.summary == "$GITHUB_STEP_SUMMARY"
    kept = step("actions/upload-artifact")
    assert kept["with"]["path"] == options.junit
    assert kept["if"] == "always()"


def test_the_workflow_decides_by_what_it_runs(tmp_path: Path) -> None:
    environment = Environment(tmp_path / "environment")
    environment.install(ROOT)
    environment.install(ROOT / "tests" / "example_project")
    program = environment.python.with_name("pointcoord")
    program.write_text(f'#!/bin/sh\nexec "{environment.python}" -m pointcoord "$@"\n', encoding="utf-8")
    program.chmod(0o755)
    project = tmp_path / "project"
    (project / "scenes").mkdir(parents=True)
    built_in = Path(pointcoord.__file__).parent / "scenes" / "double-wishbone.toml"
    text = built_in.read_text(encoding="utf-8").replace("samples = 101", "samples = 5")
    (project / "scenes" / "front.toml").write_text(text, encoding="utf-8")
    path = f"{program.parent}{os.pathsep}{os.environ['PATH']}"
    for solver, status in (("solve", 0), ("wrong", 1)):
        summary = tmp_path / f"{solver}.md"
        command = VALIDATE.replace(SOLVER, f"wishbone_solver:{solver}")
        done = subprocess.run(
            [shutil.which("bash") or "bash", "-e", "-c", command],
            capture_output=True,
            text=True,
            check=False,
            cwd=project,
            env=settings() | JOB["env"] | {"PATH": path, "GITHUB_STEP_SUMMARY": str(summary)},
        )
        assert done.returncode == status, done.stdout + done.stderr
        assert ("disagrees" in summary.read_text(encoding="utf-8")) == bool(status)
        # What is kept as an artifact is there either way.
        junit = (project / "pointcoord.xml").read_text(encoding="utf-8")
        assert ("<failure" in junit) == bool(status)
