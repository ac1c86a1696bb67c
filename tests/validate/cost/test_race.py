"""A race measures what it says it does: on a fake clock, of runs whose errors and times are known."""

from __future__ import annotations

import gc
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import pytest
from threadpoolctl import threadpool_info, threadpool_limits

from validate.cost.race import FULL, QUICK, Effort, Found, Runner, absent, race
from validate.cost.table import Row


@dataclass
class FakeClock:
    """A clock that stands still but for those who move it; nanoseconds."""

    now: int = 0

    def __call__(self) -> int:
        return self.now

    def advance(self, nanoseconds: int) -> None:
        self.now += nanoseconds


@dataclass
class Toy:
    """Something to be timed: takes what `costs` says for each phase, ns, and is off by `error`.

    Attributes:
        before: is called with the name of each phase. runs: how often it was run.
    """

    name: str
    clock: FakeClock = field(default_factory=FakeClock)
    costs: Mapping[str, int] = field(default_factory=lambda: {"set-up": 20_000_000, "solve": 5_000_000})
    error: float = 1e-9
    before: Callable[[str], object] = lambda _: None
    runs: int = 0
    collecting: bool = False

    @property
    def runner(self) -> Runner:
        """As a race takes it; a run gives ten poses."""
        return Runner(Row("scene", self.name, poses=10), self._set_up, self._found)

    def _spend(self, phase: str) -> None:
        self.before(phase)
        self.collecting |= gc.isenabled()
        self.clock.advance(self.costs.get(phase, 0))

    def _set_up(self) -> Callable[[], str]:
        self._spend("set-up")
        return self._solve

    def _solve(self) -> str:
        self.runs += 1
        self._spend("solve")
        return "solved"

    def _found(self, answer: Any) -> Found:
        assert answer == "solved"
        self.clock.advance(10**12)  # looking at an answer is no part of it
        position = {"error": self.error, "radius": 0.0}
        return {"position": position, "wheel": absent("left out", "gives no angles")}


def raced(*toys: Toy, effort: Effort = FULL) -> list[Row]:
    """The rows of positions."""
    rows = race([toy.runner for toy in toys], effort, clock=toys[0].clock)
    return [row for row in rows if row.quantity != "wheel"]


def test_set_up_and_solving_have_the_times_that_they_take() -> None:
    position, wheel = race([(toy := Toy("toy")).runner], FULL, clock=toy.clock)
    assert position.set_up == pytest.approx(20e-3, rel=1e-12)
    assert (position.lower, position.time, position.upper) == pytest.approx((5e-4,) * 3, rel=1e-12)
    assert position.repeats == FULL.repeats >= QUICK.repeats
    assert position.error == 1e-9
    # What is not given is said, and has no error of zero.
    assert (wheel.quantity, wheel.verdict, wheel.reason) == ("wheel", "left out", "gives no angles")
    assert (wheel.error, wheel.time, wheel.poses) == (None, None, 0)


def test_whatever_it_was_started_with_a_run_has_one_thread() -> None:
    with threadpool_limits(limits=2):
        before = {pool["num_threads"] for pool in threadpool_info()}
        seen: list[int] = []
        raced(Toy("toy", before=lambda _: seen.extend(pool["num_threads"] for pool in threadpool_info())))
        assert {pool["num_threads"] for pool in threadpool_info()} == before
    assert set(seen) == {1}


def test_a_quick_run_is_repeated_until_a_sample_lasts_and_a_collector_never_runs() -> None:
    toy = Toy("toy", costs={"solve": 1_000_000})
    raced(toy)
    # The first, the one that warms up, and samples of 20 ms.
    assert toy.runs == 2 + FULL.repeats * 20
    assert not toy.collecting


@pytest.mark.parametrize(("seconds", "repeats", "runs"), [(3.0, 6, 8), (11.0, 1, 1)])
def test_repeats_are_as_many_as_the_time_allows(seconds: float, repeats: int, runs: int) -> None:
    toy = Toy("slow", costs={"solve": int(seconds * 1e9)})
    [row] = raced(toy)
    assert (row.repeats, toy.runs) == (repeats, runs)
    assert row.time == pytest.approx(seconds / 10)


def test_runs_take_turns_in_another_order_each_round() -> None:
    log: list[str] = []
    clock = FakeClock()
    toys = [Toy(name, clock, {"solve": 10**8}) for name in "abcde"]
    for toy in toys:
        toy.before = lambda phase, name=toy.name: log.append(name) if phase == "solve" else None
    raced(*toys)
    turns = log[2 * len(toys) :]
    rounds = [tuple(turns[i : i + 5]) for i in range(0, len(turns), 5)]
    assert len(rounds) == FULL.repeats
    assert all(sorted(order) == list("abcde") for order in rounds)
    assert len(set(rounds)) > FULL.repeats // 2


@pytest.mark.parametrize(("phase", "run"), [("set-up", 1), ("solve", 5)])
def test_what_breaks_down_in_any_run_has_a_failed_row_and_no_time(phase: str, run: int) -> None:
    seen: Counter[str] = Counter()

    def before(now: str) -> None:
        seen[now] += 1
        if now == phase and seen[now] == run:
            raise ZeroDivisionError("by\nnothing")

    toy = Toy("toy", costs={"set-up": 10**8}, before=before)
    row, fine = raced(toy, Toy("other", toy.clock), effort=QUICK)
    assert (row.verdict, row.reason) == ("failed", "ZeroDivisionError: by nothing")
    assert (row.time, row.error, row.poses) == (None, None, 0)
    assert fine.verdict == "measured"
