r"""Rates by finite differences of positions, as one takes them who has a program that gives positions only.

    v(t) = (x(m + h) - x(m - h)) / 2h + (t - m) a(t),    a(t) = (x(m + h) - 2 x(m) + x(m - h)) / h^2

with the step h and m = t, but h away from an end of the time where t is nearer. They are off by h^2 x'''/6
and h^2 x''''/12, by h x''' near the ends, and by rounding of x over h and over h^2. How a body turns is told
from its points' rates as the library tells it. The setting is h in parts of the scene's time.
"""

from __future__ import annotations

from functools import partial

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene
from pointcoord.effects.plan import plan_effects
from pointcoord.method import NEWTON, SERIES, Method
from validate.cost.way import Answer, LeftOut, Solve, Way
from validate.cost.ways.point_coordinates import motion_at, numbers_of, task_of, work_of

Array = NDArray[np.float64]

TOLERANCE = 1e-13  # mm: finer only rounds


def by_differences(method: Method, scene: Scene, share: float) -> Solve:
    """Positions by a method, solved at the instants and a step on both sides, and their differences."""
    time = scene.time
    step = share * (time.stop - time.start)
    if plan_effects(scene.effects).derivative == 0:
        raise LeftOut("the scene asks for no rates")
    if step == 0.0:
        raise LeftOut("the scene is one instant, which has no others beside it")
    task = task_of(scene.model_copy(update={"effects": ()}), method, TOLERANCE)
    readout = task_of(scene, method, TOLERANCE).readout

    def solve(instants: Array) -> Answer:
        middle = np.clip(instants, time.start + step, time.stop - step)
        times = np.unique(np.concatenate([middle - step, middle, middle + step, instants]))
        motion = motion_at(task, times)
        places = motion.solved.states(motion.times)[0]
        here, before, at, after = (
            np.searchsorted(motion.times, t) for t in (instants, middle - step, middle, middle + step)
        )
        states: list[dict[str, Array]] = [{}, {}, {}]
        for name, x in places.items():
            bend = (x[after] - 2.0 * x[at] + x[before]) / step**2
            states[0][name], states[2][name] = x[here], bend
            states[1][name] = (x[after] - x[before]) / (2.0 * step) + (instants - middle)[:, None] * bend
        return Answer(numbers_of(readout.samples(instants, states), len(instants)), work_of(motion.work))

    return solve


WAYS = tuple(
    Way(
        f"{method.name}-differences",
        f"positions of {method.name}, and rates by differences of them",
        partial(by_differences, method),
        values=(1e-2, 1e-3, 1e-4, 1e-5, 1e-6),
        setting="step {}",
        dense=method.dense,
        rates_only=True,
    )
    for method in (SERIES, NEWTON)
)
