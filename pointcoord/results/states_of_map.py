"""States of points from patches along the way of the inputs, at any instants that these cover."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from math import factorial

import numpy as np
from numpy.typing import NDArray

from pointcoord.bounds.solved_coordinates import Summed
from pointcoord.data_classes import dataclass
from pointcoord.errors import OutsideMotion
from pointcoord.numerics.counters import Work
from pointcoord.numerics.multi_index import powers
from pointcoord.patches.evaluation import sum_rows, sum_series
from pointcoord.patches.flood import Patches
from pointcoord.patches.lookup import Lookup
from pointcoord.patches.reported_points import moving_points
from pointcoord.patches.way_map import WayMap
from pointcoord.results.readout import Readout
from pointcoord.results.table import vectors
from pointcoord.solve.status import Status
from pointcoord.time_functions import TimeFunction

Array = NDArray[np.float64]
Whole = NDArray[np.int64]


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
        return () if self.way.patches is None else (self.way.order,) * len(self.way.patches.low)

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
        middle, half = self._boxes
        inputs, patch = self._inputs(instants)
        wanted, tables = self._tables
        sums = sum_rows(tables, middle, half, self.way.order, patch, inputs)
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
        states, patch = self._inputs(instants)
        unknown = self._sums(self._patches.series, (states[: derivatives + 1], patch))
        laws = {name: f.series(instants, len(unknown) - 1) for name, f in self.functions.items()}
        known = mechanism.known_series(laws)
        return [
            np.concatenate([state, factorial(d) * known[:, d]], axis=-1) for d, state in enumerate(unknown)
        ]

    def summed(self, instants: Array) -> list[Summed]:
        """How `coordinates` sums each derivative at instants."""
        states, patch = self._inputs(instants)
        middle, half = self._boxes
        local = [(state - (middle[patch] if d == 0 else 0.0)) / half[patch] for d, state in enumerate(states)]
        sizes = [np.abs(state) for state in local]
        degree = powers(len(self.way.domain.free), self.way.order).exponents.sum(axis=-1)
        zero, one = np.zeros_like(middle), np.ones_like(half)
        terms = np.abs(self._patches.series)
        known = len(self.readout.mechanism.drawn) - terms.shape[-1]

        def sums(least: int, most: int) -> Array:
            """Of the terms of some degrees."""
            kept = terms * ((degree >= least) & (degree <= most))[:, None]
            found = sum_series(kept, zero, one, self.way.order, patch, sizes)
            return np.concatenate([found, np.zeros((*found.shape[:-1], known))], axis=-1)

        last = self.way.order
        parts = (sums(last - 1, last), sums(last - 3, last - 2), sums(0, last))
        return [Summed(*part) for part in zip(*parts, strict=True)]

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

    def _inputs(self, instants: Array) -> tuple[list[Array], Whole]:
        """The free inputs and as many derivatives as are wanted, each (N, p), and which patch each is on."""
        highest = self.readout.plan.derivative
        laws = [self.functions[name].series(instants, highest) for name in self.way.domain.free]
        series = np.stack(laws, axis=-1)
        states = [factorial(d) * series[:, d] for d in range(highest + 1)]
        return states, self._lookup.at(states[0])

    def _sums(self, coefficients: Array, inputs: tuple[list[Array], Whole]) -> Array:
        """Sums of the patches' series and their time derivatives, (derivatives + 1, N, m)."""
        middle, half = self._boxes
        states, patch = inputs
        return sum_series(coefficients, middle, half, self.way.order, patch, states)

    @property
    def _patches(self) -> Patches:
        assert self.way.patches is not None  # nothing is read where nothing is covered
        return self.way.patches

    @cached_property
    def _tables(self) -> tuple[list[list[str]], list[Array]]:
        """By derivative, the points that are wanted, and their coefficients, (P, powers, 3 points), mm."""
        table, place = self.readout.table, moving_points(self.readout.mechanism.topology)
        wanted = [
            [name for d, name in (*table.moving, *table.spare) if d == order]
            for order in range(self.readout.plan.derivative + 1)
        ]
        columns = [[3 * place.index(name) + axis for name in names for axis in range(3)] for names in wanted]
        return wanted, [np.ascontiguousarray(self._patches.coefficients[..., c]) for c in columns]

    @cached_property
    def _boxes(self) -> tuple[Array, Array]:
        return self.way.domain.middle_and_half(self._patches.low, self._patches.high)

    @cached_property
    def _lookup(self) -> Lookup:
        return self.way.lookup
