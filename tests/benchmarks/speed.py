"""How fast the library is, as ratios to other work of the same run; not collected unless this file is named.

    OPENBLAS_NUM_THREADS=1 pytest tests/benchmarks/speed.py -n 0 -p benchmark --benchmark-json speed.json

measures every figure at its full size; with SPEED=small before it, at a size of some seconds in all. Before
each round the yardstick is timed that the round is compared with, so that a busy machine slows both. In
the JSON file `extra_info` of each benchmark holds the ratio, what it is a ratio of, and the ratio that is
aimed at. A benchmark fails only where its ratio is FACTOR times the one that was reached when it was written
down: noise is less.
"""

from __future__ import annotations

import io
import math
import os
import subprocess
import sys
import tempfile
import time
import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow
import pyarrow.csv
import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from pointcoord import Scene, kinematic_map, simulate, solve_poses, sweep_blocks
from pointcoord.numerics.arrays import Array
from pointcoord.results.named_columns import number_columns
from validate.cost.scenes import study_instants
from validate.cost.ways.absolute import in_bodies
from validate.cost.ways.registry import ways_named
from validate.output.columns import csv_lines, rows_of_motion

Work = Callable[[], object]

SMALL = os.environ.get("SPEED") == "small"
FACTOR = 5.0
ROUNDS = 3 if SMALL else 7
ALL_EFFECTS = ("velocity", "acceleration", "knuckle_rates", "wheel_angles", "toe", "caster")
BOTH_RATES = ("velocity", "acceleration")
SCENES = Path(__file__).parents[2] / "pointcoord" / "scenes"
SIX = (
    "bounce",
    "bounce-and-steer",
    "bounce-on-a-heaving-chassis",
    "double-wishbone",
    "off-axis-strut",
    "steer",
)
COMPILED = tempfile.TemporaryDirectory(prefix="pointcoord-speed-")
MATRICES = np.random.default_rng(1).standard_normal((1000, 15, 15))


def size(full: int, small: int) -> int:
    """How many of something a figure is measured with."""
    return small if SMALL else full


@dataclass(frozen=True)
class Race:
    """Work, and the yardstick that it is compared with.

    Attributes:
        parts: how many yardsticks the work stands against.
    """

    ours: Work
    yardstick: Work
    parts: float = 1.0


def scene(name: str, effects: tuple[str, ...], samples: int | None = None) -> Scene:
    """A built-in scene with other effects and instants."""
    content: dict[str, Any] = tomllib.loads((SCENES / f"{name}.toml").read_text(encoding="utf-8"))
    content["effects"] = list(effects)
    if samples is not None:
        content["time"]["samples"] = samples
    return Scene.from_mapping(content, name)


def inverses() -> object:
    """1,000 inverses of 15 x 15, about 10 ms: 10 us a pose is what one LAPACK call would cost each."""
    return np.linalg.inv(MATRICES)


def python(*arguments: str, told: str = "") -> None:
    """A fresh interpreter, told something on standard input.

    It finds modules compiled, as Python leaves them after the first run, also where it is told to leave none:
    otherwise most of what is measured is the compiler, and of numpy, which comes compiled, it is not.
    """
    environment = {**os.environ, "PYTHONPYCACHEPREFIX": COMPILED.name}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    subprocess.run(
        [sys.executable, *arguments],
        check=True,
        input=told.encode(),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env=environment,
    )


def dense(effects: tuple[str, ...], name: str = "bounce") -> Race:
    """A motion read at many instants, against a copy of the same bytes."""
    motion = simulate(scene(name, effects))
    instants = np.linspace(0.0, float(motion.times[-1]), size(1_000_000, 100_000))
    out = np.zeros((motion.height, len(instants)))
    copy = np.zeros_like(out)
    return Race(lambda: motion.at(instants, out=out), lambda: np.copyto(copy, out))


def first_answer() -> Race:
    """A scene that is read, to its motion with all effects."""
    asked = scene("bounce", ALL_EFFECTS)
    return Race(lambda: simulate(asked), inverses)


def importing() -> Race:
    """`from pointcoord import Scene, simulate` in a fresh interpreter, against numpy in one."""
    return Race(
        lambda: python("-c", "from pointcoord import Scene, simulate"), lambda: python("-c", "import numpy")
    )


def designs() -> Race:
    """Many designs with both rates at 101 instants each, two inputs moving, in blocks of 256 MB."""
    asked, count = scene("double-wishbone", BOTH_RATES), size(10_000, 500)
    offsets = np.random.default_rng(2).uniform(-5.0, 5.0, (4, count))
    names = ("lower_ball_joint.z", "upper_ball_joint.y", "tie_rod_outer.x", "lower_arm_front.z")
    varied = dict(zip(names, offsets, strict=True))

    def solve() -> object:
        return sum(len(block) for block in sweep_blocks(asked, offsets=varied))

    return Race(solve, inverses, count * len(asked.instants) / 1000)


def pairs(count: int) -> dict[str, Array]:
    """Unrelated inputs."""
    rng = np.random.default_rng(3)
    return {"arm_angle": rng.uniform(1.5, 1.9, count), "rack": rng.uniform(-30.0, 30.0, count)}


def mapped() -> Race:
    """Unrelated inputs through a map, positions."""
    made = kinematic_map(scene("bounce", ()), {"arm_angle": (1.5, 1.9), "rack": (-30.0, 30.0)})
    inputs = pairs(size(1_000_000, 100_000))
    return Race(lambda: made(inputs), inverses, len(inputs["rack"]) / 1000)


def single() -> Race:
    """One pose through a map, as another program's time loop asks for it, 1,000 times."""
    made = kinematic_map(scene("bounce", ()), {"arm_angle": (1.5, 1.9), "rack": (-30.0, 30.0)})
    values = np.stack(list(pairs(1000).values()), axis=-1)
    return Race(lambda: [made.evaluate(value) for value in values], inverses)


def one_by_one() -> Race:
    """Unrelated inputs, each solved and proven."""
    asked, inputs = scene("bounce", ()), pairs(size(1_000_000, 50_000))
    return Race(lambda: solve_poses(asked, inputs, 1e-9), inverses, len(inputs["rack"]) / 1000)


def absolute_model() -> Race:
    """The absolute model with both rates."""
    asked = scene("bounce", BOTH_RATES)
    solve, instants = in_bodies(asked, None), study_instants(asked)
    return Race(lambda: solve(instants), inverses, len(instants) / 1000)


def proofs() -> Race:
    """Bounds of positions at many instants."""
    motion = simulate(scene("bounce-and-steer", ()))
    samples = motion.at(np.linspace(0.0, float(motion.times[-1]), size(1_000_000, 100_000)))
    return Race(lambda: motion.proof_of(samples), inverses, len(samples.times) / 1000)


def proofs_of_effects() -> Race:
    """Bounds of every number at many instants: positions, both rates and all effects."""
    motion = simulate(scene("bounce-and-steer", ALL_EFFECTS))
    samples = motion.at(np.linspace(0.0, float(motion.times[-1]), size(200_000, 20_000)))
    return Race(lambda: motion.proof_of(samples, rates=True), inverses, len(samples.times) / 1000)


def csv() -> Race:
    """A motion as CSV, against pyarrow with the same table."""
    motion = simulate(scene("bounce", BOTH_RATES, size(200_000, 20_000)))
    table = pyarrow.table(dict(number_columns(motion)))
    return Race(
        lambda: "".join(csv_lines(rows_of_motion(motion))), lambda: pyarrow.csv.write_csv(table, io.BytesIO())
    )


LANE = 40.0  # mm
AXIS = 60.0  # mm, between the two points of a rocker's axis
RISE = 150.0  # mm, from the lower line of pivots to the upper one
ROCKERS = (100.0, 80.0)  # mm, of even and of odd number
# The first rocker's angle, rad: about the horizontal, where it is drawn; there the height tells it best.
SWING = {"amplitude": 0.35, "angular_frequency": 2.0 * math.pi, "phase": 0.0, "offset": 0.5 * math.pi}
STOP = 0.25  # s: a quarter of the swing
CHAIN_INSTANTS = np.linspace(0.0, STOP, 6)[1:]
CHAIN_TOLERANCE = 1e-9  # mm


def chain_scene(unknowns: int) -> Scene:
    """A chain of linkages over a quarter of a swing, for its positions alone.

    Rocker j turns about an axis along x in the plane x = 40 j. A rod joins its tip to the next tip, so
    two neighbours and their rod are a planar four-bar. The pivots alternate between two lines, so that every
    second four-bar is the first one backwards: a swing neither dies nor grows along the chain.

    Args:
        unknowns: a multiple of three: the coordinates of the tip of each rocker.
    """
    points, rods = dict[str, list[float]](), dict[str, list[str]]()
    bodies: dict[str, list[str]] = {"chassis": []}
    for j in range(unknowns // 3):
        pivot, names = np.array([LANE * j, 0.0, RISE * (j % 2)]), [f"pivot_{j}", f"axis_{j}", f"tip_{j}"]
        places = pivot + np.array([[0.0, 0.0, 0.0], [AXIS, 0.0, 0.0], [0.0, ROCKERS[j % 2], 0.0]])
        points |= dict(zip(names, places.tolist(), strict=True))
        bodies["chassis"] += names[:2]
        bodies[f"rocker_{j}"] = names
        if j:
            rods[f"rod_{j}"] = [f"tip_{j - 1}", f"tip_{j}"]
    mechanism = {
        "bodies": bodies,
        "rods": rods,
        "inputs": {"arm_angle": {"angle": "rocker_0", "of": "tip_0", "about": "pivot_0", "from": "up"}},
        "side": "right",
        "points": points,
    }
    content = {
        "title": f"chain of {unknowns // 3} rockers",
        "tolerance": CHAIN_TOLERANCE,
        "mechanism": mechanism,
        "inputs": {"arm_angle": {"sine": SWING}},
        "time": {"start": 0.0, "stop": STOP, "samples": 6},
    }
    return Scene.from_mapping(content, "chain of four-bars")


def chain() -> Race:
    """A chain of many unknowns, against one of a tenth: how far from linear growth."""
    (series,) = ways_named(["series"])

    def made_ready(unknowns: int) -> Work:
        scene = chain_scene(unknowns)
        return partial(series.prepare(scene, CHAIN_TOLERANCE), CHAIN_INSTANTS)

    return Race(made_ready(size(1500, 600)), made_ready(size(150, 60)), 10.0)


def comparing() -> Race:
    """`pointcoord validate` of six scenes, from the shell; always the same, however many are built in."""
    return Race(lambda: python("-m", "pointcoord", "validate", *SIX), inverses, 1.0)


def comparing_many() -> Race:
    """`pointcoord validate` of one scene with many instants, from the shell."""
    count = size(40_000, 1_000)
    text = (SCENES / "bounce.toml").read_text(encoding="utf-8")
    asked = text.replace("samples = 131", f"samples = {count}")
    assert asked != text
    return Race(lambda: python("-m", "pointcoord", "validate", "-", told=asked), inverses, count / 1000)


@dataclass(frozen=True)
class Figure:
    """A figure to be held.

    Attributes:
        of: what the ratio is one of.
        goal: the ratio that is aimed at.
        reached: the largest one that was measured when this was written, small or full.
        rounds: how often it is measured.
    """

    name: str
    of: str
    prepare: Callable[[], Race]
    goal: float
    reached: float
    rounds: int = ROUNDS


COPY, INVERSES, INVERSE = "a copy of the same bytes", "1,000 inverses of 15 x 15", "an inverse of 15 x 15"
FIGURES = (
    Figure("dense, both rates", COPY, lambda: dense(BOTH_RATES), 2.0, 3.0),
    Figure("dense, heaving", COPY, lambda: dense(BOTH_RATES, "bounce-on-a-heaving-chassis"), 2.0, 5.4),
    Figure("dense, all effects", COPY, lambda: dense(ALL_EFFECTS), 6.0, 3.0),
    Figure("first answer", INVERSES, first_answer, 0.5, 2.1),
    Figure("import", "numpy's own import", importing, 2.3, 1.5),
    Figure("a configuration of many designs", INVERSE, designs, 0.1, 0.5),
    Figure("a pose through a map", INVERSE, mapped, 0.1, 0.1),
    Figure("a call of a map for one pose", INVERSE, single, 0.3, 1.5),
    Figure("a pose by itself", INVERSE, one_by_one, 0.5, 0.5),
    Figure("a configuration of the absolute model", INVERSE, absolute_model, 8.0, 15.0),
    Figure("a proof of an instant", INVERSE, proofs, 0.3, 0.6),
    Figure("a proof of an instant's rates and effects", INVERSE, proofs_of_effects, 1.5, 2.0),
    Figure("CSV", "pyarrow's CSV of the same table", csv, 3.0, 1.5),
    Figure("a chain of many unknowns", "ten times one of a tenth", chain, 3.0, 2.3),
    Figure("validate, from the shell", INVERSES, comparing, 150.0, 400.0),
    Figure("an instant of validate, from the shell", INVERSE, comparing_many, 10.0, 250.0, rounds=1),
)


@pytest.mark.parametrize("figure", FIGURES, ids=lambda figure: figure.name)
def test_it_is_no_slower_than_five_times_what_was_reached(
    figure: Figure, benchmark: BenchmarkFixture
) -> None:
    race = figure.prepare()
    race.yardstick()
    yardsticks = []

    def measured_beside() -> None:
        begun = time.perf_counter()
        race.yardstick()
        yardsticks.append(time.perf_counter() - begun)

    benchmark.pedantic(race.ours, setup=measured_beside, rounds=figure.rounds, warmup_rounds=1)
    assert benchmark.stats is not None
    ratio = benchmark.stats.stats.median / (float(np.median(yardsticks)) * race.parts)
    benchmark.extra_info.update(ratio=ratio, of=figure.of, goal=figure.goal, reached=figure.reached)
    print(f"\n{figure.name}: {ratio:.3g} times {figure.of}; aimed at {figure.goal:g}")
    assert ratio <= FACTOR * figure.reached
