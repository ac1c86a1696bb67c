"""How far a run is, and how long the rest takes at its pace; in a pipe a line a minute, if asked for."""

import pytest

from validate.output import progress
from validate.output.console import Console
from validate.output.progress import Progress


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """What time it is, in seconds."""
    now = [0.0]
    monkeypatch.setattr(progress.time, "monotonic", lambda: now[0])
    return now


def test_the_rest_is_told_at_the_pace_since_this_run_began(clock: list[float]) -> None:
    said: list[str] = []
    told = Progress(lambda what, done, of: said.append(what), pause=1.0)
    told("scenes", 1000, 2000)
    clock[0] = 10.0
    told("scenes", 1100, 2000)
    clock[0] = 10.5
    told("scenes", 1101, 2000)  # too soon after the one before
    clock[0] = 20.0
    told("scenes", 2000, 2000)
    # Of the 1,000 that were there before none took any time.
    assert said == ["1,000 of 2,000: scenes", "1,100 of 2,000, 90 s left: scenes", "2,000 of 2,000: scenes"]


def test_a_pipe_gets_a_line_a_minute_where_it_is_asked_for(
    clock: list[float], capsys: pytest.CaptureFixture[str]
) -> None:
    for lines in (False, True):
        clock[0] = 0.0
        with progress.progress(Console(), "processes start", lines) as told:
            for second in range(0, 150, 10):
                clock[0] = float(second)
                told("scenes", second, 150)
        err = capsys.readouterr().err
        expected = [
            "pointcoord: note: 60 of 150, 90 s left: scenes",
            "pointcoord: note: 120 of 150, 30 s left: scenes",
        ]
        assert err.splitlines() == (expected if lines else [])
