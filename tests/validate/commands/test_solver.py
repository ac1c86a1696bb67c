"""A solver of one's own runs in its own process. What becomes of its answers is in `answered.txt`."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from validate.cli import main

PRINTS = """
import os
print("hello")
def solve(given):
    print("solves")
    os.system("echo hi")
    return {}
"""


def run(folder: Path, monkeypatch: pytest.MonkeyPatch, text: str, *words: str) -> int:
    """Compare a solver with this text."""
    (folder / "own_solver.py").write_text(text, encoding="utf-8")
    monkeypatch.delitem(sys.modules, "own_solver", raising=False)
    monkeypatch.chdir(folder)
    return main(["validate", "--solver", "own_solver:solve", "steer", *words])


def test_what_a_solver_prints_goes_to_standard_error_and_it_is_imported_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    assert run(tmp_path, monkeypatch, PRINTS, "--json", "-") == 3
    out, err = capfd.readouterr()
    assert json.loads(out)["scenes"][0]["verdict"] == "no verdict"
    said = err.splitlines()
    assert (said.count("hello"), said.count("solves"), said.count("hi")) == (1, 1, 1)


def test_what_a_stopped_solver_started_is_stopped_too(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    mark = f"sleep {60 + len(str(tmp_path)) / 1000 + 0.0173}"
    text = f"import os\ndef solve(given):\n    os.system({mark!r})\n"
    assert run(tmp_path, monkeypatch, text, "--solver-timeout", "3") == 3
    processes = subprocess.run(["ps", "-eo", "args"], capture_output=True, text=True, check=True).stdout
    assert mark not in processes.splitlines()
