"""How fast the library is, as ratios to other work of the same run; not collected unless this file is named.

    OPENBLAS_NUM_THREADS=1 pytest tests/benchmarks/speed.py -n 0 --benchmark-enable --benchmark-json speed.json

measures every figure at its full size; `SPEED=small` before it does so at a size of some seconds. A yardstick
is timed before each round of what it is compared with, so that a busy machine slows both. `extra_info` of each
benchmark in the JSON file holds the ratio, what it is a ratio of, and what it should be at most. A benchmark
fails only where its ratio is FACTOR times what was reached when it was written down: a machine's noise is less.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from pytest_benchmark.fixture import BenchmarkFixture

import absolute
from pointcoord import Scene, kinematic_map, simulate, solve_poses, sweep
from pointcoord.effects.registry import EFFECTS
from validate.comparison.compare import compare
from validate.cost.growth.unknowns import LongChain
from validate.formulations.registry import formulation
from validate.output.motion_tables import write_csv

Array = NDArray[np.float64]
Work = Callable[[], object]

SMALL = os.environ.get("SPEED") == "small"
FACTOR = 5.0
ROUNDS = 3 if SMALL else 7
MATRICES = np.random.default_rng(1).standard_normal((1000, 15, 15))


def size(full: int, small: int) -> int:
    """How many of something a figure is measured with."""
    return small if SMALL else full


def inverses() -> object:
    """1,000 inverses of 15 x 15: what one LAPACK call a pose would cost 1,000 poses."""
    return np.linalg.inv(MATRICES)


@dataclass(frozen=True)
class Race:
    """Work, and the yardstick that it is compared with.

    Attributes:
        parts: how many times more work the yardstick stands for than it does.
    """

    ours: Work
    yardstick: Work
    parts: float = 1.0


@dataclass(frozen=True)
class Figure:
    """A figure to be held.

    Attributes:
        prepare: makes both ready to be timed.
        goal: the ratio that was aimed at.
        reached: the ratio that was measured when this was written, at the small size.
    """

    name: str
    of: str
    prepare: Callable[[], Race]
    goal: float
    reached: float


def scene_of(name: str, *, effects: tuple[str, ...], samples: int | None = None) -> Scene:
    """A built-in scene with other effects and instants."""
    scene = Scene.load(name)
    timing = scene.time if samples is None else scene.time.model_copy(update={"samples": samples})
    return scene.model_copy(update={"effects": effects, "time": timing})
