"""Tasks of growth whose cost, memory or end is known."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from validate.cost.row import QuantityError
from validate.cost.way import LeftOut


class FakeClock:
    """Nanoseconds that pass only when something is worked at."""

    def __init__(self) -> None:
        self.now = 0

    def __call__(self) -> int:
        return self.now

    def work(self, seconds: float) -> None:
        self.now += round(1e9 * seconds)


@dataclass(frozen=True)
class Planted:
    """Takes fixed + each size^exponent seconds, in shares of 1, 6, 2 and 1 tenths for the four phases."""

    clock: FakeClock
    size: int
    each: float = 1e-3
    exponent: float = 1.0
    fixed: float = 0.0
    given: float = 0.0
    runs: list[int] = field(default_factory=list)

    @property
    def smallest(self) -> Planted:
        return replace(self, size=1)

    def give(self) -> None:
        self.clock.work(self.given)

    def prepare(self) -> Planted:
        self.runs.append(self.size)
        self._pass(0.1)
        return self

    def solve(self) -> str:
        self._pass(0.6)
        return "solved"

    def rates(self, solved: str) -> str:
        self._pass(0.2)
        return solved

    def output(self, solved: str) -> str:
        self._pass(0.1)
        return solved

    def counts(self, solved: str) -> Mapping[str, int]:
        return {"runs": len(self.runs)}

    def check(self, output: str) -> Mapping[str, QuantityError]:
        assert output == "solved"
        return {}

    def _pass(self, share: float) -> None:
        self.clock.work(share * (self.fixed + self.each * self.size**self.exponent))


@dataclass(frozen=True)
class Ends:
    """A task in a process that ends as it is told when it is solved.

    At its smallest size it only takes memory and gives it back, as imports do.
    """

    how: str
    bytes: int = 0
    loading: int = 0
    smallest_one: bool = False

    @property
    def smallest(self) -> Ends:
        return replace(self, smallest_one=True)

    def give(self) -> None:
        pass

    def prepare(self) -> Ends:
        return self

    def solve(self) -> int:
        if self.smallest_one:
            return int(np.ones(self.loading // 8).sum())
        match self.how:
            case "killed":
                os.kill(os.getpid(), signal.SIGKILL)
            case "exits":
                os._exit(3)
            case "raises":
                raise ZeroDivisionError("a pivot is zero")
            case "does not apply":
                raise LeftOut("only struts")
            case "never ends":
                time.sleep(1000.0)
            case "prints":
                print("a library says hello")
                os.system("echo so does another")
            case "takes and gives back":
                return int(np.ones(self.bytes // 8)[-1])
        return 1

    def rates(self, solved: int) -> int:
        return solved

    def output(self, solved: int) -> int:
        return solved

    def counts(self, solved: int) -> Mapping[str, int]:
        return {"solved": solved}

    def check(self, output: Any) -> Mapping[str, QuantityError]:
        return {"position": QuantityError(1e-9, 5e-10, 1e-20, 3)}
