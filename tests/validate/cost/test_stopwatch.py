"""Times are what the clock says of each phase, in any order, also if the machine is busy for a while."""

import gc
import statistics

import pytest
from toy_ways import FakeClock

from validate.cost.stopwatch import (
    MOST_LOOPS,
    Job,
    Laps,
    interleaved,
    loops_for,
    round_order,
    sample,
    time_of,
    times_of,
)


def job(clock: FakeClock, **costs: int) -> Job:
    def run(laps: Laps) -> None:
        for phase, cost in costs.items():
            clock.advance(cost)
            laps.lap(phase)
        clock.advance(10**9)  # what is done after the last lap is in no phase

    return run


def test_each_phase_is_timed_by_itself_and_what_lies_between_runs_is_in_none() -> None:
    clock = FakeClock()
    seconds = sample(job(clock, one=2_000, two=30_000), loops=5, clock=clock)
    assert seconds == pytest.approx({"one": 2e-6, "two": 3e-5}, rel=1e-12)


def test_a_phase_that_comes_twice_in_a_run_is_summed() -> None:
    clock = FakeClock()

    def run(laps: Laps) -> None:
        for cost, phase in ((1, "a"), (10, "b"), (100, "a")):
            clock.advance(cost)
            laps.lap(phase)

    assert sample(run, clock=clock) == pytest.approx({"a": 101e-9, "b": 10e-9}, rel=1e-12)


def test_a_quick_job_is_repeated_until_a_sample_lasts() -> None:
    assert loops_for(1e-3, least=0.02) == 20
    assert loops_for(0.3e-3, least=0.02) == 67
    assert loops_for(5.0, least=0.02) == 1
    assert loops_for(0.0, least=0.02) == MOST_LOOPS


def test_quartiles_lie_where_a_quarter_of_the_samples_is_below_and_above() -> None:
    times = time_of([5.0, 1.0, 2.0, 4.0, 3.0])
    assert (times.lower, times.median, times.upper, times.repeats) == (2.0, 3.0, 4.0, 5)
    samples = [0.3, 0.1, 0.7, 0.2, 0.9, 0.4, 0.8, 0.6]
    lower, median, upper = statistics.quantiles(samples, method="inclusive")
    assert time_of(samples).median == pytest.approx(median, rel=1e-15)
    assert (time_of(samples).lower, time_of(samples).upper) == pytest.approx((lower, upper), rel=1e-15)


def test_the_median_does_not_mind_one_sample_that_was_disturbed() -> None:
    assert time_of([1.0] * 6 + [100.0]).median == 1.0
    assert times_of([{"a": 1.0, "b": 2.0}] * 6 + [{"a": 50.0, "b": 2.0}])["a"].upper == 1.0


def test_every_job_runs_once_in_each_round_and_the_order_changes_but_not_between_runs_of_the_study() -> None:
    clock = FakeClock()
    jobs = {name: job(clock, work=10) for name in "abcdefgh"}
    ran = [(number, name) for number, name, _ in interleaved(jobs, dict.fromkeys(jobs, 1), 7, clock)]
    rounds = [[name for number, name in ran if number == wanted] for wanted in range(7)]
    assert [number for number, _ in ran] == sorted(number for number, _ in ran)
    assert all(sorted(order) == sorted(jobs) for order in rounds)
    assert len({tuple(order) for order in rounds}) == 7
    assert rounds == [round_order(list(jobs), number) for number in range(7)]


def test_a_machine_that_is_busy_for_a_while_hurts_all_jobs_alike() -> None:
    clock, runs = FakeClock(), iter(range(90))

    def slowed(laps: Laps) -> None:
        # During the third and the fourth round of ten jobs everything takes nine times as long.
        clock.advance(9_000 if 20 <= next(runs) < 40 else 1_000)
        laps.lap("work")

    jobs = dict.fromkeys("abcdefghij", slowed)
    found: dict[str, list[float]] = {}
    for _, name, seconds in interleaved(jobs, dict.fromkeys(jobs, 1), 9, clock):
        found.setdefault(name, []).append(seconds["work"])
    for samples in found.values():
        assert time_of(samples).median == pytest.approx(1e-6)
        assert sum(samples) == pytest.approx((7 + 2 * 9) * 1e-6)


def test_nothing_is_collected_while_a_job_runs_and_the_collector_is_as_it_was_before() -> None:
    seen: list[bool] = []
    assert gc.isenabled()
    sample(lambda laps: seen.append(gc.isenabled()), loops=2)
    assert seen == [False, False]
    assert gc.isenabled()
    with pytest.raises(ZeroDivisionError):
        sample(lambda laps: 1 // 0)
    assert gc.isenabled()
