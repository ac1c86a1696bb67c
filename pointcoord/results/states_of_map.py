"""States of points from patches along the way of the inputs, at any instants that these cover."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from math import factorial

import numpy as np
from numpy.typing import NDArray

from pointcoord.bounds.solved_coordinates import Summed
from pointcoord.errors import OutsideMotion
from pointcoord.numerics.counters import Work
from pointcoord.numerics.multi_index import powers
from pointcoord.patches.evaluation import sum_series
from pointcoord.patches.patches import ProvenPatches
from pointcoord.patches.reported_points import moving_points
from pointcoord.patches.way_map import WayMap
from pointcoord.results.readout import Readout
from pointcoord.results.table import vectors
from pointcoord.solve.status import Status
from pointcoord.time_functions import TimeFunction

Array = NDArray[np.float64]


@dataclass(frozen=True)
class StatesOfMap:
    """States composed of patches and the laws of the inputs (see `patches.evaluation`).

    Attributes:
        functions: the laws of the inputs that drive the linkage.
        way: the patches.
        start: of the motion, s.
        status: whether it covers all of the way, and if not, what stopped it.
        notes: where it was not solved as the scene asks.
    """

    readout: Readout
    functions: Mapping[str, TimeFunction]
    way: WayMap
    start: float
    status: Status
    notes: tuple[str, ...] = ()
    dense: bool = True

    @property
    def orders(self) -> tuple[int, ...]:
        """Of each patch."""
        return (self.patches.order,) * len(self.patches.low)

    @property
    def patches(self) -> ProvenPatches:
        """Those along the way."""
        return self.way.patches

    @property
    def stop(self) -> float:
        """The end of the part of the way that patches cover."""
        return self.way.until

    def covered(self, instants: Array) -> Array:
        """Those on the part of the way that patches cover."""
        return instants[instants <= self.way.until]

    def states(self, instants: Array, rows: Array | None = None) -> list[dict[str, Array]]:
        """States at instants of shape (N,).

        Raises:
            OutsideMotion: an instant outside the motion, or not a number.
        """
        outside = ~((instants >= self.start) & (instants <= self.way.until))
        if outside.any():
            raise OutsideMotion(float(instants[outside][0]), self.start, self.way.until)
        readout, table = self.readout, self.readout.table
        topology, drawn = readout.mechanism.topology, readout.mechanism.drawing.vectors
        if rows is None:
            rows = np.empty((table.height, len(instants)))
        inputs = self._inputs(instants)
        wanted, tables = self._tables
        sums = self.patches.sums(tables, inputs)
        states: list[dict[str, Array]] = [{} for _ in inputs]
        for order, names in enumerate(wanted):
            for i, name in enumerate(names):
                states[order][name] = vectors(sums[order], 3 * i)
        unit = float(readout.mechanism.unit)
        still = {name: drawn[name] * unit for name in topology.chassis}
        for first, (order, name) in table.states:
            seen = vectors(rows, first)
            if name in still:
                seen[...] = still[name] if order == 0 else 0.0
            else:
                seen[...] = states[order][name]
            states[order][name] = seen
        for order, name in table.spare_still:
            standing = still[name] if order == 0 else np.zeros(3)
            states[order][name] = np.broadcast_to(standing, (len(instants), 3))
        return states

    def coordinates(self, instants: Array, derivatives: int) -> list[Array]:
        """y and the derivatives that the plan solves for, at instants, each of shape (N, size)."""
        mechanism = self.readout.mechanism
        inputs = self._inputs(instants)[: derivatives + 1]
        unknown = self.patches.sums([self.patches.series] * len(inputs), inputs)
        laws = {name: f.series(instants, len(unknown) - 1) for name, f in self.functions.items()}
        known = mechanism.known_series(laws)
        return [
            np.concatenate([state.T, factorial(d) * known[:, d]], axis=-1) for d, state in enumerate(unknown)
        ]

    def summed(self, instants: Array) -> list[Summed]:
        """How `coordinates` sums each derivative at instants."""
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
            """Of the terms of some degrees."""
            kept = terms * ((degree >= least) & (degree <= most))[:, None]
            found = sum_series([kept] * len(sizes), unit_boxes, order, patch, sizes)
            return [np.pad(state.T, ((0, 0), (0, known))) for state in found]

        parts = (sums(order - 1, order), sums(order - 3, order - 2), sums(0, order))
        return [Summed(*part) for part in zip(*parts, strict=True)]

    def pieces(self, instants: Array) -> NDArray[np.intp]:
        """Number of the patch of each instant."""
        return self.patches.lookup.at(self._inputs(instants)[0])

    def unsolved(self, instants: Array) -> Array:
        """Nothing: middles of patches are solved for as finely as rounding allows."""
        return np.zeros(len(instants))

    @property
    def work(self) -> Work:
        """What making the patches took, and the sums of each instant."""
        table = self.readout.table
        return self.way.work + Work(
            segments=len(self.orders),
            series_orders=sum(self.orders),
            derivatives_evaluated=self.readout.plan.derivative + 1,
            coordinates_evaluated=3 * (len(table.moving) + len(table.spare)),
        )

    def _inputs(self, instants: Array) -> list[Array]:
        """The free inputs and as many derivatives as are wanted, each (N, p)."""
        highest = self.readout.plan.derivative
        laws = [self.functions[name].series(instants, highest) for name in self.patches.domain.free]
        return [factorial(d) * np.stack([law[:, d] for law in laws], axis=-1) for d in range(highest + 1)]

    @cached_property
    def _tables(self) -> tuple[list[list[str]], list[Array]]:
        """By derivative, the points that are wanted, and their coefficients, (P, powers, 3 points), mm."""
        table, place = self.readout.table, moving_points(self.readout.mechanism.topology)
        wanted = [
            [name for d, name in (*table.moving, *table.spare) if d == order]
            for order in range(self.readout.plan.derivative + 1)
        ]
        columns = [[3 * place.index(name) + axis for name in names for axis in range(3)] for names in wanted]
        return wanted, [np.ascontiguousarray(self.patches.coefficients[..., c]) for c in columns]
