"""A test that hangs ends the run with a failure that names it."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
# A search for examples catches what a test raises and tries it again.
HANGING = """
from hypothesis import given, strategies


@given(x=strategies.integers())
def test_that_hangs(x: int) -> None:
    while x > 3:
        pass


def test_that_passes() -> None:
    pass
"""


def run(folder: Path, workers: str) -> tuple[int, str]:
    """Exit status and output of a run with the project's settings and a limit of 1 s."""
    path = folder / "test_hanging.py"
    path.write_text(HANGING)
    command = [sys.executable, "-m", "pytest", "-c", str(ROOT / "pyproject.toml"), "-n", workers]
    done = subprocess.run(
        [*command, "-o", "timeout=1", "-o", f"pythonpath={ROOT / 'tests' / 'support'}", str(path)],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
        cwd=folder,
        timeout=120,
    )
    return done.returncode, done.stdout


def test_a_hanging_test_fails_by_name_and_the_others_are_run(tmp_path: Path) -> None:
    status, told = run(tmp_path, "2")
    assert status == 1
    assert "crashed while running" in told
    assert "::test_that_hangs" in told
    assert "1 failed, 1 passed" in told


def test_without_workers_a_hanging_test_ends_the_run_with_its_place(tmp_path: Path) -> None:
    status, told = run(tmp_path, "0")
    assert status == 1
    assert "Timeout" in told
    assert re.search(r"line \d+, in test_that_hangs", told)


def test_every_test_has_a_time_limit(pytestconfig: pytest.Config) -> None:
    assert float(pytestconfig.getini("timeout")) > 0.0
    assert pytestconfig.getini("timeout_method") == "thread"
