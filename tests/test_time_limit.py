"""A test that hangs ends the run with a failure that names it."""

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
HANGING = """
def test_that_hangs() -> None:
    while True:
        pass


def test_that_passes() -> None:
    pass
"""


@pytest.mark.parametrize("workers", ["0", "2"])
def test_a_hanging_test_fails_by_name_and_the_others_are_run(tmp_path: Path, workers: str) -> None:
    path = tmp_path / "test_hanging.py"
    path.write_text(HANGING)
    command = [sys.executable, "-m", "pytest", "-c", str(ROOT / "pyproject.toml"), "-n", workers]
    done = subprocess.run(
        [*command, "-o", "timeout=1", str(path)],
        capture_output=True,
        text=True,
        check=False,
        cwd=tmp_path,
        timeout=120,
    )
    assert done.returncode == 1
    assert "test_that_hangs - Failed: Timeout" in done.stdout
    assert "1 failed, 1 passed" in done.stdout


def test_every_test_has_a_time_limit(pytestconfig: pytest.Config) -> None:
    assert float(pytestconfig.getini("timeout")) > 0.0
