"""Somebody else's project, installed in its own environment, tests its solver with the plugin."""

import shutil
import subprocess
from pathlib import Path

import pytest
from new_environment import Environment

ROOT = Path(__file__).parents[3]
EXAMPLE = ROOT / "tests" / "example_project"
# Other plugins that happen to be installed are no part of the project that is tried; nor is a cache.
PLAIN = ("-m", "pytest", "-p", "no:cacheprovider", "-p", "no:xdist")


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


def test_a_right_solver_passes_over_built_in_scenes_and_hard_cases(
    environment: Environment, project: Path
) -> None:
    done = environment.run(*PLAIN, "tests/right.py", cwd=project)
    assert done.returncode == 0, done.stdout + done.stderr
    summary = done.stdout.splitlines()[-1]
    assert "failed" not in summary
    assert "skipped" not in summary
    # One built-in double wishbone, and every hard case of one.
    assert int(summary.split(" passed")[0]) > 30


def test_a_wrong_solver_fails_and_hears_what_is_wrong_by_how_much_where_and_why(
    environment: Environment, project: Path
) -> None:
    done = environment.run(*PLAIN, "tests/wrong.py", cwd=project)
    assert done.returncode == 1, done.stdout + done.stderr
    said = [line.removeprefix("E").strip() for line in done.stdout.splitlines() if line.startswith("E ")]
    assert "disagree with pointcoord" in said[0]
    assert said[1].startswith("camber: difference ")
    assert " rad, tolerance " in said[1]
    assert " rad at t = " in said[1]
    assert said[2] == "what would explain it: camber: the other sign"
    # The message is all: not where in the harness it was found.
    assert "assertion.py" not in done.stdout


def test_a_run_that_does_not_use_the_plugin_imports_nothing_for_it(
    environment: Environment, tmp_path: Path
) -> None:
    """The plugin is loaded by its entry point, and with it two small modules without any library."""
    (tmp_path / "test_plain.py").write_text(
        "import sys\n"
        "def test_plain(request):\n"
        "    assert request.config.pluginmanager.hasplugin('pointcoord')\n"
        "    packages = 'pointcoord', 'absolute', 'validate'\n"
        "    ours = {n for n in sys.modules if n.partition('.')[0] in packages}\n"
        "    assert ours == {'validate', 'validate.running', 'validate.extras', 'validate.pytest_plugin'}\n"
        "    assert not {'numpy', 'flint', 'mpmath'} & set(sys.modules)\n",
        encoding="utf-8",
    )
    off = [word for name in ("benchmark", "hypothesispytest", "timeout") for word in ("-p", f"no:{name}")]
    done = environment.run(*PLAIN, *off, "-W", "error", "test_plain.py", cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_environment_runs_the_copy_that_it_was_given(environment: Environment, tmp_path: Path) -> None:
    program = "import pointcoord, validate, wishbone_solver as w; print(pointcoord.__file__, w.__file__)"
    done: subprocess.CompletedProcess[str] = environment.run("-c", program, cwd=tmp_path)
    assert [Path(p).parents[1] for p in done.stdout.split()] == [environment.site] * 2, done.stderr
