"""How the points of poses move by one input, the others and the chassis held: the implicit function theorem.

With y = [u, w] and the known coordinates w(q) of an input q, C(y) = 0 gives C_u u_q = -C_w w_q.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pointcoord.linkage.carried_points import carried_series
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.linear import factorise
from pointcoord.numerics.newton import implicit_rate

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ByInput:
    """The way that a mechanism goes by one input, rad or mm; nowhere by none."""

    input: str


def input_slopes(mechanism: Mechanism, y: Array, name: str) -> Array:
    """dy/dq at poses y, (N, size), in units per rad or mm; zero of an input that moves nothing here."""
    unknowns, inputs = mechanism.map.unknowns, mechanism.topology.required_inputs
    if name not in inputs:
        return np.zeros_like(y)
    values = mechanism.input_values(y[:, unknowns:])
    series = {
        one: np.stack([value, np.full_like(value, one == name)], axis=-1) for one, value in values.items()
    }
    known = mechanism.known_series(series)[:, 1]
    return implicit_rate(mechanism.map, factorise(mechanism.map.jacobian(y)), y, known, 0.0)


def point_slopes(mechanism: Mechanism, y: Array, slopes: Array) -> dict[str, Array]:
    """The derivative of every point, (N, 3), mm per rad or mm, from those of the coordinates."""
    layout, topology = mechanism.layout, mechanism.topology
    series = np.stack([y, slopes], axis=-2)
    found = {name: series[..., list(layout.vector(name))] for name in (*topology.chassis, *topology.moving)}
    for name, carriers in topology.carried.items():
        found[name] = carried_series(mechanism.carrier_weights[name], *(found[c] for c in carriers))
    return {name: each[..., 1, :] * mechanism.unit for name, each in found.items()}
