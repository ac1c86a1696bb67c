r"""What rides on a body, put together at each instant from the states of its carriers, for many designs.

p = p_0 + a e1 + b e2 + c e1 x e2,
p'' = p_0'' + a e1'' + b e2'' + c (e1'' x e2 + 2 e1' x e2' + e1 x e2'').
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import comb

import numpy as np
from numpy.typing import NDArray

from pointcoord.linkage.mechanism import Mechanism
from pointcoord.results.readout import Readout
from pointcoord.results.table import State

Array = NDArray[np.float64]

# Designs whose states are made at a time: at a hundred instants what lies between stays in a second-level
# cache.
CARRIED = 32


def summed_and_carried(readout: Readout) -> tuple[list[State], list[State]]:
    """The states that are summed from series, and those that are carried by them."""
    table, topology = readout.table, readout.mechanism.topology
    highest = dict.fromkeys(topology.moving, -1)
    for order, name in (*table.moving, *table.spare):
        for point in topology.carried.get(name, (name,)):
            highest[point] = max(highest[point], order)
    solved = [(order, point) for point, most in highest.items() for order in range(most + 1)]
    carried = [state for state in (*table.moving, *table.spare) if state[1] in topology.carried]
    return solved, carried


def carry(mechanism: Mechanism, part: slice, carried: Sequence[State], found: Mapping[State, Array]) -> None:
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
