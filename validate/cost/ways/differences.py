r"""Rates by finite differences of positions, as one takes them who has a program that gives positions only.

With the step h, at instants inside the time of the scene,

    v(t) = (x(t + h) - x(t - h)) / 2h,        a(t) = (x(t + h) - 2 x(t) + x(t - h)) / h^2,

off by h^2 x'''/6 and h^2 x''''/12, and by rounding of x over h and over h^2. Nearer to an end of the time
than h the parabola through the nearest three such places is taken, whose bend is off by h and not by its
square. How a body turns is told from its points' rates as the library tells it. The setting is h in parts of
the time of the scene.

Positions are as fine as the method gives them: from a chain of series, summed at two more places for each
instant, or from Newton's method, which solves two more poses for each instant.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene
from pointcoord.effects.plan import plan_effects
from pointcoord.effects.registry import EFFECTS
from pointcoord.method import NEWTON, SERIES, Method
from pointcoord.numerics.counters import Work
from pointcoord.results.readout import Readout
from pointcoord.results.states import StatesAtInstants, StatesOfChain
from validate.cost.way import LeftOut, Ready, Setting
from validate.cost.ways.point_coordinates import Parts, Progress, ReadyChain, ReadyInstants, prepared, short
from validate.formulations.protocol import Numbers

Array = NDArray[np.float64]

SHARES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)
TOLERANCE = 1e-13  # mm: finer only rounds


@dataclass(frozen=True)
class ByDifferences:
    """A method's positions, and rates by differences of them.

    Attributes:
        method: that gives positions.
    """

    name: str
    words: str
    method: Method
    settings: tuple[Setting, ...] = tuple(Setting(f"step {short(share)}", share) for share in SHARES)
    package: str | None = None

    @property
    def dense(self) -> bool:
        """As the method."""
        return self.method.by_series

    def prepare(self, scene: Scene, setting: Setting) -> Ready:
        """Assemble the start.

        Raises:
            LeftOut: the scene asks for no rates, or for one instant.
            PointcoordError: the library refuses the scene.
        """
        plan = plan_effects(scene.effects)
        if plan.derivative == 0:
            raise LeftOut("the scene asks for no rates")
        step = (setting.value or 0.0) * (scene.time.stop - scene.time.start)
        if step == 0.0:
            raise LeftOut("the scene is one instant, which has no others beside it")
        still = tuple(name for name in plan.effects if EFFECTS[name].derivative == 0)
        positions = scene.model_copy(update={"effects": still})
        task = prepared(positions, self.method, Setting("", TOLERANCE))
        solver = ReadyChain(task) if self.dense else ReadyInstants(task)
        rates = Parts.of(replace(task.readout, plan=plan)).rates
        return _Ready(solver, rates, step)


@dataclass(frozen=True)
class _Ready:
    """Positions to be found by a method, and the rates that are made of them."""

    solver: ReadyChain | ReadyInstants
    readout: Readout
    step: float

    def solve(self, instants: Array) -> Progress:
        """The method's positions."""
        return self.solver.solve(instants)

    def rates(self, solved: Progress) -> Progress:
        """More positions, and their differences."""
        time, step, instants = self.solver.task.scene.time, self.step, solved.instants
        middle = np.clip(instants, time.start + step, time.stop - step)
        # In this order, so that Newton's method goes forwards; most middles are instants.
        places = np.unique(np.concatenate([middle - step, middle[middle != instants], middle + step]))
        positions, work = self._positions(solved, places)
        states: list[dict[str, Array]] = [dict(solved.places[0]), {}, {}]
        find = {which: np.searchsorted(places, middle + which * step) for which in (-1, 1)}
        centre = np.minimum(np.searchsorted(places, middle), len(places) - 1)
        beside, ahead = (middle != instants)[:, None], (instants - middle)[:, None]
        for name, at in positions.items():
            before, after = at[find[-1]], at[find[1]]
            here = np.where(beside, at[centre], solved.places[0][name])
            bend = (after - 2.0 * here + before) / step**2
            states[1][name] = (after - before) / (2.0 * step) + ahead * bend
            states[2][name] = bend
        found = (*solved.found, self.readout.samples(instants, states))
        return replace(solved, found=found, work=solved.work + work)

    def _positions(self, solved: Progress, places: Array) -> tuple[Mapping[str, Array], Work]:
        """Positions at other instants, and what they took."""
        readout, states = Parts.of(self.solver.task.readout).positions, solved.states
        if isinstance(states, StatesOfChain):
            return replace(states, readout=readout).states(places)[0], Work()
        assert isinstance(self.solver, ReadyInstants)
        found = self.solver.at(places)
        return StatesAtInstants(readout, found).states(places)[0], found.work

    def output(self, solved: Progress) -> Numbers:
        """All arrays."""
        return self.solver.output(solved)

    def counts(self, solved: Progress) -> Mapping[str, int]:
        """The method's."""
        return self.solver.counts(solved)


WAYS = (
    ByDifferences("series-differences", "the series' positions, and rates by differences of them", SERIES),
    ByDifferences("newton-differences", "Newton's positions, and rates by differences of them", NEWTON),
)
