"""Somebody else's project, installed in its own environment, tests its solver with the plugin."""

import shutil
from pathlib import Path

import pytest
from new_environment import Environment, reported

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


def test_a_run_that_does_not_use_the_plugin_imports_nothing_for_it(
    environment: Environment, tmp_path: Path
) -> None:
    """The plugin is loaded by its entry point, and nothing with it that pytest has not loaded itself."""
    (tmp_path / "test_plain.py").write_text(
        "import sys\n"
        "def test_plain(request):\n"
        "    assert request.config.pluginmanager.hasplugin('pointcoord')\n"
        "    packages = 'pointcoord', 'absolute', 'validate', 'numpy', 'scipy', 'pydantic_core', 'flint'\n"
        "    found = {n for n in sys.modules if n.partition('.')[0] in packages}\n"
        "    assert found == {'pointcoord', 'pointcoord.pytest_plugin'}\n",
        encoding="utf-8",
    )
    off = [word for name in ("benchmark", "hypothesispytest", "timeout") for word in ("-p", f"no:{name}")]
    done = environment.run(*PLAIN, *off, "-W", "error", "test_plain.py", cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    # And it can be left out.
    (tmp_path / "test_plain.py").write_text("def test_plain(): ...\n", encoding="utf-8")
    done = environment.run(*PLAIN, *off, "-p", "no:pointcoord", "test_plain.py", cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "pointcoord" not in done.stdout


def test_a_project_with_a_module_validate_of_its_own_keeps_it(
    environment: Environment, tmp_path: Path
) -> None:
    (tmp_path / "validate.py").write_text("OWN = 1\n", encoding="utf-8")
    (tmp_path / "test_own.py").write_text(
        "import validate\ndef test_own(): assert validate.OWN\n", encoding="utf-8"
    )
    done = environment.run(*PLAIN, "test_own.py", cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    (tmp_path / "test_own.py").write_text(
        "import pytest\n@pytest.mark.suspension_scenes('steer')\ndef test_marked(scene): ...\n",
        encoding="utf-8",
    )
    done = environment.run(*PLAIN, "test_own.py", cwd=tmp_path)
    (said,) = (line for line in reported(done) if "suspension_scenes" in line)
    assert f"({tmp_path / 'validate.py'}) is not part of pointcoord" in said
    assert "Traceback" not in done.stdout + done.stderr
    (tmp_path / "test_own.py").write_text("def test_fixture(plain_scene): ...\n", encoding="utf-8")
    done = environment.run(*PLAIN, "test_own.py", cwd=tmp_path)
    assert any(line.startswith("the package 'validate' that Python finds") for line in reported(done))
    assert "1 error" in done.stdout


def test_without_the_extra_the_mark_says_how_to_get_it(environment: Environment, tmp_path: Path) -> None:
    (tmp_path / "conftest.py").write_text("import sys; sys.modules['flint'] = None\n", encoding="utf-8")
    (tmp_path / "test_it.py").write_text(
        "import pytest\n@pytest.mark.suspension_scenes()\ndef test_one(scene): ...\n", encoding="utf-8"
    )
    done = environment.run(*PLAIN, "test_it.py", cwd=tmp_path)
    (said,) = (line for line in reported(done) if "needs the package 'flint'" in line)
    assert "pip install 'pointcoord[validate]'" in said
