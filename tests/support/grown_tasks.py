"""Work that grows, whose cost, memory or end is known."""

from __future__ import annotations

import os
import signal
import time

import numpy as np

from validate.cost.race import Runner
from validate.cost.table import Row
from validate.cost.way import LeftOut

LEAST = 1
_LOADED: list[bool] = []


def ending(how: str, taken: int, loading: int, row: Row, size: int) -> Runner:
    """Work that ends its process as it is told; its first run takes memory and gives it back, as imports do.

    Args:
        taken, loading: bytes, of the work and of a process's first.
    """
    position = {"error": 1e-9, "rms": 5e-10, "radius": 1e-20, "numbers": 3}

    def solve() -> int:
        if not _LOADED:
            _LOADED.append(True)
            loaded = int(np.ones(loading // 8).sum())
            if size == LEAST:
                return loaded
        match how:
            case "killed":
                os.kill(os.getpid(), signal.SIGKILL)
            case "exits":
                os._exit(3)
            case "does not apply":
                raise LeftOut("only struts")
            case "never ends":
                time.sleep(1000.0)
            case "prints":
                print("a library says hello")
                os.system("echo so does another")
            case "takes and gives back":
                return int(np.ones(taken // 8)[-1])
        return 1

    return Runner(row, lambda: solve, lambda answer: {"position": position})
