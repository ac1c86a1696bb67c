"""Tasks of growth whose cost, memory or end is known."""

from __future__ import annotations

import os
import signal
import time
from dataclasses import dataclass, replace

import numpy as np

from validate.cost.race import Found, LeftOut, Runner
from validate.cost.row import Row


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

    def runner(self, row: Row) -> Runner:
        position = {"error": 1e-9, "rms": 5e-10, "radius": 1e-20, "numbers": 3}
        return Runner(row, lambda: self.solve, lambda answer: Found({"position": position}))

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
