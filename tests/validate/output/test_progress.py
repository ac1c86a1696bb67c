"""How far a run is, and how long the rest takes at its pace; in a pipe a line now and then."""

import re
import time

import pytest

from validate.output import progress
from validate.output.console import Console
from validate.output.progress import Progress


def test_lines_go_to_standard_error_of_a_pipe_unless_the_run_is_quiet(
    capsys: pytest.CaptureFixture[str],
) -> None:
    console, err = Console(), ""
    # What is done inside is said in the same lines.
    with console.progress("scenes", total=2, first=0.05), console.progress("cost") as told:
        told("series", 60, 150)
        while not err.endswith("\n"):
            time.sleep(0.01)
            out, more = capsys.readouterr()
            err += more
            assert out == ""
    assert re.fullmatch(r"pointcoord: note: after \d+ s: series, 60 of 150 done(, \d+ s left)?\n", err)
    console.quiet = True
    with console.progress("processes start", first=0.05):
        time.sleep(0.3)
    assert capsys.readouterr() == ("", "")


def test_the_rest_is_told_at_the_pace_since_this_run_began(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = [0.0]
    monkeypatch.setattr(progress.time, "monotonic", lambda: clock[0])
    lines = Progress(lambda line: None, "scenes", 2000, first=600.0)
    lines.told("scenes", 1000)
    clock[0] = 10.0
    lines.told("scenes", 1100)
    # Of the 1,000 that were there before none took any time.
    assert lines.line() == "after 10 s: scenes, 1,100 of 2,000 done, 90 s left"
    lines.told("scenes", 2000)
    assert lines.line() == "after 10 s: scenes, 2,000 of 2,000 done"
    lines.end()
