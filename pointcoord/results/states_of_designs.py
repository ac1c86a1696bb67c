"""States of the points of many designs, at few instants each.

The series of many designs lie with the designs side by side, so that one matrix product for each coordinate
sums it for all designs, where it belongs in their tables. Powers of time, or of the inputs (see `solve.box`),
differ by derivative, and the coefficients do not:

    d^n/dt^n sum_k c_k s^k = sum_k c_k k! / (k - n)! s^(k-n) / scale^n,      s = (t - start) / scale.

The series of a carried point takes as many products as its orders have pairs, in each segment of each design.
At a hundred instants it is less to sum the series of its carriers, which are wanted anyway, and to put
together at each instant what rides on them,

    p = p_0 + a e1 + b e2 + c e1 x e2,
    p'' = p_0'' + a e1'' + b e2'' + c (e1'' x e2 + 2 e1' x e2' + e1 x e2'').
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import comb

import numpy as np
from numpy.typing import NDArray

from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.rounding import EPS
from pointcoord.results.readout import Readout
from pointcoord.results.states import StatesOfChain
from pointcoord.results.table import State, vectors

Array = NDArray[np.float64]

# A coefficient up to this, of places whose size is 1, is what rounding leaves of rounding.
NOTHING = EPS**2
# Designs whose states are made at a time: at a hundred instants what lies between stays in a second-level
# cache.
CARRIED = 32


@dataclass(frozen=True)
class StatesOfDesigns(StatesOfChain):
    """States summed from a chain of series that designs share, (designs, N, 3)."""

    def states(self, instants: Array, rows: Array | None = None) -> list[dict[str, Array]]:
        """States at instants of the chain, shape (N,), that do not decrease."""
        table, batch, count = self.readout.table, self.chain.segments[0].coefficients.shape[0], len(instants)
        if rows is None:
            rows = np.empty((batch, table.height, count))
        rows[:, table.first_still :, :] = self.still
        found = {state: rows[:, first : first + 3, :] for first, state in table.states}
        solved, carried = _summed_and_carried(self.readout)
        spare = [state for state in (*solved, *carried) if state not in found]
        room = np.empty((batch, 3 * len(spare), count))
        found |= {state: room[:, 3 * i : 3 * i + 3, :] for i, state in enumerate(spare)}
        self._sum(instants, {state: found[state] for state in solved})
        for low in range(0, batch, CARRIED):
            part = slice(low, low + CARRIED)
            _carry(
                self.readout.mechanism, part, carried, {state: place[part] for state, place in found.items()}
            )
        states: list[dict[str, Array]] = [{} for _ in range(self.readout.plan.derivative + 1)]
        for (order, name), place in found.items():
            states[order][name] = vectors(place, 0)
        for i, (order, name) in enumerate(table.spare_still):
            still = self._spare_still[..., i, None, :]
            states[order][name] = np.broadcast_to(still, (batch, count, 3))
        return states

    def _sum(self, instants: Array, wanted: Mapping[State, Array]) -> None:
        """Sum the series of states of points that are solved for, each into (designs, 3, N), mm."""
        mechanism = self.readout.mechanism
        orders = range(max((order for order, _ in wanted), default=-1) + 1)
        for segment, part in self.chain.parts(instants):
            if part.start == part.stop:
                continue
            powers = segment.powers(instants[part], len(orders))
            series: dict[str, tuple[Array, list[Array]]] = {}
            for (order, name), place in wanted.items():
                if name not in series:
                    first = mechanism.layout.vector(name)[0]
                    own = segment.coefficients[..., first : first + 3].transpose(1, 2, 0)
                    # Of two inputs many a point is moved by one alone, to rounding.
                    kept = np.flatnonzero(np.abs(own).reshape(len(own), -1).max(axis=-1) > NOTHING)
                    # Axis, designs, orders; the designs side by side in memory.
                    shared = np.multiply(own[kept], mechanism.unit, order="C").transpose(1, 2, 0)
                    series[name] = shared, [each[kept] for each in powers]
                shared, own_powers = series[name]
                np.matmul(shared, own_powers[order], out=place[..., part].swapaxes(0, 1))


def _summed_and_carried(readout: Readout) -> tuple[list[State], list[State]]:
    """The states that are summed from series, and those that are carried by them."""
    table, topology = readout.table, readout.mechanism.topology
    highest = dict.fromkeys(topology.moving, -1)
    for order, name in (*table.moving, *table.spare):
        for point in topology.carried.get(name, (name,)):
            highest[point] = max(highest[point], order)
    solved = [(order, point) for point, most in highest.items() for order in range(most + 1)]
    carried = [state for state in (*table.moving, *table.spare) if state[1] in topology.carried]
    return solved, carried


def _carry(mechanism: Mechanism, part: slice, carried: Sequence[State], found: Mapping[State, Array]) -> None:
    """Put together carried states of some designs from those of their carriers, (designs, 3, N), mm.

    Args:
        part: which of the mechanism's designs the states are of.
    """
    unit = mechanism.unit[part, None, None]
    edges: dict[tuple[int, str, str], Array] = {}
    normals: dict[tuple[int, tuple[str, str, str]], Array] = {}

    def edge(order: int, base: str, point: str) -> Array:
        key = order, base, point
        if key not in edges:
            edges[key] = found[order, point] - found[order, base]
        return edges[key]

    def normal(order: int, carriers: tuple[str, str, str]) -> Array:
        key, (base, first, second) = (order, carriers), carriers
        if key not in normals:
            total = normals[key] = np.zeros_like(edge(order, base, first))
            for i in range(order + 1):
                crossed = edge(i, base, first), edge(order - i, base, second)
                _add_cross(total, float(comb(order, i)), *crossed)
        return normals[key]

    for order, name in carried:
        carriers = base, first, second = mechanism.topology.carried[name]
        a, b, c = (mechanism.carrier_weights[name][part, i, None, None] for i in range(3))
        place = found[order, name]
        np.multiply(edge(order, base, first), a, out=place)
        place += b * edge(order, base, second)
        # The weights are of lengths in the mechanism's units: of the cross product's square one is left.
        place += (c / unit) * normal(order, carriers)
        place += found[order, base]


def _add_cross(total: Array, factor: float, a: Array, b: Array) -> None:
    """Add factor a x b, all (designs, 3, N)."""
    for i, (j, k) in enumerate(((1, 2), (2, 0), (0, 1))):
        crossed = a[:, j] * b[:, k]
        crossed -= a[:, k] * b[:, j]
        if factor != 1.0:
            crossed *= factor
        total[:, i] += crossed
