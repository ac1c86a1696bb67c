"""How far a run is, and how long the rest takes at its pace; in a pipe a line now and then."""

import re
import time

import pytest

from validate.output import console as module
from validate.output.console import Console, Progress


def test_lines_go_to_standard_error_of_a_pipe_unless_the_run_is_quiet(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "PATIENCE", 0.05)
    console, err = Console(), ""
    # What is done inside is said in the same lines.
    with console.progress("scenes", 2, True), console.progress("cost") as told:
        told("series", 60, 150)
        while not err.endswith("\n"):
            time.sleep(0.01)
            out, more = capsys.readouterr()
            err += more
            assert out == ""
    assert re.fullmatch(r"pointcoord: note: after \d+ s: series, 60 of 150 done(, \d+ s left)?\n", err)
    console.quiet = True
    with console.progress("processes start", everywhere=True):
        time.sleep(0.3)
    assert capsys.readouterr() == ("", "")


def test_the_rest_is_told_at_the_pace_since_this_run_began(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = [0.0]
    monkeypatch.setattr(module.time, "monotonic", lambda: clock[0])
    lines = Progress("scenes", 2000)
    lines.told("scenes", 1000)
    clock[0] = 10.0
    lines.told("scenes", 1100)
    # Of the 1,000 that were there before none took any time.
    assert lines.line() == "after 10 s: scenes, 1,100 of 2,000 done, 90 s left"
    lines.told("scenes", 2000)
    assert lines.line() == "after 10 s: scenes, 2,000 of 2,000 done"
