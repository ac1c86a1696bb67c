"""A point of growth in a process of its own: what comes back, how it may die, and whose memory is counted."""

import os
from pathlib import Path

import grown_tasks
import numpy as np
import pytest
from grown_tasks import Ends, FakeClock, Planted

from validate.cost.growth import child
from validate.cost.growth.child import Limits, measure_apart
from validate.cost.growth.task import measure
from validate.cost.growth.unknowns import LongChain
from validate.cost.row import QuantityError
from validate.cost.stopwatch import LEAST_REPEATS

MB = 2**20
LIMITS = Limits(seconds=0.5)


@pytest.fixture(autouse=True)
def _tasks_can_be_found(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", str(Path(grown_tasks.__file__).parent))


def test_what_a_library_prints_does_not_spoil_the_answer() -> None:
    found = measure_apart(Ends("prints"), LIMITS)
    assert (found.status, found.reason) == ("measured", "")
    assert found.counts == {"solved": 1}
    assert found.errors == {"position": QuantityError(1e-9, 5e-10, 1e-20, 3)}
    assert set(found.times) == {"set-up", "solve", "rates", "output"}


@pytest.mark.parametrize(
    ("how", "status", "words"),
    [
        ("killed", "failed", "its process was ended by the signal SIGKILL, as a system out of memory does"),
        ("exits", "failed", "its process ended with status 3 and no answer"),
        ("raises", "failed", "ZeroDivisionError: a pivot is zero"),
        ("does not apply", "left out", "only struts"),
    ],
)
def test_a_process_that_dies_is_a_failure_with_its_reason(how: str, status: str, words: str) -> None:
    found = measure_apart(Ends(how), LIMITS)
    assert (found.status, found.reason) == (status, words)
    assert not found.times
    assert found.peak_bytes is None


def test_a_process_that_never_ends_is_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(child, "GRACE", 1.0)
    found = measure_apart(Ends("never ends"), Limits(seconds=0.1))
    assert (found.status, found.reason) == ("failed", "was ended after 2 s")


def test_more_memory_than_allowed_is_a_failure_and_not_the_end_of_the_machine() -> None:
    found = measure_apart(Ends("takes and gives back", bytes=600 * MB), Limits(0.5, memory=256 * MB))
    assert (found.status, found.reason) == ("failed", "needs more memory than the 0.25 GiB allowed")


def test_peak_memory_is_the_points_own_and_not_of_those_who_started_it() -> None:
    ballast = np.ones(300 * MB // 8)
    taken = measure_apart(Ends("takes and gives back", bytes=100 * MB), LIMITS).peak_bytes
    nothing = measure_apart(Ends("prints"), LIMITS).peak_bytes
    assert ballast[-1] == 1.0
    # What loading gave back is used again, and Python keeps some pages beside: a MB or two.
    assert taken is not None
    assert nothing is not None
    assert 98 * MB <= taken <= 104 * MB
    assert nothing <= 4 * MB


def test_what_loading_took_and_gave_back_does_not_hide_what_a_point_takes() -> None:
    task = Ends("takes and gives back", bytes=50 * MB, loading=200 * MB)
    taken = measure_apart(task, LIMITS).peak_bytes
    assert taken is not None
    assert 48 * MB <= taken <= 54 * MB


def test_one_thread_is_used_and_the_environment_stays() -> None:
    before = dict(os.environ)
    found = measure_apart(LongChain("newton", 15), Limits(seconds=100.0))
    assert found.status == "measured", found.reason
    assert found.errors["position"].largest < 1e-10
    assert found.times["solve"].repeats == LEAST_REPEATS
    assert dict(os.environ) == before


@pytest.mark.parametrize(
    ("takes", "seconds", "repeats", "runs"),
    [(0.1, 20.0, LEAST_REPEATS, 8), (3.9, 20.0, 5, 6), (15.0, 20.0, 1, 1)],
)
def test_repeats_are_as_many_as_the_time_allows(
    takes: float, seconds: float, repeats: int, runs: int
) -> None:
    clock = FakeClock()
    task = Planted(clock, 1, each=takes, given=100.0)
    found = measure(task, seconds, clock)
    assert found.times["solve"].repeats == repeats
    # One for loading, before the others.
    assert len(task.runs) == runs + 1
    for phase, share in (("set-up", 0.1), ("solve", 0.6), ("rates", 0.2), ("output", 0.1)):
        assert found.times[phase].median == pytest.approx(share * takes)


def test_a_quick_task_is_repeated_within_a_sample() -> None:
    clock = FakeClock()
    task = Planted(clock, 1, each=1e-3)
    found = measure(task, 20.0, clock)
    assert found.times["solve"].repeats == LEAST_REPEATS
    assert found.times["solve"].median == pytest.approx(6e-4)
    assert len(task.runs) == 2 + 10 * LEAST_REPEATS
