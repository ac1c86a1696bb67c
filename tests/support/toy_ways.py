"""Runs whose errors and times are known, and the clock that they move."""

from __future__ import annotations

import gc
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from validate.cost.race import Found, Runner, absent
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
        position = {"error": self.error, "rms": self.error, "radius": 0.0, "numbers": 3, "work": "steps 4"}
        return {"position": position, "wheel": absent("left out", "gives no angles")}
