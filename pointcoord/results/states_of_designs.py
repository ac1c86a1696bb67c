"""States of the points of many designs, at few instants each.

The series of a carried point takes as many products as its orders have pairs, in each segment of each design.
At a hundred instants it is less to sum the series of its carriers, which are wanted anyway, and to put
together at each instant what rides on them,

    p = p_0 + a e1 + b e2 + c e1 x e2,
    p'' = p_0'' + a e1'' + b e2'' + c (e1'' x e2 + 2 e1' x e2' + e1 x e2'').
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import comb

import numpy as np
from numpy.typing import NDArray

from pointcoord.results.states import StatesOfChain
from pointcoord.results.table import vectors
from pointcoord.solve.dense_output import SeriesRows

Array = NDArray[np.float64]


@dataclass(frozen=True)
class StatesOfDesigns(StatesOfChain):
    """States summed from a chain of series that designs share, (designs, N, 3)."""

    def states(self, instants: Array, rows: Array | None = None) -> list[dict[str, Array]]:
        """States at instants of the chain, shape (N,), that do not decrease."""
        readout, (series, names) = self.readout, self._solved
        table, topology, batch = readout.table, readout.mechanism.topology, series.shape[:-1]
        if rows is None:
            rows = np.empty((*batch, table.height, len(instants)))
        sums = np.empty((*series.shape, len(instants)))
        series.sum(instants, sums)
        found = [dict[str, Array]() for _ in range(readout.plan.derivative + 1)]
        for i, (order, name) in enumerate(names):
            found[order][name] = sums[..., 3 * i : 3 * i + 3, :]
        wanted = {*table.moving, *table.spare}
        for name in topology.carried:
            for order in range(len(found)):
                if (order, name) in wanted:
                    found[order][name] = self._carried(name, order, found)
        rows[..., table.first_still :, :] = self.still
        states: list[dict[str, Array]] = [
            {name: state.swapaxes(-1, -2) for name, state in each.items()} for each in found
        ]
        for first, (order, name) in table.states:
            if name in found[order]:
                rows[..., first : first + 3, :] = found[order][name]
            states[order][name] = vectors(rows, first)
        for i, (order, name) in enumerate(table.spare_still):
            place = self._spare_still[..., i, None, :]
            states[order][name] = np.broadcast_to(place, (*batch, len(instants), 3))
        return states

    def _carried(self, name: str, order: int, found: list[dict[str, Array]]) -> Array:
        """A derivative of a carried point from those of its carriers, each (designs, 3, N), mm."""
        mechanism = self.readout.mechanism
        base, first, second = mechanism.topology.carried[name]
        a, b, c = (mechanism.carrier_weights[name][:, i, None, None] for i in range(3))
        edges = [
            tuple(state[point] - state[base] for point in (first, second)) for state in found[: order + 1]
        ]
        normal = np.zeros_like(found[order][base])
        for i in range(order + 1):
            _add_cross(normal, float(comb(order, i)), edges[i][0], edges[order - i][1])
        # The weights are of lengths in the mechanism's units: of the cross product's square one is left.
        scale = c / mechanism.unit[:, None, None]
        return np.asarray(found[order][base] + a * edges[order][0] + b * edges[order][1] + scale * normal)

    @cached_property
    def _solved(self) -> tuple[SeriesRows, list[tuple[int, str]]]:
        """The series of the points that are solved for, and which states they are, mm."""
        mechanism, table = self.readout.mechanism, self.readout.table
        layout, topology = mechanism.layout, mechanism.topology
        highest = dict.fromkeys(topology.moving, -1)
        for order, name in (*table.moving, *table.spare):
            for point in topology.carried.get(name, (name,)):
                highest[point] = max(highest[point], order)
        orders = range(self.readout.plan.derivative + 1)
        names = [(d, point) for d in orders for point, most in highest.items() if most >= d]
        unit = mechanism.unit[:, None, None]
        places = [place for point in topology.moving for place in layout.vector(point)]
        first = {point: 3 * i for i, point in enumerate(topology.moving)}
        wanted = [
            [first[point] + axis for own, point in names if own == d for axis in range(3)] for d in orders
        ]
        columns = [segment.coefficients[..., places] * unit for segment in self.chain.segments]
        return SeriesRows.of(self.chain, columns, wanted), names


def _add_cross(total: Array, factor: float, a: Array, b: Array) -> None:
    """Add factor a x b, all (designs, 3, N)."""
    for i, (j, k) in enumerate(((1, 2), (2, 0), (0, 1))):
        total[:, i] += factor * (a[:, j] * b[:, k] - a[:, k] * b[:, j])
