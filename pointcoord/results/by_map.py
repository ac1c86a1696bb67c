"""A scene that is solved by a map of its inputs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import factorial

import numpy as np

from pointcoord.bounds.summed import Summed
from pointcoord.errors import InputOutOfRange
from pointcoord.numerics.arrays import Array
from pointcoord.numerics.counters import Work
from pointcoord.numerics.multi_index import powers
from pointcoord.patches.evaluation import sum_series
from pointcoord.patches.patches import ProvenPatches
from pointcoord.patches.way_map import WayMap
from pointcoord.results.readout import Readout
from pointcoord.results.solved_scene import SolvedScene
from pointcoord.solve.status import COMPLETE
from pointcoord.time_functions import TimeFunction


@dataclass(frozen=True, eq=False)
class ByMap(SolvedScene):
    """Patches along the path of the inputs, composed with the inputs' laws (see `patches.evaluation`).

    Attributes:
        way: the patches along the path; `stop` is the instant up to which they cover the path.
    """

    way: WayMap

    @classmethod
    def of(
        cls,
        readout: Readout,
        functions: Mapping[str, TimeFunction],
        way: WayMap,
        start: float,
        notes: tuple[str, ...],
    ) -> ByMap:
        """The solved scene from `start`, s, with the status complete."""
        orders = (way.patches.order,) * len(way.patches.low)
        work = way.work + Work(segments=len(orders), series_orders=sum(orders))
        return cls(readout, functions, COMPLETE, work, start, way.until, orders, way, notes=notes)

    @property
    def patches(self) -> ProvenPatches:
        return self.way.patches

    def solved(self, instants: Array, derivatives: int) -> Sequence[Array]:
        """Sums of the patches' series, composed with the laws (see `SolvedScene.solved`)."""
        inputs = self._inputs(instants)[: derivatives + 1]
        return self.patches.sums(self.patches.series, inputs)

    def summed(self, instants: Array) -> list[Summed]:
        inputs = self._inputs(instants)
        patch = self.patches.lookup.at(inputs[0])
        middle, half = self.patches.boxes
        sizes = [
            np.abs(state - (middle[patch] if d == 0 else 0.0)) / half[patch] for d, state in enumerate(inputs)
        ]
        order, free = self.patches.order, len(self.patches.domain.free)
        degree = powers(free, order).exponents.sum(axis=-1)
        terms, unit_boxes = np.abs(self.patches.series), (np.zeros_like(middle), np.ones_like(half))
        known = len(self.readout.mechanism.drawn) - terms.shape[-1]

        def sums(least: int, most: int) -> list[Array]:
            """Sums of the magnitudes of all terms of the degrees from `least` to `most`."""
            kept = terms * ((degree >= least) & (degree <= most))[:, None]
            found = sum_series(kept, unit_boxes, order, patch, sizes)
            return [np.pad(state.T, ((0, 0), (0, known))) for state in found]

        parts = (sums(order - 1, order), sums(order - 3, order - 2), sums(0, order))
        return [Summed(*part) for part in zip(*parts, strict=True)]

    def _inputs(self, instants: Array) -> list[Array]:
        """The free inputs and their derivatives up to the plan's highest, each (N, p).

        Raises:
            InputOutOfRange: a value or a derivative overflows.
        """
        highest = self.readout.plan.derivative
        laws = [self.functions[name].series(instants, highest) for name in self.patches.domain.free]
        for name, law in zip(self.patches.domain.free, laws, strict=True):
            if not np.isfinite(law).all():
                worst = float(law[~np.isfinite(law)][0])
                raise InputOutOfRange(name, worst, "finite values and rates of every order")
        return [factorial(d) * np.stack([law[:, d] for law in laws], axis=-1) for d in range(highest + 1)]
