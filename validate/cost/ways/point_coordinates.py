"""The methods of pointcoord. The timed work is that of `simulate`, without the proofs that a caller can ask
for.

The set-up reads, checks and closes the drawing, and assembles the start. For the map method the set-up
includes making the map, which serves any law of the inputs; other methods solve after the instants are known.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

from pointcoord import Scene
from pointcoord.method import CHORD, MAP, NEWTON, NEWTON_COLD, SERIES, Method
from pointcoord.results.motion import read
from pointcoord.results.samples import Samples
from pointcoord.simulation import Task, prepare_task, solve_by_map, solve_task
from validate.arrays import Array
from validate.cost.way import Solve, Way
from validate.formulations.protocol import Numbers


def task_of(scene: Scene, method: Method, tolerance: float) -> Task:
    """A scene prepared for a method, with a tolerance of positions, mm.

    Raises:
        PointcoordError: pointcoord refuses the scene.
    """
    return prepare_task(scene.model_copy(update={"tolerance": tolerance}), method)


def by_method(method: Method, scene: Scene, tolerance: float) -> Solve:
    """Solve by a method of `simulate`, or by one with the same interface; it begins at the scene's start."""
    task = task_of(scene, method, tolerance)

    def solve(instants: Array) -> Numbers:
        start = [scene.time.start] if instants[0] > scene.time.start else []
        motion = solve_task(replace(task, instants=np.concatenate([start, instants])))
        return numbers_of(motion, len(instants))

    return solve


def by_map(scene: Scene, tolerance: float) -> Solve:
    """Solve by a map of the inputs along their path."""
    solved = solve_by_map(task_of(scene, MAP, tolerance))
    error = solved.status.error(None)
    if error is not None:
        raise error
    return lambda instants: numbers_of(read(solved, instants), len(instants))


def numbers_of(samples: Samples, last: int) -> Numbers:
    """The computed numbers at the `last` last instants."""
    return {
        quantity: {name: array[-last:] for name, array in channel.items()}
        for quantity, channel in samples.numbers.items()
        if channel.computed
    }


WAYS = (
    Way("series", "point coordinates, by power series in time", partial(by_method, SERIES), dense=True),
    Way("map", "point coordinates, by series in the inputs on patches, made beforehand", by_map, dense=True),
    *(
        Way(method.name, f"point coordinates, by Newton's method {words}", partial(by_method, method))
        for method, words in (
            (NEWTON, "from the instant before"),
            (NEWTON_COLD, "from the drawing, each instant by itself"),
            (CHORD, "with one factorisation kept"),
        )
    ),
)
